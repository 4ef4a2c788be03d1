"""Which rooms each robot visits, chosen so that two maps share as much as was asked for."""

from __future__ import annotations

import itertools
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from algorithms.common.parallel_kernels import kernel
from algorithms.common.pose import FloatArray
from algorithms.simulator.buildings.floor_plan import Building, Surface
from algorithms.simulator.lidar import first_hit, sees
from algorithms.simulator.path_planning import PathPlanner
from algorithms.simulator.portable_random import (
    DIRECTIONS,
    TURN,
    cosine,
    pick,
    sine,
    uniform,
    uniforms,
    whole,
)

Seen = NDArray[np.bool_]

PROBE_BEAMS = 180
PROBE_NODES = 5  # nodes of a way between two looks around
MEETING = 6.0  # metres; two robots further apart don't see one another
TRIES = 160  # tours that are drawn, of which the best are taken
HALF_SIZE = 0.4  # a map smaller than this share of the other is not what we want


@dataclass(frozen=True, eq=False)
class Tour:
    """Stops of a planner in the order of the visit, and the wall nodes seen on the way."""

    stops: tuple[int, ...]
    seen: Seen


@kernel
def _look(
    wall: NDArray[np.uint8],
    node: float,
    xy: FloatArray,
    beams: int,
    directions: FloatArray,
    reach: float,
    seen: Seen,
) -> None:
    """Mark the wall nodes that are in view from any of the (N, 2) points."""
    height, width = wall.shape
    for n in range(len(xy)):
        for b in range(beams):
            k = b * directions.shape[1] // beams
            x, y, dx, dy = xy[n, 0], xy[n, 1], directions[0, k], directions[1, k]
            distance, kind = first_hit(wall, node, x, y, dx, dy, reach)
            if kind != 0:
                inside = distance + 0.1 * node
                row = min(height - 1, max(0, int(np.floor((y + inside * dy) / node))))
                col = min(width - 1, max(0, int(np.floor((x + inside * dx) / node))))
                if wall[row, col] != 0:
                    seen[row, col] = True


def shared(a: Seen, b: Seen) -> float:
    """Overlap of two views: what both saw, as a share of what the one that saw less saw."""
    fewer = min(int(np.count_nonzero(a)), int(np.count_nonzero(b)))
    return int(np.count_nonzero(a & b)) / max(1, fewer)


class TourPlanner:
    """Tours through one building and what is seen on them; a way is looked at once and kept."""

    def __init__(self, building: Building, planner: PathPlanner, reach: float) -> None:
        self.planner = planner
        self._wall: Surface = planner.wall.astype(np.uint8)
        self._reach = reach
        self._views: dict[tuple[int, int], Seen] = {}
        near = planner.metres <= MEETING
        self.meetings = [
            (a, b)
            for a, b in np.argwhere(near).tolist()
            if a == b or sees(building, planner.stops[a], planner.stops[b])
        ]

    def _view(self, a: int, b: int) -> Seen:
        key = (min(a, b), max(a, b))
        if key not in self._views:
            seen = np.zeros(self._wall.shape, dtype=bool)
            points = np.ascontiguousarray(self.planner.way(*key)[::PROBE_NODES])
            _look(self._wall, self.planner.node, points, PROBE_BEAMS, DIRECTIONS, self._reach, seen)
            self._views[key] = seen
        return self._views[key]

    def tour(self, stops: list[int], start: int) -> Tour:
        """Visit stops one after another, always the nearest that is left."""
        left, order = [s for s in stops if s != start], [start]
        while left:
            metres = self.planner.metres[order[-1]]
            following = min(left, key=lambda stop: (metres[stop], stop))
            left.remove(following)
            order.append(following)
        seen = self._view(start, start).copy()
        for a, b in itertools.pairwise(order):
            seen |= self._view(a, b)
        return Tour(tuple(order), seen)

    def grow(self, rng: np.random.Generator, anchor: int, size: int, heading: int, pull: float) -> Tour:
        """A tour of ``size`` stops around an anchor, drawn out in one direction.

        heading : ticks, world frame
        pull    : metres of detour accepted for a metre in that direction
        """
        planner = self.planner
        offset = planner.stops - planner.stops[anchor]
        ahead = offset[:, 0] * float(cosine(heading)) + offset[:, 1] * float(sine(heading))
        factor = 0.7 + 0.6 * uniforms(rng, len(offset))
        reach, chosen = planner.metres[anchor] * factor, [anchor]
        while len(chosen) < min(size, len(offset)):
            score = reach - pull * ahead
            score[chosen] = np.inf
            chosen.append(int(score.argmin()))
            reach = np.minimum(reach, planner.metres[chosen[-1]] * factor)
        start = max(chosen, key=lambda stop: (planner.metres[anchor][stop], stop))
        return self.tour(chosen, start)

    def pair(self, rng: np.random.Generator, overlap: float, sizes: tuple[int, int]) -> tuple[Tour, Tour]:
        """Two tours that can meet and share about ``overlap`` of what they see."""

        def drawn() -> tuple[Tour, Tour]:
            a, b = pick(rng, self.meetings)
            heading, pull = whole(rng, 0, TURN - 1), uniform(rng, 0.0, 1.2)
            one = self.grow(rng, a, whole(rng, *sizes), heading, pull)
            return one, self.grow(rng, b, whole(rng, *sizes), heading + TURN // 2, pull)

        return min((drawn() for _ in range(TRIES)), key=lambda tours: _miss(tours[0], tours[1], overlap))

    def partner(self, rng: np.random.Generator, other: Tour, overlap: float, sizes: tuple[int, int]) -> Tour:
        """A tour that can meet a given one and shares about ``overlap`` with it."""
        options = [a for a, b in self.meetings if b in other.stops]
        middle = self.planner.stops[list(other.stops)].mean(axis=0)

        def drawn() -> Tour:
            anchor = pick(rng, options)
            away = self.planner.stops[anchor] - middle
            outward = round(float(np.arctan2(away[1], away[0])) * TURN / (2 * np.pi))
            heading = outward + whole(rng, -TURN // 5, TURN // 5)
            return self.grow(rng, anchor, whole(rng, *sizes), heading, uniform(rng, 0.0, 1.2))

        return min((drawn() for _ in range(TRIES)), key=lambda tour: _miss(tour, other, overlap))


def _miss(one: Tour, two: Tour, overlap: float) -> float:
    """How far two tours are from what was asked; small maps beside large ones count too."""
    sizes = sorted((int(np.count_nonzero(one.seen)), int(np.count_nonzero(two.seen))))
    lopsided = max(0.0, HALF_SIZE - sizes[0] / max(1, sizes[1]))
    return abs(shared(one.seen, two.seen) - overlap) + 0.5 * lopsided
