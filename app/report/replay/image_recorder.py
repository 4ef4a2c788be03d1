"""A scene that keeps the pictures of GridImage and Ground instead of showing them: see map_layers."""

from __future__ import annotations

from math import atan2
from typing import Any

from app.drawing.grid_pixels import Pixels
from app.drawing.png import data_uri


class FrameHandle:
    """Where the pictures below a frame lie."""

    def __init__(self, position: tuple[float, ...], wxyz: tuple[float, ...]) -> None:
        self.position, self.wxyz = position, wxyz

    @property
    def pose(self) -> list[float]:
        """x and y in metres, turn in radians."""
        return [self.position[0], self.position[1], yaw(self.wxyz)]


class PictureHandle:
    """A picture that lies in the scene; where it lies in the end is what is recorded.

    picture : what the player knows of it
    pose    : of its middle
    """

    def __init__(self, number: int, picture: dict[str, Any], pose: FrameHandle, scene: PictureScene) -> None:
        self.number, self.picture, self.visible = number, picture, True
        self.position, self.wxyz = pose.position, pose.wxyz
        self._scene = scene

    def recorded(self) -> dict[str, Any]:
        """The picture with its middle in its frame, metres, and its turn, radians."""
        x, y, _ = self.position
        return self.picture | {"at": [round(x, 4), round(y, 4), round(yaw(self.wxyz), 6)]}

    def remove(self) -> None:
        """It is not shown any more; what was recorded of it stays."""
        self._scene.shown.remove(self)


class PictureScene:
    """Every picture once, in the order they came, and which of them are seen at the moment."""

    def __init__(self) -> None:
        self._handles: list[PictureHandle] = []
        self.shown: list[PictureHandle] = []
        self.ghost: FrameHandle | None = None

    def add_frame(self, name: str, *, wxyz: tuple[float, ...] = (1, 0, 0, 0), **_: Any) -> FrameHandle:
        """A frame of the tree; those that move are told by the page or, for the ghost, read here."""
        frame = FrameHandle((0.0, 0.0, 0.0), wxyz)
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
        size, frame = [round(wide, 4), round(high, 4)], name.split("/")[2]
        picture = {"frame": frame, "data": data_uri(pixels), "size": size, "thin": "free" not in name}
        handle = PictureHandle(len(self._handles), picture, FrameHandle(position, wxyz), self)
        self._handles.append(handle)
        self.shown.append(handle)
        return handle

    @property
    def pictures(self) -> list[dict[str, Any]]:
        """Every picture with the place that it was given last."""
        return [handle.recorded() for handle in self._handles]

    @property
    def seen(self) -> list[int]:
        """Numbers of the pictures that are seen, the lowest first."""
        return [h.number for h in sorted(self.shown, key=lambda handle: handle.position[2]) if h.visible]


def yaw(wxyz: tuple[float, ...]) -> float:
    """The turn about z of a quaternion; radians."""
    return 2 * atan2(float(wxyz[3]), float(wxyz[0]))
