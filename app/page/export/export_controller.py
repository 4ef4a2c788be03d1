"""In which frame and cells the merged map is given away: chosen in the panel, or clicked on the map."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from math import degrees
from typing import Any

import numpy as np

from algorithms.common.errors import MapMergeError, SettingError
from algorithms.common.pose import FloatArray, Pose2
from app.drawing.scene import frame_symbols as signs
from app.model.status_text import typeset
from app.page.export.frame_panel import Owner
from app.page.modes import Mode
from app.page.tab import Tab
from app.report.export_frame import ExportFrame, changes_text
from app.report.result_files import ResultFiles
from app.web.browser_events import Numbers

ORIGIN, AXIS = "frame_origin", "frame_axis"
ASKED = {
    ORIGIN: "Click where the frame's origin is to be.",
    AXIS: "Now click a point on its x-axis.",
}


class ExportController:
    """Of one tab."""

    def __init__(self, tab: Tab) -> None:
        self._state, self._display, self._modes = tab.state, tab.display, tab.modes
        self._history, self._notices, self._locks = tab.history, tab.notices, tab.state.locks
        self._panel, self._messages = tab.panels.export, tab.display.messages
        self._maps = tab.display.views.map
        self._origin: FloatArray | None = None  # (2,) that was clicked; metres, map 1's frame
        self._before: dict[str, Any] = {}  # the words above the map
        self._mode = tab.modes.add(Mode(self._end))
        # in a thread of their own: to resample a large map takes a while
        self._later = tab.events.then
        self._panel.frame.connect(self._choose, self._toggle, partial(self._later, self._resample))
        self._panel.offered = partial(self._later, self._tell)
        tab.state.subscribe("export", partial(self._later, self._tell))
        sign = {"id": (ORIGIN, AXIS), "at": Numbers(2, 2), "heading": Numbers(0, 1)}
        tab.events.on("drop", self._clicked, **sign)
        tab.events.on("cancel", self._cancel)

    @property
    def _picking(self) -> bool:
        return self._modes.current is self._mode

    # --- what is asked for ------------------------------------------------------------------------

    def _choose(self, owner: Owner) -> None:
        with self._locks.action:
            if owner == "chosen":
                if not self._picking:
                    self._toggle()
                return
            if self._picking:
                self._modes.close()
        self._later(self._set, replace(self._state.export, frame=owner))

    def _resample(self, yaw: bool, resolution: float | None) -> None:
        self._set(replace(self._state.export, yaw=yaw, resolution=resolution))

    def _set(self, frame: ExportFrame) -> None:
        """Give the merged map away like that from now on, as a step of its own."""
        harvest, snapshot = self._panel.harvest, self._history.snapshot
        if harvest is None or snapshot is None or frame == harvest.frame:
            self._tell()
            return
        tried = replace(harvest, frame=frame)
        try:
            _ = tried.exported
        except MapMergeError as error:
            self._notices.report(error)
            self._tell()
            return
        with self._locks.action, self._locks.drawing:
            if self._panel.harvest is harvest:  # no other result came meanwhile
                self._panel.reframe(tried)
                self._state.update(export=frame)
                self._history.note(replace(snapshot, export=frame))
                self._display.show_frame()
                self._messages.flush()

    def _tell(self) -> None:
        """Show how the merged map is given away, and what that does to its cells."""
        harvest, trouble = self._panel.harvest, ""
        if harvest is None:
            return
        try:
            said = said_of(harvest)
        except MapMergeError as error:
            said, trouble = "", str(error)
        with self._locks.drawing:
            if self._panel.harvest is harvest:
                names, merged = harvest.inputs.names, harvest.result.fusion.merged
                self._panel.frame.show(harvest.frame, merged.resolution, names, self._picking)
                self._panel.frame.tell(names.told(said), trouble)

    # --- a frame that is clicked --------------------------------------------------------------------

    def _toggle(self) -> None:
        with self._locks.action:
            if self._picking:
                self._modes.close()
                self._tell()
                return
            if self._panel.harvest is None:
                return
            self._modes.enter(self._mode)
            with self._locks.drawing:
                if self._state.turn_to_map():
                    self._display.show_view()
                self._before = self._messages.said("state", "mood")
                self._origin = None
                self._ask(ORIGIN)
            self._tell()

    def _ask(self, what: str, trouble: str = "") -> None:
        """Have the next click be that; whoever calls is drawing."""
        self._messages.hand({"place": {"id": what, "f": "scene"}})
        self._messages.hud(state=trouble or ASKED[what], mood="refused" if trouble else "idle")
        self._messages.flush()

    def _clicked(self, id: str, at: list[float], heading: list[float]) -> None:  # noqa: A002
        """A place was clicked, or a way drawn from it: metres of the scene, radians."""
        with self._locks.action:
            if not self._picking:
                return
            point = np.array(at) + self._maps.layout.anchor_ref
            if id == ORIGIN and not heading:
                self._origin = point
                with self._locks.drawing:
                    items = signs.origin(point, self._maps.layout, self._state.palette)
                    self._messages.layer("frame", items)
                    self._ask(AXIS)
                return
            try:
                frame = self._frame_to(point, heading)
            except SettingError as error:
                with self._locks.drawing:
                    self._ask(AXIS, f"{error}.")
                return
            self._modes.close()
        self._later(self._set, replace(self._state.export, frame=frame))

    def _frame_to(self, point: FloatArray, heading: list[float]) -> Pose2:
        """T_ref_frame of the click that ends it; raises SettingError."""
        x, y = point.tolist()
        if heading and self._origin is None:  # its x-axis was drawn in one go
            return Pose2(x, y, heading[0])
        origin = self._origin if self._origin is not None else point
        return ExportFrame.between((float(origin[0]), float(origin[1])), (x, y))

    def _cancel(self) -> None:
        with self._locks.action:
            if self._picking:
                self._toggle()

    def _end(self) -> None:
        with self._locks.drawing:
            self._messages.hand(None)
            self._messages.hud(**self._before)
            self._display.show_frame()
            self._messages.flush()


def said_of(harvest: ResultFiles) -> str:
    """Where a chosen frame lies, and what became of the cells, in sentences; empty where there is neither.

    raises : SettingError, TooLargeError
    """
    exported, said = harvest.exported, []
    if isinstance(harvest.frame.frame, Pose2):
        T = exported.T_ref_frame
        said.append(f"At x {T.x:.2f} m, y {T.y:.2f} m in map 1, turned by {degrees(T.theta):.1f}°.")
    if not harvest.frame.as_merged:
        changes = changes_text(exported.cells)
        said.append(f"{changes[0].upper()}{changes[1:]}.")
    return typeset(" ".join(said))
