"""Maps and their transforms become one map: what agrees, what contradicts, and the merged grid."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from enum import Enum
from math import ceil, cos, floor, sin

import numpy as np

from algorithms.common.parallel_kernels import kernel, run_in_threads
from algorithms.common.pose import FloatArray, Pose2
from algorithms.maps.grid_map import (
    FREE,
    FREE_UP_TO,
    OCCUPIED_FROM,
    UNKNOWN,
    CellArray,
    GridMap,
    check_size,
)
from algorithms.maps.robots import NO_ROBOTS, Robots

SAME_CELL = 1e-6  # of a cell's edge; what rounding in a file may make of it
SAME_TIME = 60.0  # seconds; maps that were written so near to each other were copied together
SAME_PLACE = 0.12  # metres; a wall that both maps show so near to each other is one, and no robot


class ConflictRule(str, Enum):
    """Which map is believed where one says wall and the other says free."""

    OCCUPIED_WINS = "occupied-wins"  # no robot drives into a wall that only one robot saw
    REF_WINS = "map1-wins"
    MOV_WINS = "map2-wins"
    NEWER_WINS = "newer-wins"  # by the dates of the files; where they do not tell, a wall wins
    SURER_WINS = "more-often-seen"  # whose cell is further from 50 %; of equal ones the wall wins


@dataclass(frozen=True, eq=False)
class Fusion:
    """The merged map and what the maps say of each other where more than one knows.

    merged      : bounding box of all maps in the first one's frame, aligned with its grid
    layers      : (H, W) int8 each, every map alone on the merged grid; −1 where it knows nothing
    agreed      : cells where both are free or both are walls
    agreed_walls : cells where both are walls
    conflicting : cells where one is a wall and the other is free
    cleared     : wall cells of one map around the maker of the other, which were that robot: now floor
    resolutions : of every map as it was given; metres per cell
    dates       : when each was made, as in GridMap
    rule        : by which they were merged
    """

    merged: GridMap
    layers: tuple[CellArray, ...]
    agreed: int
    agreed_walls: int
    conflicting: int
    cleared: int = 0
    resolutions: tuple[float, ...] = ()
    dates: tuple[float | None, ...] = ()
    rule: ConflictRule = ConflictRule.OCCUPIED_WINS

    def merged_by(self, rule: ConflictRule) -> CellArray:
        """(H, W) int8: the merged map's cells by another rule; may be those of ``merged``, not writeable."""
        if rule is self.rule:
            return self.merged.cells
        merged: CellArray = self.layers[0].copy()
        for number, layer in enumerate(self.layers[1:], 1):
            _merge(merged, layer, merged, _code(rule, self.dates, number))
        merged.flags.writeable = False
        return merged

    @property
    def resampled(self) -> dict[int, float]:
        """The maps that came in coarser cells than the merged one's: number, from 1, and metres per cell."""
        return {
            number: cell
            for number, cell in enumerate(self.resolutions, 1)
            if not np.isclose(cell, self.merged.resolution, rtol=SAME_CELL)
        }

    @property
    def ref_cells(self) -> CellArray:
        """(H, W) int8, map 1 alone."""
        return self.layers[0]

    @property
    def mov_cells(self) -> CellArray:
        """(H, W) int8, map 2 alone."""
        return self.layers[1]

    @property
    def overlap(self) -> int:
        """Cells known to both maps."""
        return self.agreed + self.conflicting

    @property
    def acceptance_index(self) -> float:
        """agr / (agr + dis) over cells known in both (Birk and Carpin 2006); 0 without overlap."""
        return self.agreed / self.overlap if self.overlap else 0.0


