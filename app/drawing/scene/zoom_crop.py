"""Which cells of a large map a person looks at: the excerpt that is drawn in cells of their own.

A map of more cells than a picture may have pixels is shown in pooled ones. Where a person looks closer
an excerpt of its cells takes the place of that part of the picture; see app/page/zoom_controller.py.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from algorithms.common.pose import FloatArray, Pose2
from app.drawing.grid_pixels import CellRegion
from app.drawing.scene_layout import Rect

MOST_EXCERPT = 1536  # pixels on a side of an excerpt: all that a laptop's screen shows, and the margin
MARGIN = 0.2  # of what is seen, on each side: so far the camera moves before there is a new excerpt


@dataclass(frozen=True)
class CameraView:
    """What a tab shows of the scene, seen from above.

    box     : what is seen of the scene; metres
    mov     : where map 2's anchor lies, and its turn; scene
    density : pixels of the screen per metre
    """

    box: Rect
    mov: Pose2
    density: float

    def corners(self) -> FloatArray:
        """(4, 2) corners of what is seen; scene."""
        x0, y0, x1, y1 = self.box
        return np.array([[x0, y0], [x1, y0], [x1, y1], [x0, y1]])


@dataclass(frozen=True)
class ZoomCrop:
    """Cells of a grid, and how many of them a pixel stands for on each axis."""

    top: int
    left: int
    bottom: int
    right: int
    pooled: int

    @property
    def part(self) -> CellRegion:
        return slice(self.top, self.bottom), slice(self.left, self.right)

    @property
    def most(self) -> int:
        """Pixels on its longer side."""
        return -(-max(self.bottom - self.top, self.right - self.left) // self.pooled)

    def serves(self, other: ZoomCrop) -> bool:
        """Whether it shows all that the other one would, and no less finely."""
        within = self.top <= other.top and self.left <= other.left
        within = within and self.bottom >= other.bottom and self.right >= other.right
        return within and self.pooled <= other.pooled


def looked_at(
    seen: FloatArray, shape: tuple[int, ...], cells_per_pixel: float
) -> tuple[ZoomCrop, ZoomCrop] | None:
    """What a person sees of a grid, and the same with a margin: the excerpt to be drawn.

    seen            : (4, 2) corners of the view in the grid's coordinates, column and row
    shape           : of the grid
    cells_per_pixel : cells along a pixel of the screen; finer than the screen is wasted
    returns         : None where none of the grid is seen
    """
    low, high = seen.min(axis=0), seen.max(axis=0)
    bare = _clipped(low, high, shape)
    if bare[0] >= bare[2] or bare[1] >= bare[3]:
        return None
    margin = MARGIN * (high - low)
    top, left, bottom, right = _clipped(low - margin, high + margin, shape)
    side = max(bottom - top, right - left)
    pooled = max(1, round(cells_per_pixel), -(-side // (MOST_EXCERPT - 2)))
    # in whole blocks, so that they stay where they are when the camera moves
    top, left = top // pooled * pooled, left // pooled * pooled
    bottom, right = (
        min(-(-end // pooled) * pooled, n) for end, n in zip((bottom, right), shape, strict=True)
    )
    return ZoomCrop(*bare, pooled), ZoomCrop(top, left, bottom, right, pooled)


def _clipped(low: FloatArray, high: FloatArray, shape: tuple[int, ...]) -> tuple[int, int, int, int]:
    """Top, left, bottom, right: the cells between two corners, as far as the grid goes."""
    rows, cols = shape
    left, right = np.clip([np.floor(low[0]), np.ceil(high[0])], 0, cols).astype(int).tolist()
    top, bottom = np.clip([np.floor(low[1]), np.ceil(high[1])], 0, rows).astype(int).tolist()
    return top, left, bottom, right
