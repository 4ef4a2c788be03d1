"""What a person corrects in a merged map: which map is believed where, what is erased, where no robot may go.

A correction lies in map 1's frame and changes the merged map alone: neither the two maps nor the verdict on
their merge know of it.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import pairwise
from math import ceil, cos, floor, hypot, sin, sqrt
from typing import Literal
from weakref import WeakKeyDictionary

import numpy as np

from algorithms.common.errors import SettingError
from algorithms.common.pose import FloatArray, Pose2
from algorithms.maps.grid_map import (
    FARTHEST,
    FREE,
    FREE_UP_TO,
    OCCUPIED,
    OCCUPIED_FROM,
    UNKNOWN,
    BoolArray,
    CellArray,
    GridMap,
)
from algorithms.maps.map_fusion import ConflictRule, Fusion

Does = Literal["map1", "map2", "unknown", "erase", "keep-out"]
"""Where the maps contradict each other map 1's cells, map 2's, or unknown; floor in place of all walls; or a
wall that no robot saw.
"""

Point = tuple[float, float]

GHOST = 0.4  # metres around a robot in which its ghost may stand
MOST_EDITS = 2000
MOST_POINTS = 400  # of one edit
WIDEST = 100.0  # metres
PIECE = 64.0  # cells; a longer line is looked at in pieces


@dataclass(frozen=True)
class Edit:
    """One thing that was corrected.

    points : of a line, one or more; of a rectangle along the axes two opposite corners; metres, map 1's frame
    radius : how far beside the line it reaches, but a cell at the least; metres
    box    : whether it is a rectangle
    raises : SettingError where there is no such place
    """

    does: Does
    points: tuple[Point, ...]
    radius: float = 0.0
    box: bool = False

    def __post_init__(self) -> None:
        there = all(abs(number) <= FARTHEST for point in self.points for number in point)  # NaN is not
        if not (0 < len(self.points) <= MOST_POINTS and there):
            raise SettingError(f"a correction has 1 to {MOST_POINTS} points on the map")
        if not 0 <= self.radius <= WIDEST or (self.box and len(self.points) != 2):
            raise SettingError(f"a correction reaches 0 to {WIDEST:g} m; a rectangle has two corners")


@dataclass(frozen=True)
class Corrections:
    """All that was corrected.

    rule  : which map is believed where they contradict each other; None: as they were merged
    edits : in the order in which they were made; later ones go over earlier ones
    crop  : whether the map ends where nothing more is known
    """

    rule: ConflictRule | None = None
    edits: tuple[Edit, ...] = ()
    crop: bool = False

    def __post_init__(self) -> None:
        if len(self.edits) > MOST_EDITS:
            raise SettingError(f"a map takes {MOST_EDITS:,} corrections; merge again from the corrected map")

    def chosen_at(self, point: Point) -> Does | None:
        """What was chosen for one place, by its middle."""
        return next((each.does for each in reversed(self.edits) if _is_choice(each, point)), None)

    def choosing(self, does: Does | None, point: Point, radius: float) -> Corrections:
        """The same with that choice for one place in the place of any earlier one; None: with none."""
        rest = tuple(each for each in self.edits if not _is_choice(each, point))
        return replace(self, edits=rest if does is None else (*rest, Edit(does, (point,), radius)))


NO_CORRECTIONS = Corrections()
_RULED: WeakKeyDictionary[Fusion, tuple[ConflictRule, CellArray]] = WeakKeyDictionary()  # the last of each


@dataclass(frozen=True, eq=False)
class Corrected:
    """The corrected map, how many of the merged map's cells say something else now, and by what."""

    grid: GridMap
    changed: int
    by: Corrections


def corrected(fusion: Fusion, corrections: Corrections) -> Corrected:
    """The merged map of two as a person corrected it; ``fusion`` stays as it is."""
    merged = fusion.merged
    cells = merged.cells if corrections.rule is None else _ruled(fusion, corrections.rule)
    if corrections.edits:
        cells = cells.copy()
    for edit in corrections.edits:
        for rows, cols, inside in _windows(edit, merged):
            _apply(edit.does, fusion, (rows, cols), inside, cells)
    changed = 0 if cells is merged.cells else int(np.count_nonzero(cells != merged.cells))
    grid = replace(merged, cells=cells) if changed else merged
    return Corrected(cropped(grid) if corrections.crop else grid, changed, corrections)


def _ruled(fusion: Fusion, rule: ConflictRule) -> CellArray:
    """The merged map's cells by another rule: worked out once, not for every stroke of a brush."""
    if fusion not in _RULED or _RULED[fusion][0] is not rule:
        _RULED[fusion] = rule, fusion.merged_by(rule)
    return _RULED[fusion][1]


def cropped(grid: GridMap) -> GridMap:
    """The smallest part of a map that holds all that is known; one that knows nothing as it is."""
    known = grid.cells != UNKNOWN
    rows, cols = (np.flatnonzero(known.any(axis=axis)) for axis in (1, 0))
    if not len(rows) or (len(rows), len(cols)) == grid.cells.shape:
        return grid
    top, left = int(rows[0]), int(cols[0])
    cells = np.ascontiguousarray(grid.cells[top : rows[-1] + 1, left : cols[-1] + 1])
    corner = Pose2(left * grid.resolution, top * grid.resolution)
    return replace(grid, cells=cells, origin=grid.origin @ corner)


