"""A scene that keeps what the page's pictures are, instead of showing them: see app/views/ground.py.

It answers to what a GridImage and the Ground ask of viser's scene, and to nothing else.
"""

from __future__ import annotations

import base64
import io
from math import atan2
from typing import Any

import numpy as np
from PIL import Image

from app.render import Pixels, upright

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


def data_uri(pixels: Pixels) -> str:
    """A picture as a PNG inside an address; its colours are few, so an index is kept for each pixel.

    pixels : (H, W, 4) uint8, row 0 at the bottom
    """
    flat = np.ascontiguousarray(upright(pixels)).view(np.uint32)[..., 0]
    colours, index = np.unique(flat, return_inverse=True)
    packed = io.BytesIO()
    if len(colours) <= 256:
        rgba = colours.view(np.uint8).reshape(-1, 4)
        image = Image.fromarray(index.reshape(flat.shape).astype(np.uint8))
        image.putpalette(rgba[:, :3].tobytes())
        bits = next(bits for bits in (1, 2, 4, 8) if len(colours) <= 2**bits)
        image.save(packed, "PNG", optimize=True, bits=bits, transparency=rgba[:, 3].tobytes())
    else:
        Image.fromarray(upright(pixels)).save(packed, "PNG", optimize=True)
    return "data:image/png;base64," + base64.b64encode(packed.getvalue()).decode()
