"""Folder "Frame and cells" of the export: in which frame and in which cells the merged map is given away."""

from __future__ import annotations

from collections.abc import Callable
from typing import Literal

import viser

from algorithms.common.pose import Pose2
from algorithms.common.robot_names import RobotNames
from algorithms.maps.grid_map import COARSEST
from app.drawing.palette import QUIET
from app.page.panels.html_widgets import Action, box, on_choice, on_press, put, small
from app.report.export_frame import ExportFrame

Owner = Literal["ref", "mov", "chosen"]

OWNERS: dict[Owner, str] = {"ref": "map 1's", "mov": "map 2's", "chosen": "one that I choose"}
CHOOSE, CANCEL = "Choose it on the map", "Cancel"
FINEST = 0.001  # metres; what is finer makes a map that is too large


class FramePanel:
    """Widgets; they know nothing of maps."""

    def __init__(self, gui: viser.GuiApi) -> None:
        with gui.add_folder("Frame and cells", expand_by_default=False, visible=False) as self._folder:
            hint = "The frame of merged.yaml and of the line that publishes the transform."
            self._owner = gui.add_dropdown("Frame", tuple(OWNERS.values()), hint=hint)
            hint = "Click its origin, then a point on its x-axis."
            self._pick = gui.add_button(CHOOSE, color=QUIET, hint=hint, visible=False)
            hint = "As Nav2's costmap wants it: the map is turned, and its cells are resampled."
            self._upright = gui.add_checkbox("Without yaw", False, hint=hint)
            hint = "Of the merged map. Another size resamples it; no wall is lost."
            self._cell = gui.add_number(
                "Cell size (m)", 0.05, min=FINEST, max=COARSEST, step=0.001, hint=hint
            )
            self._says = gui.add_html("")
        self._owners = OWNERS
        self._merged = 0.05  # metres per cell as they were merged

    def connect(
        self, choose: Callable[[Owner], None], pick: Action, cells: Callable[[bool, float | None], None]
    ) -> None:
        """What is done where a person chooses a frame, presses to pick one, and wants other cells.

        cells : is given whether the map may have a yaw, and metres per cell or None as they were merged
        """
        on_choice(
            self._owner, lambda: choose(next(k for k, t in self._owners.items() if t == self._owner.value))
        )
        on_press((self._pick, pick))
        for handle in (self._upright, self._cell):
            on_choice(handle, lambda: cells(not self._upright.value, self._resolution))

    @property
    def _resolution(self) -> float | None:
        size = float(self._cell.value)
        return None if size == round(self._merged, 3) else size

    def offer(self, yes: bool, enabled: bool) -> None:
        """Whether there is a result, and whether it is up to date."""
        put(self._folder, visible=yes)
        for handle in (self._owner, self._pick, self._upright, self._cell):
            put(handle, disabled=not enabled)

    def show(self, frame: ExportFrame, merged: float, names: RobotNames, picking: bool) -> None:
        """Show what is asked for.

        merged  : metres per cell of the merged map
        picking : whether a frame is being chosen on the map
        """
        self._merged = merged
        chosen = picking or isinstance(frame.frame, Pose2)
        self._owners = {key: names.told(title) for key, title in OWNERS.items()}
        title = self._owners["chosen" if chosen else frame.frame]  # type: ignore[index]
        put(self._owner, options=tuple(self._owners.values()), value=title)
        put(self._pick, visible=chosen, label=CANCEL if picking else CHOOSE)
        put(self._upright, value=not frame.yaw)
        put(self._cell, value=round(frame.resolution or merged, 3))

    def tell(self, said: str, trouble: str = "") -> None:
        """Where the frame lies and what became of the cells, or why there can be no such map."""
        put(self._says, content=box(trouble, "refused") if trouble else small(said))
