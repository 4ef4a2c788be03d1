"""Where two merged maps contradict each other: the walls that the other map denies, gathered into places.

A wall speaks against a merge where the other robot saw free floor and no wall of its own near enough to be
another drawing of it. That is how the evidence counts, with the maps as they are; here it is listed by place,
so that a person can go and look.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import ceil

import cv2
import numpy as np

from algorithms.maps.grid_map import FREE_UP_TO, OCCUPIED_FROM, BoolArray, CellArray, where
from algorithms.maps.map_fusion import Fusion
from algorithms.maps.wall_distance import distances, is_near_wall, surface
from algorithms.verdict.wall_map import SAME_WALL

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
    small_parts : wall in patches too short to be a place; metres
    """

    ref_only: BoolArray
    mov_only: BoolArray
    places: tuple[Contradiction, ...]
    small_parts: float

    @property
    def wall(self) -> float:
        """Contradicting wall of both maps, wherever it is; metres."""
        return sum(place.wall for place in self.places) + self.small_parts


def near_walls(fusion: Fusion) -> tuple[BoolArray, BoolArray]:
    """(H, W) each: where a wall would be another drawing of one of map 1, and of one of map 2."""
    cells = SAME_WALL / fusion.merged.resolution
    disc = distances(ceil(cells)) <= cells
    by_ref, by_mov = (is_near_wall(layer >= OCCUPIED_FROM, disc) for layer in fusion.layers)
    return by_ref, by_mov


def find_conflicts(fusion: Fusion, gap: float = GAP) -> Contradictions:
    """Gather the contradictions of a merge into places.

    gap : metres between two contradictions from which on they are two places
    """
    (ref_walls, ref_free), (mov_walls, mov_free) = map(_walls_and_floor, fusion.layers)
    by_ref, by_mov = near_walls(fusion)
    ref_only, mov_only = ref_walls & mov_free & ~by_mov, mov_walls & ref_free & ~by_ref
    seen = surface(ref_only, ref_free), surface(mov_only, mov_free)
    return Contradictions(ref_only, mov_only, *_places(fusion, ref_only | mov_only, seen, gap))


def _walls_and_floor(cells: CellArray) -> tuple[BoolArray, BoolArray]:
    return np.asarray(cells >= OCCUPIED_FROM), np.asarray(cells.view(np.uint8) <= FREE_UP_TO)  # −1 is 255


def _places(
    fusion: Fusion, denied: BoolArray, seen: tuple[BoolArray, BoolArray], gap: float
) -> tuple[tuple[Contradiction, ...], float]:
    """Places, most wall first, and the metres of wall that are in none.

    denied : (H, W) walls of either map where the other saw free floor
    seen   : (H, W) those of map 1, and of map 2, that have a free cell of the same map beside them
    """
    cell = fusion.merged.resolution
    rows, cols = where(denied)
    if len(rows) == 0:
        return (), 0.0
    reach = is_near_wall(denied, distances(ceil(gap / 2 / cell)) * cell <= gap / 2)
    count, labels = cv2.connectedComponents(reach.view(np.uint8), connectivity=8)
    ref_wall, mov_wall = (np.bincount(labels[walls], minlength=count) * cell for walls in seen)
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
