"""Where two merged maps contradict each other: the walls that the other map denies, gathered into places.

A wall speaks against a merge where the other robot saw free floor and no wall of its own near enough to be
another drawing of it. That is how the evidence counts, with the maps as they are; here it is told by place,
so that a person can go and look.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import ceil

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from algorithms.agreement import surface
from algorithms.discs import distances, near
from algorithms.evidence import SAME_WALL
from algorithms.fuse import Fusion
from algorithms.gridmap import FREE, FREE_UP_TO, OCCUPIED_FROM, BoolArray, CellArray

GAP = 0.4  # metres; contradictions nearer to each other than this are one place
LEAST = 0.25  # metres of wall; what is shorter is a speck, not a place


@dataclass(frozen=True)
class Place:
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
class Conflicts:
    """All contradictions of a merge.

    ref_only, mov_only : (H, W) bool on the merged grid: walls of one map where the other saw free floor
    places : most wall first
    specks : wall in patches too short to be a place; metres
    """

    ref_only: BoolArray
    mov_only: BoolArray
    places: tuple[Place, ...]
    specks: float

    @property
    def wall(self) -> float:
        """Contradicting wall of both maps, wherever it is; metres."""
        return sum(place.wall for place in self.places) + self.specks


def find_conflicts(fusion: Fusion, gap: float = GAP) -> Conflicts:
    """Gather the contradictions of a merge into places.

    gap : metres between two contradictions from which on they are two places
    """
    ref_only = np.zeros(fusion.merged.cells.shape, dtype=np.bool_)
    mov_only = np.zeros_like(ref_only)
    both = (fusion.ref_cells >= FREE) & (fusion.mov_cells >= FREE)
    part = _part_around(both, ceil(SAME_WALL / fusion.merged.resolution) + 2)
    if part is None:
        return Conflicts(ref_only, mov_only, (), 0.0)
    ref, mov = _Side(fusion.ref_cells[part]), _Side(fusion.mov_cells[part])
    same = SAME_WALL / fusion.merged.resolution
    ref_only[part], mov_only[part] = ref.denied_by(mov, same), mov.denied_by(ref, same)
    places, specks = _places(fusion, ref_only, mov_only, ref.surface, mov.surface, part, gap)
    return Conflicts(ref_only, mov_only, places, specks)


class _Side:
    """What one map says on the part of the merged grid that both know."""

    def __init__(self, cells: CellArray) -> None:
        self.walls: BoolArray = cells >= OCCUPIED_FROM
        self.free: BoolArray = (cells >= FREE) & (cells <= FREE_UP_TO)
        self.surface = surface(self.walls, self.free)

    def denied_by(self, other: _Side, same: float) -> BoolArray:
        """Walls where the other saw free floor and has no wall within so many cells."""
        drawn = near(other.walls, distances(ceil(same)) <= same)
        return np.asarray(self.walls & other.free & ~drawn)


def _part_around(mask: BoolArray, margin: int) -> tuple[slice, slice] | None:
    """The rows and columns that hold a mask, and some more to each side; None for an empty one."""
    rows, cols = np.flatnonzero(mask.any(axis=1)), np.flatnonzero(mask.any(axis=0))
    if len(rows) == 0:
        return None
    return (
        slice(max(0, int(rows[0]) - margin), int(rows[-1]) + margin + 1),
        slice(max(0, int(cols[0]) - margin), int(cols[-1]) + margin + 1),
    )


def _places(
    fusion: Fusion,
    ref_only: BoolArray,
    mov_only: BoolArray,
    ref_surface: BoolArray,
    mov_surface: BoolArray,
    part: tuple[slice, slice],
    gap: float,
) -> tuple[tuple[Place, ...], float]:
    cell = fusion.merged.resolution
    denied = ref_only[part] | mov_only[part]
    reach = near(denied, distances(ceil(gap / 2 / cell)) * cell <= gap / 2)
    labels, count = ndimage.label(reach, structure=np.ones((3, 3), dtype=int))
    if count == 0 or not denied.any():
        return (), 0.0
    labels = np.where(denied, labels, 0)
    ref_wall = _metres(labels, ref_only[part] & ref_surface, count, cell)
    mov_wall = _metres(labels, mov_only[part] & mov_surface, count, cell)
    wall = ref_wall + mov_wall
    row, col = part[0].start, part[1].start
    places = []
    for k, box in enumerate(ndimage.find_objects(labels), 1):
        if wall[k] < LEAST or box is None:
            continue
        rows, cols = np.nonzero(labels[box] == k)
        corners = np.array([[cols.min(), rows.min()], [cols.max() + 1, rows.max() + 1]])
        corners += (box[1].start + col, box[0].start + row)
        x, y = fusion.merged.origin.apply(corners.mean(axis=0, keepdims=True) * cell)[0].tolist()
        radius = float(np.hypot(*(corners[1] - corners[0]))) / 2 * cell
        places.append(Place(x, y, radius, float(ref_wall[k]), float(mov_wall[k])))
    places.sort(key=lambda place: (-place.wall, place.x, place.y))
    return tuple(places), max(0.0, float(wall.sum()) - sum(place.wall for place in places))


def _metres(labels: NDArray[np.int32], mask: BoolArray, count: int, cell: float) -> NDArray[np.float64]:
    """(count + 1,) metres of seen wall per label."""
    return np.asarray(np.bincount(labels[mask], minlength=count + 1) * cell, dtype=np.float64)
