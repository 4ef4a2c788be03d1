"""A map made ready to be held against others: its walls as points, and a table of what is near them.

Walls are counted by the side from which they were seen. Where one robot saw a wall from the left and the
other from the right, they may stand on both sides of one thin wall, or the maps have nothing to do with each
other: two rooms laid back to back agree on a wall, whatever buildings they are in.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from math import ceil, pi, sqrt

import numpy as np
from numpy.typing import NDArray

from algorithms.common.parallel_kernels import kernel
from algorithms.common.pose import FloatArray, Pose2
from algorithms.maps.coarse_grid import pooled
from algorithms.maps.grid_map import (
    FREE,
    FREE_UP_TO,
    OCCUPIED_FROM,
    CellArray,
    GridMap,
    where,
)
from algorithms.maps.wall_distance import distances

ByteArray = NDArray[np.uint8]
IntArray = NDArray[np.intp]

SAME_WALL = 0.12  # metres; two drawings of one wall: the sum of two ragged cells of 0.05 m and a bit
ANOTHER_WALL = 0.21  # metres; from here on they are two walls; between the two, something of both
NEAR_WALL = 0.3  # metres; a wall in unknown ground counts as seen by both where the other has one so near
COARSE = 0.04  # metres; finer cells are taken together, for nothing here depends on less
AROUND = 0.1  # metres around a wall cell in which another one must lie, or it is a speck
MOST_POINTS = 8_000  # of a map's walls; of a longer wall every second, third … cell stands for all
MOST_FLOOR = 60_000  # likewise of its floor

SECTORS = 8  # directions from which a wall may have been seen, of 45°
ANY_SIDE = 255  # a wall with free floor all around it

NOTHING, NEAR = 0, 1  # levels of nearness
LEVELS = 6  # from NEAR on they rise, up to one and the same wall
SHARES: FloatArray = np.array([0.0, 0.0, 0.25, 0.5, 0.75, 1.0])
"""(LEVELS,) how much of one wall two drawings are at each level of nearness."""


@dataclass(frozen=True, eq=False)
class WallMap:
    """A map, cells finer than ``COARSE`` taken together. Points are in the axes of its grid.

    grid     : the map; walls of a single cell are left out of what follows
    points   : (N, 2) wall cells that were seen, with free floor beside them; metres from the grid's corner
    facing   : (N,) direction from which each was seen; radians; NaN: from all around
    metres   : wall that a point stands for
    level    : (H, W) uint8: how near the nearest wall is, NOTHING … LEVELS − 1
    sides    : (H, W) uint8: bits of the sides, give or take one sector, from which walls so near that they
               may be the same were seen
    """

    grid: GridMap
    points: FloatArray
    facing: FloatArray
    metres: float
    level: ByteArray
    sides: ByteArray

    @cached_property
    def floor(self) -> FloatArray:
        """(M, 2) places on free floor, each of which stands for ``floor_area``; metres, axes of the grid."""
        rows, cols = np.nonzero(self.grid.free[:: self._stride, :: self._stride])
        at = np.stack([cols, rows], axis=-1) * self._stride + 0.5
        return np.asarray(at * self.grid.resolution, dtype=np.float64)

    @cached_property
    def middle(self) -> FloatArray:
        """(2,) mean of its walls, of its grid where there are none; metres, the map's own frame."""
        size = np.array([self.grid.width, self.grid.height]) * self.grid.resolution
        middle = self.points.mean(axis=0) if len(self.points) else size / 2
        return self.grid.origin.apply(middle)

    @property
    def floor_area(self) -> float:
        """Floor that a place of ``floor`` stands for; m²."""
        return (self._stride * self.grid.resolution) ** 2

    @property
    def _stride(self) -> int:
        return max(1, ceil(sqrt(self.grid.cells.size / MOST_FLOOR)))


