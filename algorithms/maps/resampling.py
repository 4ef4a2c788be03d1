"""A map in other cells: of another size, or with its rows along the axes of its frame. No wall is lost."""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import ceil, cos, sin

import numpy as np

from algorithms.common.errors import SettingError
from algorithms.common.parallel_kernels import kernel
from algorithms.common.pose import Pose2, wrap_angle
from algorithms.maps.grid_map import (
    COARSEST,
    FINEST,
    FREE,
    FREE_UP_TO,
    OCCUPIED_FROM,
    UNKNOWN,
    CellArray,
    GridMap,
    check_size,
)
from algorithms.maps.map_fusion import look_up

HAIR = 1e-6  # of a cell; what rounding makes of a corner


@dataclass(frozen=True, eq=False)
class Resampled:
    """A map in other cells, and what has become of those that it came in.

    grid     : the map
    now_wall : cells that were no wall, and whose centre lies in one now
    now_free : cells that were neither wall nor free, and whose centre lies on free floor now
    of       : cells that it came in
    """

    grid: GridMap
    now_wall: int
    now_free: int
    of: int

    @property
    def changed(self) -> int:
        """Cells that say something else now at the place of their centre."""
        return self.now_wall + self.now_free


def resampled(grid: GridMap, resolution: float | None = None, yaw: bool = True) -> Resampled:
    """The map in cells of that size, and with an origin that has no yaw where ``yaw`` is False.

    A new cell holds the old ones whose centre lies in it, and the one that its own centre lies in. A wall
    among them wins over free floor, and that over what is neither; of two walls the likelier counts. So every
    wall cell has its centre in a wall again, and every new one lies on an old one, to half a cell's diagonal.
    Where nothing is asked for it is the map itself, cell for cell.

    resolution : metres per cell; None: as it is
    raises     : SettingError, TooLargeError
    """
    cell = grid.resolution if resolution is None else resolution
    if not FINEST <= cell <= COARSEST:
        raise SettingError(f"a map cannot have cells of {cell:g} m; give {FINEST:g} to {COARSEST:g} m")
    turn = 0.0 if yaw else wrap_angle(grid.origin.theta)
    if cell == grid.resolution and turn == 0.0:
        return Resampled(grid, 0, 0, grid.cells.size)
    T_upright_source = Pose2(theta=turn)  # about the grid's corner
    corners = T_upright_source.apply(replace(grid, origin=Pose2()).corners())
    low, high = corners.min(axis=0), corners.max(axis=0)
    columns, rows = (max(1, ceil(edge - HAIR)) for edge in ((high - low) / cell).tolist())
    check_size(columns, rows, "the map in other cells")
    T_upright_target = Pose2(*low.tolist())
    T_target_source = T_upright_target.inverse() @ T_upright_source
    cells = np.full((rows, columns), UNKNOWN, dtype=np.int8)
    look_up(grid, T_target_source.inverse(), cell, cells)
    T, scale = T_target_source, grid.resolution / cell
    to_cells = cos(T.theta) * scale, sin(T.theta) * scale, T.x / cell, T.y / cell
    _keep_strongest(grid.cells, to_cells, cells)
    changes = _changes(grid.cells, to_cells, cells)
    origin = grid.origin if yaw else replace(grid.origin @ T_target_source.inverse(), theta=0.0)
    return Resampled(replace(grid, cells=cells, resolution=cell, origin=origin), *changes, grid.cells.size)


@kernel
def _kind(value: int) -> int:
    """2 of a wall, 1 of free floor, else 0."""
    if value >= OCCUPIED_FROM:
        return 2
    return 1 if FREE <= value <= FREE_UP_TO else 0


@kernel
def _place(row: int, col: int, turn: tuple[float, ...], shape: tuple[int, int]) -> tuple[int, int]:
    """Row and column of the target in which the centre of a cell lies.

    turn : cosine, sine, x, y of the transform to the target's cells
    """
    c, s, x, y = turn
    u, v = c * (col + 0.5) - s * (row + 0.5) + x, s * (col + 0.5) + c * (row + 0.5) + y
    return min(max(int(v), 0), shape[0] - 1), min(max(int(u), 0), shape[1] - 1)


@kernel
def _keep_strongest(cells: CellArray, turn: tuple[float, ...], target: CellArray) -> None:
    """Put each known cell into that of the target in which its centre lies, where a weaker one is there."""
    for row in range(cells.shape[0]):
        for col in range(cells.shape[1]):
            value = cells[row, col]
            if value == UNKNOWN:
                continue
            i, j = _place(row, col, turn, target.shape)
            kind, there = _kind(value), _kind(target[i, j])
            if kind > there or (kind == there and value > target[i, j]):
                target[i, j] = value


@kernel
def _changes(cells: CellArray, turn: tuple[float, ...], target: CellArray) -> tuple[int, int]:
    """How many cells that are no wall lie in one of the target, and how many unknown ones on free floor."""
    now_wall, now_free = 0, 0
    for row in range(cells.shape[0]):
        for col in range(cells.shape[1]):
            i, j = _place(row, col, turn, target.shape)
            kind, now = _kind(cells[row, col]), _kind(target[i, j])
            now_wall += now == 2 and kind < 2
            now_free += now == 1 and kind == 0
    return now_wall, now_free
