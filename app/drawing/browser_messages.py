"""What the page draws by itself, told by the server: camera, ink over the map, words above it.

One message per ``flush``: everything that belongs together is seen together.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from threading import RLock
from typing import Any

from algorithms.common.pose import FloatArray, Pose2
from algorithms.common.robot_names import UNNAMED
from app.drawing.draw_items import Item
from app.drawing.palette import Palette, css
from app.drawing.scene_layout import Rect

NAMED = ("state", "readout", "legend")  # words above the map that are on robots and maps


class BrowserMessages(ABC):
    """What is to be drawn, gathered until it is flushed; see map_drawing.js for what each item may hold.

    Where it goes is up to the subclass: to a tab (TabMessages), or into a recording.
    """

    def __init__(self) -> None:
        self._pending: dict[str, Any] = {}
        self._hud: dict[str, Any] = {}
        self._shown: dict[str, Any] = {}  # the same with the robots' names
        self.names = UNNAMED  # put into words above the map and beside signs on it
        self.placed = 0  # how often a map was put anywhere
        self._lock = RLock()  # widgets call from many threads; what gathers while one sends is not lost

    @abstractmethod
    def send(self, message: dict[str, Any]) -> None:
        """Take over what has gathered."""

    def layer(self, name: str, items: list[Item] | None) -> None:
        """Replace a layer of ink; None removes it."""
        with self._lock:
            self._pending.setdefault("layers", {})[name] = self._told(items) or None

    def hud(self, **words: Any) -> None:
        """Change words above the map: case, state, mood, progress, legend, frames, names."""
        with self._lock:
            self._hud.update(words)
            told = {key: self._told(value) if key in NAMED else value for key, value in words.items()}
            changed = {key: value for key, value in told.items() if self._shown.get(key, self) != value}
            self._shown.update(changed)
            if changed:
                self._pending.setdefault("hud", {}).update(changed)

    def _told(self, shown: Any) -> Any:
        """A sentence, or items with a text each, with the robots' names in it."""
        if isinstance(shown, list):
            return [item | {"t": self.names.told(item["t"])} if "t" in item else item for item in shown]
        return self.names.told(shown) if shown else shown

    def said(self, *names: str) -> dict[str, Any]:
        """What these words above the map are; None for those that were never said."""
        with self._lock:
            return {name: self._hud.get(name) for name in names}

    @property
    def mood(self) -> str:
        """What the words above the map are coloured by."""
        return str(self._hud.get("mood", "idle"))

    def place_map(self, number: int, at: Pose2, milliseconds: float = 0) -> None:
        """Turn and slide a map's anchor to a pose of the scene, in this time."""
        with self._lock:
            self.placed += 1
            pose = {"x": at.x, "y": at.y, "theta": at.theta}
            self._pending.setdefault("maps", {})[number] = {**pose, "ms": milliseconds, "placed": self.placed}

    def look_down(self, rect: Rect, follow: bool = False, need: bool = False) -> None:
        """Show a rectangle of the map from above, north up.

        follow : also where the person has moved the camera since the last time
        need   : only where a part of it cannot be seen
        """
        with self._lock:
            self._pending["look"] = {"view": "map", "box": list(rect), **({"need": True} if need else {})}
            self._pending["follow"] = follow or self._pending.get("follow", False)

    def look_at(self, view: str, centre: FloatArray, radius: float, polar: float, azimuth: float) -> None:
        """Show a ball of the scene in 3-D; radians, polar from straight above."""
        ball = {"centre": centre.tolist(), "radius": radius, "polar": polar, "azimuth": azimuth}
        with self._lock:
            self._pending.update(look={"view": view, **ball}, follow=True)

    def theme(self, palette: Palette) -> None:
        """Light or dark ink, and the colour of what no map knows."""
        with self._lock:
            self._pending.update(dark=palette.dark, background=css(palette.unknown))

    def compare(self, **changes: Any) -> None:
        """How the two maps are compared where they lie: modes, mode, places, colours (map_comparison.js)."""
        with self._lock:
            self._pending.setdefault("compare", {}).update(changes)

    def closer(self, name: str, excerpt: dict[str, Any] | None) -> None:
        """Lay a sharp excerpt over a picture of the scene; None: lay it bare. See zoom_detail.js."""
        with self._lock:
            self._pending.setdefault("closer", {})[name] = excerpt

    def listen(self, uuid: str) -> None:
        """Have the page tell its events to this field; see app/web/browser_events.py."""
        with self._lock:
            self._pending["channel"] = uuid

    def hand(self, what: dict[str, Any] | None) -> None:
        """What can be taken hold of on the map; None for nothing. See map_editing.js for what it may hold."""
        with self._lock:
            self._pending["hand"] = what or {}

    def link(self, address: str, code: str) -> None:
        """Show an address as a QR code; an SVG. See lesson.js."""
        with self._lock:
            self._pending["link"] = {"address": address, "code": code}

    def remember(self, key: str) -> None:
        """Have the tab keep the key to what it leaves behind; see app/web/session_store.py."""
        with self._lock:
            self._pending["key"] = key

    def remember_mode(self, mode: str) -> None:
        """Have the browser keep for whom its tabs are from now on."""
        with self._lock:
            self._pending["mode"] = mode

    def flush(self) -> None:
        with self._lock:
            if not self._pending:
                return
            message, self._pending = self._pending, {}
            # sent under the lock, too: an older word must not arrive after a newer one
            self.send(message)