def fuse(
    maps: Sequence[GridMap],
    transforms: Sequence[Pose2],
    rule: ConflictRule = ConflictRule.OCCUPIED_WINS,
    robots: Robots = NO_ROBOTS,
) -> Fusion:
    """Merge maps under their transforms to the first one's frame; the first transform is the identity.

    The merged grid takes the finest of the resolutions, so nothing is lost by coarsening; at
    equal resolutions its cells are the first map's own, not resampled. A merged cell is free only
    where a map knows it to be free. No wall cell of a further map is lost in the turn: each also marks
    the merged cell that its centre falls on. Where a robot stood, the other's map may show it as a ring of
    wall: what its own map does not show, too, is floor.

    robots : where those of the first two maps stood
    raises TooLargeError where the bounding box of all is over the bound of one map
    """
    ref = maps[0]
    cell = min(grid.resolution for grid in maps)
    if np.isclose(ref.resolution, cell, rtol=SAME_CELL):
        cell = ref.resolution
    to_grid = ref.origin.inverse()  # the first grid's own axes, metres
    corners = [np.array([[0.0, 0.0], [ref.width, ref.height]]) * ref.resolution]
    corners += [(to_grid @ T).apply(grid.corners()) for grid, T in zip(maps[1:], transforms[1:], strict=True)]
    edges = np.concatenate(corners) / cell
    # a corner that rounding put a hair outside must not add a row
    low_col, low_row = (floor(edge + 1e-6) for edge in edges.min(axis=0).tolist())
    high_col, high_row = (ceil(edge - 1e-6) for edge in edges.max(axis=0).tolist())
    shape = (high_row - low_row, high_col - low_col)
    check_size(shape[1], shape[0], "the merged map")
    T_grid_merged = Pose2(low_col * cell, low_row * cell)
    layers = tuple(np.full(shape, UNKNOWN, dtype=np.int8) for _ in maps)
    if cell == ref.resolution:
        layers[0][-low_row : ref.height - low_row, -low_col : ref.width - low_col] = ref.cells
    else:
        look_up(ref, T_grid_merged, cell, layers[0])
    for grid, T, layer in zip(maps[1:], transforms[1:], layers[1:], strict=True):
        look_up(grid, grid.origin.inverse() @ T.inverse() @ ref.origin @ T_grid_merged, cell, layer)
        walls = (T_grid_merged.inverse() @ (to_grid @ T)).apply(grid.points) / cell
        cols, rows = np.floor(walls).astype(np.intp).T
        inside = (rows >= 0) & (rows < shape[0]) & (cols >= 0) & (cols < shape[1])
        np.maximum.at(layer, (rows[inside], cols[inside]), grid.cells[grid.occupied][inside])
    corner = ref.origin @ T_grid_merged
    cleared = 0
    for own, T, places in zip(layers, transforms, (robots.in_ref, robots.in_mov), strict=False):
        at = corner.inverse().apply(T.apply(places)) / cell
        for other in layers:
            if other is not own:
                cleared += _clear(other, own, at, robots.size / cell, SAME_PLACE / cell)
    merged = layers[0].copy()
    dates = tuple(grid.made for grid in maps)
    counts = [
        _merge(merged, layer, merged, _code(rule, dates, number))
        for number, layer in enumerate(layers[1:], 1)
    ]
    agreed_free, agreed_walls, conflicting = (sum(count[k] for count in counts) for k in range(3))
    return Fusion(
        GridMap(merged, cell, corner, "merged"),
        layers,
        agreed=agreed_free + agreed_walls,
        agreed_walls=agreed_walls,
        conflicting=conflicting,
        cleared=cleared,
        resolutions=tuple(grid.resolution for grid in maps),
        dates=dates,
        rule=rule,
    )


def newer(dates: Sequence[float | None], number: int = 1) -> ConflictRule | None:
    """Which of the first map and that of a number, from 0, wins by its date; None where neither does."""
    first, other = (dates[0], dates[number]) if len(dates) > number else (None, None)
    if first is None or other is None or abs(first - other) <= SAME_TIME:
        return None
    return ConflictRule.MOV_WINS if other > first else ConflictRule.REF_WINS


def _code(rule: ConflictRule, dates: Sequence[float | None], number: int) -> int:
    """The rule for the first map and another as ``_merge`` takes it."""
    if rule is ConflictRule.NEWER_WINS:
        rule = newer(dates, number) or ConflictRule.OCCUPIED_WINS
    return [*ConflictRule].index(rule)


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


def look_up(source: GridMap, T_source_target: Pose2, cell: float, target: CellArray) -> None:
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
    """Fill ``out``, which may be ``ref``; count cells free in both, walls in both, and contradictions."""
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
                if rule == 4:  # both are certain alike: the wall
                    a_sure, b_sure = abs(2 * int(a) - 100), abs(2 * int(b) - 100)
                    take_mov = b_sure > a_sure or (a_sure == b_sure and b_wall)
            elif not (a_wall or a_free) and (b_wall or b_free):
                take_mov = True  # one is undecided, the other knows
            out[row, col] = b if take_mov else a
    return agreed_free, agreed_walls, conflicting