def ghosts(grid: GridMap, places: FloatArray) -> tuple[tuple[Edit, ...], int]:
    """What erases the walls around robots, and how many cells those are.

    places : (N, 2) where robots stood; metres, the grid's frame
    """
    edits = tuple(Edit("erase", ((x, y),), GHOST) for x, y in places.tolist())
    cells = {
        (rows.start + row, cols.start + col)
        for edit in edits
        for rows, cols, inside in _windows(edit, grid)
        for row, col in np.argwhere(inside & (grid.cells[rows, cols] >= OCCUPIED_FROM)).tolist()
    }
    return edits, len(cells)


def _is_choice(edit: Edit, point: Point) -> bool:
    """Whether an edit says which map counts at the place of that middle."""
    apart = hypot(edit.points[0][0] - point[0], edit.points[0][1] - point[1])
    return edit.does in ("map1", "map2", "unknown") and apart < 1e-3


def _apply(does: Does, fusion: Fusion, at: tuple[slice, slice], inside: BoolArray, cells: CellArray) -> None:
    """Change the cells of a window that are inside."""
    part = cells[at]
    if does == "keep-out":
        part[inside] = OCCUPIED
        return
    if does == "erase":
        part[inside & (part > FREE_UP_TO)] = FREE
        return
    ref, mov = fusion.ref_cells[at], fusion.mov_cells[at]
    one, two = ((a >= OCCUPIED_FROM) & (b >= FREE) & (b <= FREE_UP_TO) for a, b in ((ref, mov), (mov, ref)))
    denied = inside & (one | two)
    part[denied] = UNKNOWN if does == "unknown" else (ref if does == "map1" else mov)[denied]


def _windows(edit: Edit, grid: GridMap) -> Iterator[tuple[slice, slice, BoolArray]]:
    """Parts of a grid, rows and columns, and which of their cells the edit reaches: their centres count."""
    points = grid.grid_coordinates(np.array(edit.points, dtype=float))
    if edit.box:
        low, high = (edge(np.array(edit.points), axis=0) for edge in (np.min, np.max))
        corners = np.array([low, (high[0], low[1]), high, (low[0], high[1])])
        window = _window(grid.grid_coordinates(corners), 0.0, grid)
        if window is not None:
            yield *window, _in_box(window, grid, low, high)
        return
    reach = max(edit.radius / grid.resolution, sqrt(0.5))  # of a thin line all cells that it goes through
    for start, end in [*pairwise(points)] or [(points[0], points[0])]:
        pieces = max(1, ceil(hypot(*(end - start).tolist()) / PIECE))
        for a, b in pairwise(np.linspace(start, end, pieces + 1)):
            window = _window(np.array([a, b]), reach, grid)
            if window is not None:
                yield *window, _near(window, a, b, reach)


def _window(points: FloatArray, reach: float, grid: GridMap) -> tuple[slice, slice] | None:
    """Rows and columns of a grid around points in its cells; None where none of it is on the grid."""
    (left, low), (right, high) = (points.min(axis=0) - reach).tolist(), (points.max(axis=0) + reach).tolist()
    rows = slice(max(0, floor(low)), min(grid.height, ceil(high)))
    cols = slice(max(0, floor(left)), min(grid.width, ceil(right)))
    return (rows, cols) if rows.start < rows.stop and cols.start < cols.stop else None


def _centres(window: tuple[slice, slice]) -> tuple[FloatArray, FloatArray]:
    """(1, W) columns and (H, 1) rows of the centres of a window's cells."""
    rows, cols = window
    return np.arange(cols.start, cols.stop)[None] + 0.5, np.arange(rows.start, rows.stop)[:, None] + 0.5


def _near(window: tuple[slice, slice], a: FloatArray, b: FloatArray, reach: float) -> BoolArray:
    """Whose centres lie within reach of the line from a to b; all in cells."""
    u, v = _centres(window)
    (x, y), (dx, dy) = a.tolist(), (b - a).tolist()
    square = dx * dx + dy * dy
    along = np.clip(((u - x) * dx + (v - y) * dy) / square, 0.0, 1.0) if square > 0 else np.zeros_like(u + v)
    inside = (u - x - along * dx) ** 2 + (v - y - along * dy) ** 2 <= reach * reach
    return np.asarray(inside)


def _in_box(window: tuple[slice, slice], grid: GridMap, low: FloatArray, high: FloatArray) -> BoolArray:
    """Whose centres lie between two corners of the map's frame; metres."""
    u, v = (each * grid.resolution for each in _centres(window))
    c, s = cos(grid.origin.theta), sin(grid.origin.theta)
    x, y = c * u - s * v + grid.origin.x, s * u + c * v + grid.origin.y
    inside = (x >= low[0]) & (x <= high[0]) & (y >= low[1]) & (y <= high[1])
    return np.asarray(inside)
