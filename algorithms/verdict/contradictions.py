"""Where two merged maps contradict each other: the walls that the other map denies, gathered into places.

A wall speaks against a merge where the other robot saw free floor and no wall of its own near enough to be
another drawing of it. That is how the evidence counts, with the maps as they are; here it is told by place,
so that a person can go and look.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import ceil

import cv2
import numpy as np
from numpy.typing import NDArray

from algorithms.maps.grid_map import FREE, FREE_UP_TO, OCCUPIED_FROM, BoolArray, CellArray, where
from algorithms.maps.map_fusion import Fusion
from algorithms.maps.wall_distance import distances, is_near_wall
from algorithms.verdict.wall_map import SAME_WALL

IntArray = NDArray[np.intp]

GAP = 0.4  # metres; contradictions nearer to each other than this are one place
LEAST = 0.25  # metres of wall; what is shorter is a speck, not a place


@dataclass(frozen=True)
class Contradiction:
    """One place where the maps contradict each other.

    x, y     : its middle; metres, ref frame
    radius   : of the circle around the middle that holds it; metres
    ref_wall : wall of map 1 where map 2 saw free floor; metres
    mov_wall : wall of map 2 where map 1 saw free floor; metres
    """

    x: float
    y: float
    radius: float
    ref_wall: float
    mov_wall: float

    @property
    def wall(self) -> float:
        """Contradicting wall of both maps; metres."""
        return self.ref_wall + self.mov_wall


@dataclass(frozen=True, eq=False)
class Contradictions:
    """All contradictions of a merge.

    ref_only, mov_only : (H, W) bool on the merged grid: walls of one map where the other saw free floor
    places : most wall first
    specks : wall in patches too short to be a place; metres
    """

    ref_only: BoolArray
    mov_only: BoolArray
    places: tuple[Contradiction, ...]
    specks: float

    @property
    def wall(self) -> float:
        """Contradicting wall of both maps, wherever it is; metres."""
        return sum(place.wall for place in self.places) + self.specks


def find_conflicts(fusion: Fusion, gap: float = GAP) -> Contradictions:
    """Gather the contradictions of a merge into places.

    Only around the walls is anything looked up: a large map is mostly none.

    gap : metres between two contradictions from which on they are two places
    """
    ref, mov = _Side(fusion.ref_cells), _Side(fusion.mov_cells)
    same = SAME_WALL / fusion.merged.resolution
    ref_only, mov_only = ref.denied_by(mov, same), mov.denied_by(ref, same)
    places, specks = _places(fusion, ref.seen(ref_only), mov.seen(mov_only), ref_only, mov_only, gap)
    return Contradictions(ref_only, mov_only, places, specks)


class _Side:
    """What one map says on the merged grid."""

    def __init__(self, cells: CellArray) -> None:
        self.cells = cells
        self.walls: BoolArray = cells >= OCCUPIED_FROM

    def free_at(self, rows: IntArray, cols: IntArray) -> BoolArray:
        """(N,) whether it is known to be free there."""
        cells = self.cells[rows, cols]
        return np.asarray((cells >= FREE) & (cells <= FREE_UP_TO))

    def denied_by(self, other: _Side, same: float) -> BoolArray:
        """(H, W) walls where the other saw free floor and has no wall within so many cells."""
        rows, cols = where(self.walls)
        denied = other.free_at(rows, cols)
        rows, cols = rows[denied], cols[denied]
        disc = np.argwhere(distances(ceil(same)) <= same) - ceil(same)
        drawn = _any_beside(rows, cols, disc, self.walls.shape, lambda row, col: other.walls[row, col])
        only = np.zeros(self.walls.shape, dtype=np.bool_)
        only[rows[~drawn], cols[~drawn]] = True
        return only

    def seen(self, walls: BoolArray) -> BoolArray:
        """(N,) which of these walls have a free cell beside them, as ``agreement.surface`` defines it."""
        rows, cols = where(walls)
        return _any_beside(rows, cols, np.argwhere(np.ones((3, 3))) - 1, walls.shape, self.free_at)


def _any_beside(
    rows: IntArray,
    cols: IntArray,
    steps: IntArray,
    shape: tuple[int, ...],
    holds: Callable[[IntArray, IntArray], BoolArray],
) -> BoolArray:
    """(N,) whether something holds at any of the (K, 2) steps from these cells, on the grid."""
    found = np.zeros(len(rows), dtype=np.bool_)
    for down, right in steps.tolist():
        row, col = rows + down, cols + right
        inside = (row >= 0) & (row < shape[0]) & (col >= 0) & (col < shape[1])
        found[inside] |= holds(row[inside], col[inside])
    return found


def _places(
    fusion: Fusion,
    ref_seen: BoolArray,
    mov_seen: BoolArray,
    ref_only: BoolArray,
    mov_only: BoolArray,
    gap: float,
) -> tuple[tuple[Contradiction, ...], float]:
    """Places, most wall first, and the metres of wall that are in none; *_seen: of the walls of *_only."""
    cell = fusion.merged.resolution
    denied = ref_only | mov_only
    rows, cols = where(denied)
    if len(rows) == 0:
        return (), 0.0
    reach = is_near_wall(denied, distances(ceil(gap / 2 / cell)) * cell <= gap / 2)
    count, labels = cv2.connectedComponents(reach.view(np.uint8), connectivity=8)
    ref_wall, mov_wall = (
        np.bincount(labels[only][seen], minlength=count) * cell
        for only, seen in ((ref_only, ref_seen), (mov_only, mov_seen))
    )
    wall = ref_wall + mov_wall
    label = labels[rows, cols].astype(np.intp)
    low, high = np.full((count, 2), np.iinfo(np.intp).max), np.zeros((count, 2), dtype=np.intp)
    corners = np.stack([cols, rows], axis=1)
    np.minimum.at(low, label, corners)
    np.maximum.at(high, label, corners + 1)
    places = []
    for k in np.flatnonzero(wall >= LEAST).tolist():
        middle = (low[k] + high[k]) / 2
        x, y = fusion.merged.origin.apply(middle[None] * cell)[0].tolist()
        radius = float(np.hypot(*(high[k] - low[k]))) / 2 * cell
        places.append(Contradiction(x, y, radius, float(ref_wall[k]), float(mov_wall[k])))
    places.sort(key=lambda place: (-place.wall, place.x, place.y))
    return tuple(places), max(0.0, float(wall.sum()) - sum(place.wall for place in places))
