"""Folder "Correct the map": what is believed where, what is erased, where no robot may go."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Literal

import viser

from algorithms.common.robot_names import RobotNames
from algorithms.maps.map_corrections import WIDEST, Corrections
from algorithms.maps.map_fusion import ConflictRule
from app.drawing.palette import QUIET
from app.page.panels.html_widgets import Action, on_choice, on_press, put, small
from app.report.correction_text import RULES

Tool = Literal["brush", "box", "line"]

TOOLS: dict[Tool, tuple[str, str]] = {
    "brush": (
        "Erase with a brush",
        "People who walked by: what the brush touches becomes floor.",
    ),
    "box": ("Erase a rectangle", "Every wall in it becomes floor; what is unknown stays unknown."),
    "line": ("Draw a keep-out line", "A wall that no robot saw: a planner does not cross it."),
}
DONE = "Done"
HOW = (
    "The merged map alone changes: maps 1 and 2 and the verdict stay as they are. To choose a map at one "
    "place, press its line in the list of contradictions."
)
AROUND = "Erase what is left around the robots"


class CorrectionPanel:
    """Widgets; they know nothing of maps."""

    def __init__(self, gui: viser.GuiApi) -> None:
        how: Any = {"color": QUIET}
        with gui.add_folder("Correct the map", order=66.0, expand_by_default=False, visible=False) as folder:
            self._folder = folder
            gui.add_html(small(HOW))
            hint = "Of a cell where one map says wall and the other free floor."
            self._rule = gui.add_dropdown("Contradictions", tuple(RULES.values()), hint=hint)
            self._dates = gui.add_html("")
            self._tools = {
                tool: gui.add_button(label, hint=hint, **how) for tool, (label, hint) in TOOLS.items()
            }
            self._width = gui.add_number("Brush (m)", 0.4, min=0.01, max=2 * WIDEST, step=0.01)
            hint = "Wall within 0.4 m of where a robot stood, which may be that robot."
            self._around = gui.add_button(AROUND, visible=False, hint=hint, **how)
            hint = "The map ends where nothing more is known."
            self._crop = gui.add_checkbox("Crop to known", False, hint=hint)
            self._says = gui.add_html("")
            self._none = gui.add_button("Take all corrections back", visible=False, **how)
        self._rules = RULES

    def connect(
        self,
        rule: Callable[[ConflictRule], None],
        tool: Callable[[Tool], None],
        width: Action,
        around: Action,
        crop: Callable[[bool], None],
        none: Action,
    ) -> None:
        """What is done where a person chooses a rule, takes up a tool or lays it down, and so on."""
        on_choice(self._rule, lambda: rule(next(k for k, t in self._rules.items() if t == self._rule.value)))
        for name, button in self._tools.items():
            on_press((button, lambda name=name: tool(name)))
        on_choice(self._width, width)
        on_press((self._around, around), (self._none, none))
        on_choice(self._crop, lambda: crop(self._crop.value))

    @property
    def radius(self) -> float:
        """Of the brush; metres."""
        return float(self._width.value) / 2

    def offer(self, yes: bool) -> None:
        """Whether there is a map to correct."""
        put(self._folder, visible=yes)

    def hold(self, tool: Tool | None) -> None:
        """Show which tool is taken up."""
        for name, button in self._tools.items():
            put(button, label=DONE if name == tool else TOOLS[name][0])

    def show(
        self,
        corrections: Corrections,
        rule: ConflictRule,
        names: RobotNames,
        dates: str,
        said: str,
        around: int,
    ) -> None:
        """Show what is corrected.

        rule   : that holds, asked for or as the maps were merged
        dates  : what is known of which map is newer, or sure
        said   : all that was corrected
        around : cells of wall that are left around the robots
        """
        self._rules = {each: names.told(title) for each, title in RULES.items()}
        put(self._rule, options=tuple(self._rules.values()), value=self._rules[rule])
        put(self._dates, content=small(names.told(dates)))
        put(self._crop, value=corrections.crop)
        put(self._around, visible=around > 0, label=f"{AROUND} ({around} cells)")
        put(self._says, content=small(names.told(said)))
        put(self._none, visible=bool(said))
