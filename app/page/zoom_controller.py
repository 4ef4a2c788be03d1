"""Where a person looks closely at a large map, its cells are sent: sharp, and no more than can be seen."""

from __future__ import annotations

from algorithms.common.pose import Pose2
from app.drawing.browser_messages import BrowserMessages
from app.drawing.scene.map_layers import MapLayers
from app.drawing.scene.zoom_crop import CameraView
from app.jobs.latest_request import LatestRequest
from app.page.page_state import TabLocks
from app.web.browser_events import BrowserEvents, Numbers


class ZoomController:
    """Of one tab: follows its camera. The page tells where it rests, and which part of map 2 is there."""

    def __init__(
        self, events: BrowserEvents, messages: BrowserMessages, ground: MapLayers, locks: TabLocks
    ) -> None:
        self._messages, self._ground, self._locks = messages, ground, locks
        self._view: CameraView | None = None
        self._work = LatestRequest(self._sharpen, "mapmeld-closer")
        ground.changed = self._again
        seen = {"box": Numbers(4, 4), "mov": Numbers(3, 3), "density": float}
        events.on("look", self._look, latest=True, **seen)

    def close(self) -> None:
        self._work.close()

    def _look(self, box: list[float], mov: list[float], density: float) -> None:
        x0, y0, x1, y1 = box
        if x0 < x1 and y0 < y1 and density > 0:
            self._view = CameraView((x0, y0, x1, y1), Pose2(*mov), density)
            self._again()

    def _again(self) -> None:
        if self._view is not None:
            self._work.ask(self._view)

    def _sharpen(self, view: CameraView) -> None:
        with self._locks.drawing:
            lacking = self._ground.closer(view)
        if not lacking:
            return
        drawn = [(closer, closer.picture()) for closer in lacking]  # others may draw meanwhile
        with self._locks.drawing:
            for closer, picture in drawn:
                closer.image.lay(closer, picture)
            self._messages.flush()