def make_wall_map(grid: GridMap) -> WallMap:
    """Make a map ready; some 5 ms for 500 × 500 cells."""
    grid = pooled(grid, int(COARSE / grid.resolution + 1e-9))
    cell = grid.resolution
    rows, cols = where(grid.occupied)
    reach = max(1, round(AROUND / cell))
    turned = np.zeros(len(rows), dtype=np.float64)
    kind = np.zeros(len(rows), dtype=np.uint8)
    _look_around(grid.cells, rows, cols, reach, turned, kind)
    seen = kind > 0
    rows, cols, turned = rows[seen], cols[seen], turned[seen]
    turned[kind[seen] == 2] = np.nan
    level = np.zeros(grid.cells.shape, dtype=np.uint8)
    sides = np.zeros(grid.cells.shape, dtype=np.uint8)
    down, right, near = _disc(cell)
    _mark(rows, cols, _bits(sectors(turned)), down, right, near, level, sides)
    stride = max(1, ceil(len(rows) / MOST_POINTS))
    points = np.stack([cols[::stride] + 0.5, rows[::stride] + 0.5], axis=-1) * cell
    return WallMap(grid, points, turned[::stride], cell * stride, level, sides)


def _disc(cell: float) -> tuple[IntArray, IntArray, ByteArray]:
    """(K,) rows and columns around a wall, and the level there."""
    same = max(SAME_WALL, 1.2 * cell)  # of coarse cells: the next one is beside it, not another wall
    other = same + (ANOTHER_WALL - SAME_WALL)
    reach = ceil(max(NEAR_WALL, other) / cell)
    metres = distances(reach).astype(np.float64) * cell
    steps = LEVELS - 1 - NEAR
    level = NEAR + np.ceil(steps * (other - metres) / (other - same) - 1e-9)
    level = np.where(metres <= NEAR_WALL, np.maximum(level, NEAR), level)
    level = np.clip(level, NOTHING, LEVELS - 1).astype(np.uint8)
    down, right = np.nonzero(level)
    return down - reach, right - reach, level[down, right]


def _bits(numbers: ByteArray) -> ByteArray:
    """(N,) the side of each wall and those next to it, as bits."""
    bits = np.zeros(len(numbers), dtype=np.uint8)
    for step in (-1, 0, 1):
        bits |= (1 << ((numbers.astype(np.int64) + step) % SECTORS)).astype(np.uint8)
    bits[numbers == ANY_SIDE] = 255
    return bits


def sectors(facing: FloatArray, turn: float = 0.0) -> ByteArray:
    """(N,) numbers of the directions after a turn, ANY_SIDE where there is none; radians."""
    whole = np.rint(np.nan_to_num(facing + turn) * (SECTORS / (2 * pi))).astype(np.int64)
    numbers = (whole % SECTORS).astype(np.uint8)
    numbers[np.isnan(facing)] = ANY_SIDE
    return numbers


def transform_between(target: WallMap, source: WallMap, T_target_source: Pose2) -> Pose2:
    """The same transform, from the axes of the source's grid to those of the target's."""
    return target.grid.origin.inverse() @ T_target_source @ source.grid.origin


@kernel
def _look_around(
    cells: CellArray, rows: IntArray, cols: IntArray, reach: int, turned: FloatArray, kind: ByteArray
) -> None:
    """For each wall cell: 0 no free cell beside it, or a speck; 1 seen from one side, and the direction in
    which that lies; 2 seen from all around.
    """
    height, width = cells.shape
    for n in range(len(rows)):
        row, col = rows[n], cols[n]
        beside, walls = False, 0
        x, y, most = 0, 0, 0
        for i in range(-reach, reach + 1):
            for j in range(-reach, reach + 1):
                r, c = row + i, col + j
                if j > 0:
                    most += j
                if r < 0 or r >= height or c < 0 or c >= width:
                    continue
                value = cells[r, c]
                if value >= OCCUPIED_FROM:
                    walls += 1
                elif FREE <= value <= FREE_UP_TO:
                    x += j
                    y += i
                    beside = beside or (abs(i) <= 1 and abs(j) <= 1)
        if not beside or walls < 2:
            continue
        if 16 * (x * x + y * y) < most * most:  # less than a quarter of what a straight wall has
            kind[n] = 2
        else:
            kind[n] = 1
            turned[n] = np.arctan2(y, x)


@kernel
def _mark(
    rows: IntArray,
    cols: IntArray,
    bits: ByteArray,
    down: IntArray,
    right: IntArray,
    near: ByteArray,
    level: ByteArray,
    sides: ByteArray,
) -> None:
    height, width = level.shape
    for n in range(len(rows)):
        for k in range(len(near)):
            i, j = rows[n] + down[k], cols[n] + right[k]
            if 0 <= i < height and 0 <= j < width:
                level[i, j] = max(level[i, j], near[k])
                if near[k] > NEAR:
                    sides[i, j] |= bits[n]
