"""A map as a picture for methods of image registration: how far the next wall is, pixel by pixel."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Annotated, Any

import cv2
import numpy as np
from numpy.typing import NDArray

from algorithms.common.pose import FloatArray, Pose2, rotation
from algorithms.common.setting_bounds import Bounds, CheckedConfig
from algorithms.maps.grid_map import UNKNOWN, BoolArray, GridMap
from algorithms.maps.wall_distance import distance_to_walls

MARGIN = 64  # pixels around what is known, where its rim is to be described as well as the rest


@dataclass(frozen=True)
class PictureConfig(CheckedConfig):
    """How a map becomes a picture."""

    reach: Annotated[float, Bounds(0.1, 3, 0.05, "m", "", "shading")] = 0.4
    """A pixel is as bright as the next wall is far, up to here. Of plain walls, blurred walls, the three
    values of the map and this, features are found again most often in this."""
    pixels: Annotated[int, Bounds(200, 3000, 100, "", "", "longest side")] = 1500
    """Pixels on the longest side of a picture; a larger map is drawn coarser. A pixel is never finer than
    the coarser map's cell."""


@dataclass(frozen=True, eq=False)
class DistanceImage:
    """A map as a picture; row 0 is the bottom.

    far   : (H, W) float32, distance to the next wall over the reach; 0 on a wall, 1 from the reach on
    known : (H, W) bool, where the map knows anything
    cell  : metres per pixel
    low   : (2,) where the corner of pixel (0, 0) lies; metres, in the axes of the grid
    grid  : the map it was made from
    """

    far: NDArray[np.float32]
    known: BoolArray
    cell: float
    low: FloatArray
    grid: GridMap

    @cached_property
    def grey(self) -> NDArray[np.uint8]:
        """(H, W) the distance in 256 steps; 0 on a wall."""
        return np.asarray(np.rint(255 * self.far), dtype=np.uint8)

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


def drawn(mask: BoolArray, resolution: float, cell: float, margin: int) -> BoolArray:
    """A mask of cells on pixels that are as coarse or coarser: set where a set cell's centre falls."""
    height, width = (int(np.ceil(side * resolution / cell - 1e-6)) for side in mask.shape)
    out = np.zeros((height + 2 * margin, width + 2 * margin), dtype=np.bool_)
    rows, cols = (((at + 0.5) * (resolution / cell)).astype(np.intp) + margin for at in np.nonzero(mask))
    out[rows, cols] = True
    return out


def picture(grid: GridMap, cell: float, reach: float, margin: int = 0) -> DistanceImage:
    """The map's distance to the next wall, of what is known.

    reach  : up to which distances are told apart; metres
    margin : pixels more on every side
    """
    rows, cols = known_cells(grid)
    walls = drawn(grid.occupied[rows, cols], grid.resolution, cell, margin)
    known = drawn(grid.cells[rows, cols] != UNKNOWN, grid.resolution, cell, margin)
    far = np.minimum(cell * distance_to_walls(walls) / reach, 1).astype(np.float32)
    low = np.array([cols.start, rows.start]) * grid.resolution - margin * cell
    return DistanceImage(far, known, cell, low, grid)


@dataclass(frozen=True, eq=False)
class Turn:
    """A picture's frame, turned about its middle, on a square that holds it at every turn.

    angle  : radians, counter-clockwise
    matrix : (2, 3) takes column and row to those of the square
    side   : of the square; pixels
    """

    angle: float
    matrix: FloatArray
    side: int

    @staticmethod
    def of(shape: tuple[int, ...], angle: float) -> Turn:
        """The turn of a picture of this shape."""
        height, width = shape
        side = int(np.hypot(height, width)) + 2
        turn = rotation(angle)
        middle = np.array([side - 1, side - 1]) / 2 - turn @ (np.array([width - 1, height - 1]) / 2)
        return Turn(angle, np.column_stack([turn, middle]), side)

    def __call__(self, pixels: NDArray[Any], outside: float = 0.0) -> NDArray[Any]:
        """(side, side) the picture turned; ``outside`` where there is none of it."""
        size = (self.side, self.side)
        return np.asarray(cv2.warpAffine(pixels, self.matrix, size, borderValue=outside))

    def there(self, at: FloatArray) -> FloatArray:
        """(N, 2) columns and rows of the picture as those of the square."""
        return np.asarray(at @ self.matrix[:, :2].T + self.matrix[:, 2], dtype=np.float64)

    def back(self, at: FloatArray) -> FloatArray:
        """(N, 2) columns and rows of the square as those of the picture."""
        return np.asarray((at - self.matrix[:, 2]) @ self.matrix[:, :2], dtype=np.float64)


def pose_of(ref: DistanceImage, mov: DistanceImage, turn: Turn, shift: FloatArray) -> Pose2:
    """T_ref_mov that turns mov's picture and then moves it by (2,) columns and rows over ref's."""
    first = np.full(2, 0.5 * mov.cell) + mov.low
    there = (turn.matrix[:, 2] + shift + 0.5) * ref.cell + ref.low
    x, y = (there - rotation(turn.angle) @ first).tolist()
    return ref.grid.origin @ Pose2(x, y, turn.angle) @ mov.grid.origin.inverse()
