"""Two maps merged, as small as a stamp: which walls lie on each other, and which the other map denies.

Made from the maps themselves and a transform, so that nothing is merged for it, however large they are.
"""

from __future__ import annotations

import cv2
import numpy as np

from algorithms.common.pose import Pose2
from algorithms.maps.grid_map import UNKNOWN, GridMap
from app.drawing.grid_pixels import Pixels, wall_masks
from app.drawing.palette import Palette
from app.drawing.scene_layout import known_hull, rect_of, union
from app.drawing.svg.map_plot import RasterView, under, walls

SIZE = 208, 156  # pixels; shown at half of that
_NEAR = np.ones((3, 3), np.uint8)  # walls a pixel apart are the same wall here


def thumbnail(
    ref: GridMap, mov: GridMap, T_ref_mov: Pose2, palette: Palette, size: tuple[int, int] = SIZE
) -> Pixels:
    """(H, W, 3) both maps as they lie under a transform, in the colours of the merged map; row 0 on top."""
    return laid_over(_around(ref, mov, T_ref_mov, *size), ref, mov, T_ref_mov, palette)


def laid_over(view: RasterView, ref: GridMap, mov: GridMap, T_ref_mov: Pose2, palette: Palette) -> Pixels:
    """(H, W, 3) what a view sees of both maps as they lie under a transform, coloured as ``thumbnail``."""
    cells = under(ref.cells, ref, view, None, UNKNOWN), under(mov.cells, mov, view, T_ref_mov, UNKNOWN)
    wall = walls(ref, view, None, cells[0]), walls(mov, view, T_ref_mov, cells[1])
    near = cv2.dilate(wall[0].astype(np.uint8), _NEAR) > 0, cv2.dilate(wall[1].astype(np.uint8), _NEAR) > 0
    free = (cells[0] != UNKNOWN) & ~near[0], (cells[1] != UNKNOWN) & ~near[1]
    pixels = view.blank(palette)
    for mask, colour in (
        ((cells[0] != UNKNOWN) | (cells[1] != UNKNOWN), palette.free),
        *wall_masks(wall, free, palette, near),
    ):
        pixels[mask] = colour
    return pixels


def _around(ref: GridMap, mov: GridMap, T: Pose2, wide: int, high: int) -> RasterView:
    """Both maps in the middle of so many pixels, with a little room around."""
    x0, y0, x1, y1 = union(rect_of(known_hull(ref)), rect_of(T.apply(known_hull(mov))))
    metre = 0.94 * min(wide / max(x1 - x0, 1e-6), high / max(y1 - y0, 1e-6))  # pixels
    half = wide / 2 / metre, high / 2 / metre
    cx, cy = (x0 + x1) / 2, (y0 + y1) / 2
    return RasterView((cx - half[0], cy - half[1], cx + half[0], cy + half[1]), wide, high)
