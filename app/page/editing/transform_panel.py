"""Folder "By hand": put map 2 where a person wants it, with numbers, and what the walls say of it."""

from __future__ import annotations

from collections.abc import Callable
from math import degrees, isfinite, radians
from typing import Any

import viser

from algorithms.common.pose import Pose2, pose_error
from algorithms.methods.merge_result import MergeResult
from app.drawing.palette import LIGHT, QUIET
from app.model import verdict_text as words
from app.model.objective_label import measure_of
from app.page.panels.html_widgets import box, table

HOW = (
    "Drag map 2. To turn it about robot 2, drag the knob, or hold Shift or Alt. Arrow keys: one cell, with "
    "Shift 1 cm; [ and ]: 0.5°, with Shift 0.1°. The empty ground still pans."
)
SMALL = "margin:2px 12px 6px;font-size:12px;line-height:1.45;opacity:.85"
FAR = 1e5  # metres


class TransformPanel:
    """Widgets; they know nothing of maps."""

    def __init__(self, gui: viser.GuiApi) -> None:
        self._folder = gui.add_folder("By hand", order=62.0, visible=False)
        with self._folder:
            self._begin = gui.add_button(
                "Move map 2 by hand",
                icon=viser.Icon.HAND_MOVE,
                color=QUIET,
                hint="Drag and turn it over map 1, or mend what the method found.",
            )
            self._how = gui.add_html(f'<p style="{SMALL}">{HOW}</p>', visible=False)
            number = {"min": -FAR, "max": FAR, "visible": False}
            self._x = gui.add_number("T: Δx (m)", 0.0, step=0.01, hint="Right, in map 1.", **number)
            self._y = gui.add_number("T: Δy (m)", 0.0, step=0.01, hint="Up, in map 1.", **number)
            self._turn = gui.add_number(
                "T: Δθ (°)", 0.0, step=0.1, hint="Counter-clockwise, about robot 2.", **number
            )
            self._says = gui.add_html("", visible=False)
            self._refine = gui.add_button(
                "Refine from here",
                color=QUIET,
                visible=False,
                hint="The method's own search, in its box around this place.",
            )
            self._snap = gui.add_button(
                "Snap to proven optimum",
                color=QUIET,
                visible=False,
                hint="The best of the whole circle: it is the method's answer, no longer yours.",
            )
            self._take = gui.add_button(
                "Take this as the answer", color=LIGHT.ref, visible=False, hint="Its verdict stays with it."
            )

    def connect(
        self,
        toggle: Callable[[], None],
        typed: Callable[[str, float], None],
        refine: Callable[[], None],
        snap: Callable[[], None],
        take: Callable[[], None],
    ) -> None:
        """What is done where a person takes map 2 in hand, and then wants something of it.

        typed : x, y or theta and its new value; metres, radians; called in viser's loop
        """
        for button, action in (
            (self._begin, toggle),
            (self._refine, refine),
            (self._snap, snap),
            (self._take, take),
        ):
            button.on_click(lambda _, action=action: action())
        self._typed = typed
        for handle in (self._x, self._y, self._turn):
            handle.on_update(self._read)

    def offer(self, possible: bool) -> None:
        """Whether there is anything to move."""
        self._folder.visible = possible

    def open(self, yes: bool, refine: bool = False, prove: bool = False) -> None:
        """Show what moves map 2; which buttons depends on what the method can do."""
        self._begin.label = "Leave it as it was" if yes else "Move map 2 by hand"
        for handle in (self._how, self._x, self._y, self._turn, self._says, self._take):
            handle.visible = yes
        self._refine.visible, self._snap.visible = yes and refine, yes and prove

    def show(self, T: Pose2) -> None:
        for handle, value in ((self._x, T.x), (self._y, T.y), (self._turn, degrees(T.theta))):
            handle.value = round(value, 3)

    def tell(self, html: str) -> None:
        self._says.content = html

    async def _read(self, event: viser.GuiEvent[Any]) -> None:  # in the loop: nothing overwrites it before
        if event.client_id is None:
            return  # set by ``show``
        fields = {"x": self._x, "y": self._y, "theta": self._turn}
        field = next(name for name, handle in fields.items() if handle is event.target)
        value = event.target.value
        self._typed(field, radians(value) if field == "theta" else value)


def weighed_html(result: MergeResult, config: Any, method: Pose2 | None) -> str:
    """HTML of what the walls say of a transform.

    method : what the method has found, to tell how far off it the hand is
    """
    verdict = result.verdict
    rows: list[tuple[str, ...]] = []
    if result.value is not None and isfinite(result.value):
        measure = measure_of(config)
        rows.append((measure.row, measure.number(result.value)))
    rows += [
        ("likely right", words.likelihood(verdict.probability)),
        ("contradicted, as the maps are", f"{verdict.rigid_contradiction:.1%}"),
        ("wall in view of both", f"{verdict.shared_wall:.1f} m"),
        ("robot 2 off its sighting", f"{verdict.deviation:.1f} σ"),
    ]
    if method is not None:
        apart, turn = pose_error(result.T_ref_mov, method, result.encounter.x_mov)
        rows.append(("off the method's answer", f"{apart:.2f} m, {degrees(turn):.1f}°"))
    return box(words.of_hand(result), words.mood(verdict)) + table(rows)
