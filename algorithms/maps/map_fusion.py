"""Two maps and a transform become one map: what agrees, what contradicts, and the merged grid."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from math import ceil, cos, floor, sin

import numpy as np

from algorithms.common.parallel_kernels import kernel, run_in_threads
from algorithms.common.pose import FloatArray, Pose2
from algorithms.maps.grid_map import (
    FREE,
    FREE_UP_TO,
    OCCUPIED,
    OCCUPIED_FROM,
    UNKNOWN,
    CellArray,
    GridMap,
    check_size,
)
from algorithms.maps.robots import NOWHERE, Robots

SAME_PLACE = 0.12  # metres; a wall that both maps show so near to each other is one, and no robot


class ConflictRule(str, Enum):
    """Which map is believed where one says wall and the other says free."""

    OCCUPIED_WINS = "occupied-wins"  # no robot drives into a wall that only one robot saw
    REF_WINS = "map1-wins"
    MOV_WINS = "map2-wins"


@dataclass(frozen=True, eq=False)
class Fusion:
    """The merged map and what the two maps say of each other where both know.

    merged      : bounding box of both maps in the ref frame, aligned with the ref grid
    ref_cells, mov_cells : (H, W) int8, each map alone on the merged grid; −1 where it knows nothing
    agreed      : cells where both are free or both are walls
    agreed_walls : cells where both are walls
    conflicting : cells where one is a wall and the other is free
    cleared     : wall cells of one map around the maker of the other, which were that robot: now floor
    """

    merged: GridMap
    ref_cells: CellArray
    mov_cells: CellArray
    agreed: int
    agreed_walls: int
    conflicting: int
    cleared: int = 0

    @property
    def overlap(self) -> int:
        """Cells known to both maps."""
        return self.agreed + self.conflicting

    @property
    def acceptance_index(self) -> float:
        """agr / (agr + dis) over cells known in both (Birk and Carpin 2006); 0 without overlap."""
        return self.agreed / self.overlap if self.overlap else 0.0


def fuse(
    ref: GridMap,
    mov: GridMap,
    T_ref_mov: Pose2,
    conflict: ConflictRule = ConflictRule.OCCUPIED_WINS,
    robots: Robots = NOWHERE,
) -> Fusion:
    """Merge two maps under a transform.

    The merged grid takes the finer of the two resolutions, so nothing is lost by coarsening; at
    equal resolutions its cells are the ref map's own, not resampled. A merged cell is free only
    where a map knows it to be free. No wall cell of the mov map is lost in the turn: each also marks
    the merged cell that its centre falls on. Where a robot stood, the other's map may show it as a ring of
    wall: what its own map does not show, too, is floor.

    robots : where they stood
    raises TooLargeError where the bounding box of both is over the bound of one map
    """
    cell = min(ref.resolution, mov.resolution)
    if np.isclose(ref.resolution, mov.resolution, rtol=1e-6):
        cell = ref.resolution
    T_grid_mov = ref.origin.inverse() @ T_ref_mov  # the ref grid's own axes, metres
    ref_corners = np.array([[0.0, 0.0], [ref.width, ref.height]]) * ref.resolution
    corners = np.concatenate([ref_corners, T_grid_mov.apply(mov.corners())]) / cell
    # a corner that rounding put a hair outside must not add a row
    low_col, low_row = (floor(edge + 1e-6) for edge in corners.min(axis=0).tolist())
    high_col, high_row = (ceil(edge - 1e-6) for edge in corners.max(axis=0).tolist())
    shape = (high_row - low_row, high_col - low_col)
    check_size(shape[1], shape[0], "the merged map")
    T_grid_merged = Pose2(low_col * cell, low_row * cell)
    ref_cells = np.full(shape, UNKNOWN, dtype=np.int8)
    if cell == ref.resolution:
        ref_cells[-low_row : ref.height - low_row, -low_col : ref.width - low_col] = ref.cells
    else:
        _look_up(ref, T_grid_merged, cell, ref_cells)
    mov_cells = np.full(shape, UNKNOWN, dtype=np.int8)
    T_movgrid_merged = mov.origin.inverse() @ T_ref_mov.inverse() @ ref.origin @ T_grid_merged
    _look_up(mov, T_movgrid_merged, cell, mov_cells)
    walls = (T_grid_merged.inverse() @ T_grid_mov).apply(mov.points) / cell
    cols, rows = np.floor(walls).astype(np.intp).T
    inside = (rows >= 0) & (rows < shape[0]) & (cols >= 0) & (cols < shape[1])
    mov_cells[rows[inside], cols[inside]] = OCCUPIED
    corner = ref.origin @ T_grid_merged
    mov_places = T_ref_mov.apply(robots.in_mov)
    cleared = sum(
        _clear(other, own, corner.inverse().apply(places) / cell, robots.size / cell, SAME_PLACE / cell)
        for other, own, places in ((mov_cells, ref_cells, robots.in_ref), (ref_cells, mov_cells, mov_places))
    )
    merged = np.empty(shape, dtype=np.int8)
    agreed_free, agreed_walls, conflicting = _merge(
        ref_cells, mov_cells, merged, [*ConflictRule].index(conflict)
    )
    return Fusion(
        merged=GridMap(merged, cell, corner, "merged"),
        ref_cells=ref_cells,
        mov_cells=mov_cells,
        agreed=agreed_free + agreed_walls,
        agreed_walls=agreed_walls,
        conflicting=conflicting,
        cleared=cleared,
    )


def _clear(other: CellArray, own: CellArray, places: FloatArray, size: float, same: float) -> int:
    """Turn walls of ``other`` around places into floor; how many. Stays what ``own``, the map that the robot
    there has made, shows as well.

    places, size : (N, 2) columns and rows; cells
    same         : how near a wall of ``own`` must be; cells
    """
    cleared, reach, near = 0, ceil(size), ceil(same)
    for x, y in places.tolist():
        top, left = max(0, floor(y) - reach), max(0, floor(x) - reach)
        rows, cols = slice(top, floor(y) + reach + 1), slice(left, floor(x) + reach + 1)
        walls = other[rows, cols] >= OCCUPIED_FROM
        if not walls.any():
            continue
        down, right = np.nonzero(walls)
        inside = np.hypot(right + left + 0.5 - x, down + top + 0.5 - y) <= size
        for row, col in zip((down + top)[inside].tolist(), (right + left)[inside].tolist(), strict=True):
            part = own[max(0, row - near) : row + near + 1, max(0, col - near) : col + near + 1]
            if not (part >= OCCUPIED_FROM).any():
                other[row, col] = FREE
                cleared += 1
    return cleared


def _look_up(source: GridMap, T_source_target: Pose2, cell: float, target: CellArray) -> None:
    """Fill ``target`` with the source cell under each of its centres; outside stays as it is."""
    scale = cell / source.resolution
    c, s = cos(T_source_target.theta) * scale, sin(T_source_target.theta) * scale
    x, y = T_source_target.x / source.resolution, T_source_target.y / source.resolution

    def work(start: int, stop: int) -> None:
        _look_up_rows(source.cells, c, s, x, y, start, stop, target)

    run_in_threads(work, len(target), at_least=1 + 1_000_000 // target.shape[1])


@kernel
def _look_up_rows(
    source: CellArray, c: float, s: float, x: float, y: float, start: int, stop: int, out: CellArray
) -> None:
    rows, cols = source.shape
    for row in range(start, stop):
        for col in range(out.shape[1]):
            u = c * (col + 0.5) - s * (row + 0.5) + x
            v = s * (col + 0.5) + c * (row + 0.5) + y
            if 0.0 <= u < cols and 0.0 <= v < rows:
                out[row, col] = source[int(v), int(u)]


@kernel
def _merge(ref: CellArray, mov: CellArray, out: CellArray, rule: int) -> tuple[int, int, int]:
    """Fill ``out``; count cells free in both, walls in both, and contradictions."""
    agreed_free = 0
    agreed_walls = 0
    conflicting = 0
    for row in range(ref.shape[0]):
        for col in range(ref.shape[1]):
            a, b = ref[row, col], mov[row, col]
            a_wall, b_wall = a >= OCCUPIED_FROM, b >= OCCUPIED_FROM
            a_free, b_free = FREE <= a <= FREE_UP_TO, FREE <= b <= FREE_UP_TO
            agreed_free += a_free and b_free
            agreed_walls += a_wall and b_wall
            take_mov = a == UNKNOWN
            if (a_wall and b_free) or (a_free and b_wall):
                conflicting += 1
                take_mov = b_wall if rule == 0 else rule == 2
            elif not (a_wall or a_free) and (b_wall or b_free):
                take_mov = True  # one is undecided, the other knows
            out[row, col] = b if take_mov else a
    return agreed_free, agreed_walls, conflicting
