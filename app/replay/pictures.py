"""A scene that keeps what the page's pictures are, instead of showing them: see app/views/ground.py.

It answers to what a GridImage and the Ground ask of viser's scene, and to nothing else.
"""

from __future__ import annotations

from math import atan2
from typing import Any

from app.png import data_uri
from app.render import Pixels

FRAMES = {"ref": "scene", "mov": "mov", "ghost": "ghost"}  # of the scene's tree -> of the player


class PictureHandle:
    """A picture that lies in the scene."""

    def __init__(self, number: int, height: float, scene: PictureScene) -> None:
        self.number, self.height, self.visible = number, height, True
        self._scene = scene

    def remove(self) -> None:
        """It is not shown any more; what was recorded of it stays."""
        self._scene.shown.remove(self)


class FrameHandle:
    """Where the pictures below a frame lie."""

    def __init__(self, wxyz: tuple[float, ...]) -> None:
        self.position: tuple[float, ...] = (0.0, 0.0, 0.0)
        self.wxyz = wxyz

    @property
    def pose(self) -> list[float]:
        """x and y in metres, turn in radians."""
        return [self.position[0], self.position[1], yaw(self.wxyz)]


class PictureScene:
    """Every picture once, in the order they came, and which of them are seen at the moment."""

    def __init__(self) -> None:
        self.pictures: list[dict[str, Any]] = []
        self.shown: list[PictureHandle] = []
        self.ghost: FrameHandle | None = None

    def add_frame(self, name: str, *, show_axes: bool, wxyz: tuple[float, ...] = (1, 0, 0, 0)) -> FrameHandle:
        """A frame of the tree; those that move are told by the page or, for the ghost, read here."""
        frame = FrameHandle(wxyz)
        if name.endswith("/ghost"):
            self.ghost = frame
        return frame

    def add_image(
        self,
        name: str,
        pixels: Pixels,
        wide: float,
        high: float,
        *,
        position: tuple[float, float, float],
        wxyz: tuple[float, ...],
        **_: Any,
    ) -> PictureHandle:
        """A picture with its middle at ``position`` of its frame; metres."""
        x, y, height = position
        self.pictures.append(
            {
                "frame": FRAMES[name.split("/")[2]],
                "data": data_uri(pixels),
                "at": [round(x, 4), round(y, 4), round(yaw(wxyz), 6)],
                "size": [round(wide, 4), round(high, 4)],
                "thin": "free" not in name,
            }
        )
        handle = PictureHandle(len(self.pictures) - 1, height, self)
        self.shown.append(handle)
        return handle

    @property
    def seen(self) -> list[int]:
        """Numbers of the pictures that are seen, the lowest first."""
        return [h.number for h in sorted(self.shown, key=lambda handle: handle.height) if h.visible]


def yaw(wxyz: tuple[float, ...]) -> float:
    """The turn about z of a quaternion; radians."""
    return 2 * atan2(float(wxyz[3]), float(wxyz[0]))
