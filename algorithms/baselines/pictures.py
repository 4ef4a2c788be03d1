"""A map as a picture for methods of image registration: how far the next wall is, pixel by pixel."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

import cv2
import numpy as np
from numpy.typing import NDArray

from algorithms.bounds import Bounds, check_bounds
from algorithms.gridmap import UNKNOWN, GridMap
from algorithms.pose import FloatArray

MARGIN = 64  # pixels around what is known, so that what lies at its rim is described as well as the rest


@dataclass(frozen=True)
class PictureConfig:
    """How a map becomes a picture."""

    reach: Annotated[float, Bounds(0.1, 3, 0.05, "m", "", "shading")] = 0.4
    """A pixel is as bright as the next wall is far, up to here. Of plain walls, blurred walls, the three
    values of the map and this, features are found again most often in this."""
    pixels: Annotated[int, Bounds(200, 3000, 100, "", "", "longest side")] = 1500
    """Pixels on the longest side of a picture; a larger map is drawn coarser. A pixel is never finer than
    the coarser map's cell."""

    def __post_init__(self) -> None:
        check_bounds(self)


@dataclass(frozen=True, eq=False)
class Picture:
    """A map as a picture.

    pixels : (H, W) uint8, row 0 at the bottom; 0 on a wall, 255 from the reach on
    cell   : metres per pixel
    low    : (2,) where the corner of pixel (0, 0) lies; metres, in the axes of the grid
    grid   : the map it was made from
    """

    pixels: NDArray[np.uint8]
    cell: float
    low: FloatArray
    grid: GridMap

    def places(self, at: FloatArray) -> FloatArray:
        """(N, 2) column and row, whole numbers at a pixel's middle, as (N, 2) metres of the map's frame."""
        return self.grid.origin.apply((at + 0.5) * self.cell + self.low)


def known_cells(grid: GridMap) -> tuple[slice, slice]:
    """Rows and columns of the smallest part of the grid that holds all it knows; all of an unknown one."""
    known = grid.cells != UNKNOWN
    rows, cols = np.flatnonzero(known.any(axis=1)), np.flatnonzero(known.any(axis=0))
    if len(rows) == 0:
        return slice(0, grid.height), slice(0, grid.width)
    return slice(int(rows[0]), int(rows[-1]) + 1), slice(int(cols[0]), int(cols[-1]) + 1)


def common_cell(ref: GridMap, mov: GridMap, pixels: int) -> float:
    """Metres per pixel for pictures of both maps of so many pixels on their longest side at most."""
    sides = []
    for grid in (ref, mov):
        rows, cols = known_cells(grid)
        sides.append(max(rows.stop - rows.start, cols.stop - cols.start) * grid.resolution)
    return float(max(ref.resolution, mov.resolution, max(sides) / pixels))


def drawn(mask: NDArray[np.bool_], resolution: float, cell: float, margin: int) -> NDArray[np.bool_]:
    """A mask of cells on pixels that are as coarse or coarser: set where a set cell's centre falls."""
    height, width = (int(np.ceil(side * resolution / cell - 1e-6)) for side in mask.shape)
    out = np.zeros((height + 2 * margin, width + 2 * margin), dtype=np.bool_)
    rows, cols = np.nonzero(mask)
    scale = resolution / cell
    out[((rows + 0.5) * scale).astype(np.intp) + margin, ((cols + 0.5) * scale).astype(np.intp) + margin] = (
        True
    )
    return out


def picture(grid: GridMap, cell: float, config: PictureConfig) -> Picture:
    """The map's distance to the next wall, of what is known and a margin around it."""
    rows, cols = known_cells(grid)
    walls = drawn(grid.occupied[rows, cols], grid.resolution, cell, MARGIN)
    far = np.full(walls.shape, config.reach, dtype=np.float32)
    if walls.any():
        far = cv2.distanceTransform((~walls).astype(np.uint8), cv2.DIST_L2, cv2.DIST_MASK_PRECISE) * cell
    pixels = np.rint(255 * np.minimum(far / config.reach, 1.0)).astype(np.uint8)
    low = np.array([cols.start, rows.start]) * grid.resolution - MARGIN * cell
    return Picture(pixels, cell, low, grid)
