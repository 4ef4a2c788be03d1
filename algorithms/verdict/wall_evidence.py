"""What the walls of two maps say for a transform, and what against it: what the verdict rests on.

Metres of wall are counted over the whole of both maps, not only near the encounter where the search has
chosen the best of thousands of places: farther out nothing was chosen, so agreement there is worth more.

Maps bend, so patches of them may slip: see slipping_patches.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import sqrt

import numpy as np

from algorithms.common.parallel_kernels import kernel
from algorithms.common.pose import FloatArray, Pose2
from algorithms.maps.grid_map import BoolArray
from algorithms.maps.robots import NO_ROBOTS, Robots
from algorithms.verdict.slipping_patches import Apart, Slipped, slip_patches
from algorithms.verdict.wall_map import ANY_SIDE, NEAR, SHARES, ByteArray, WallMap, sectors, transform_between


@dataclass(frozen=True)
class Evidence:
    """Wall that both robots should have seen under a transform, both maps' walls counted; metres.

    agreeing, contradicting : with every patch where it fits best: the other map has a wall there that was
                              seen from the same side; or free floor
    rigid_agreeing, rigid_contradicting : the same with the maps as they are
    across   : agreeing wall that runs across the direction of most of it; the maps as they are. It is what
               keeps map 2 from sliding along a corridor
    floor    : free floor that both have seen; m²
    slip     : how far patches slipped, root of the mean square over the agreeing wall
    apart    : where patches slipped by far, the farthest first
    """

    agreeing: float
    contradicting: float
    rigid_agreeing: float
    rigid_contradicting: float
    across: float = 0.0
    floor: float = 0.0
    slip: float = 0.0
    apart: tuple[Apart, ...] = ()

    @property
    def contradiction(self) -> float:
        """Share of the walls seen by both that the other map denies, patches slipped; 1 without walls."""
        return _share(self.contradicting, self.agreeing)

    @property
    def rigid_contradiction(self) -> float:
        """The same with the maps as they are."""
        return _share(self.rigid_contradicting, self.rigid_agreeing)

    @property
    def shared_wall(self) -> float:
        """Wall that both robots should have seen, patches slipped; metres."""
        return self.agreeing + self.contradicting


def middle_of(ref: WallMap, mov: WallMap, T_ref_mov: Pose2, robots: Robots) -> FloatArray:
    """(2,) middle of all robots, or of the walls of both maps where none are known; metres, ref frame.

    It is the same place whichever of the maps is called the first.
    """
    places = robots.places(T_ref_mov)
    if not len(places):
        places = np.stack([ref.middle, T_ref_mov.apply(mov.middle)])
    return np.asarray(places.mean(axis=0), dtype=np.float64)


def _share(against: float, agreeing: float) -> float:
    return against / (against + agreeing) if against + agreeing > 0 else 1.0


def evidence(
    ref: WallMap, mov: WallMap, T_ref_mov: Pose2, robots: Robots = NO_ROBOTS, slip: bool = True
) -> Evidence:
    """Weigh the walls of both maps, each looked up in the other.

    robots : what lies around them says nothing
    slip   : whether patches may slip; without it only the walls as they are and the floor are counted
    """
    T_mov_ref, places = T_ref_mov.inverse(), robots.places(T_ref_mov)
    middle = middle_of(ref, mov, T_ref_mov, robots)
    sides = (
        _Side(mov, ref, T_ref_mov, T_mov_ref.apply(places), robots.size, T_mov_ref.apply(middle)),
        _Side(ref, mov, T_mov_ref, places, robots.size, middle),
    )
    slipped = []
    if slip:
        slipped = [side.slipped(to_ref) for side, to_ref in zip(sides, (T_ref_mov, Pose2()), strict=True)]
    agreeing, contradicting, squared = (sum((found.totals[k] for found in slipped), 0.0) for k in range(3))
    apart = [place for found in slipped for place in found.apart]
    rigid_agreeing = sum(side.agreeing for side in sides)
    lengthwise = abs(sides[0].direction(T_ref_mov.theta) + sides[1].direction(0.0))
    return Evidence(
        agreeing=agreeing,
        contradicting=contradicting,
        rigid_agreeing=rigid_agreeing,
        rigid_contradicting=sum(side.contradicting for side in sides),
        across=max(0.0, rigid_agreeing - lengthwise) / 2,
        floor=sum(side.floor() for side in sides) / 2,
        slip=sqrt(squared / agreeing) if agreeing else 0.0,
        apart=tuple(sorted(apart, key=lambda place: (-place.metres, place.x, place.y))),
    )


class _Side:
    """One map's walls looked up in the other map as they lie, ``at`` in its cells.

    agreeing, contradicting : metres, as they lie
    """

    def __init__(
        self,
        source: WallMap,
        target: WallMap,
        T_target_source: Pose2,
        robots: FloatArray,
        size: float,
        anchor: FloatArray,
    ) -> None:
        self._source, self._target = source, target
        self._T = transform_between(target, source, T_target_source)
        robots = source.grid.origin.inverse().apply(robots)
        self._anchor = source.grid.origin.inverse().apply(anchor)
        points, facing = source.points, source.facing
        if len(robots):
            away = np.ones(len(points), dtype=np.bool_)
            for x, y in robots.tolist():
                away &= np.hypot(points[:, 0] - x, points[:, 1] - y) > size
            points, facing = points[away], facing[away]
        at = self._T.apply(points) / target.grid.resolution
        sides = sectors(facing, self._T.theta)
        seen, agreeing = np.zeros(len(at), dtype=np.bool_), np.zeros(len(at))
        contradicting = _look_up(at, sides, target.level, target.sides, target.grid.free, seen, agreeing)
        self.agreeing = float(agreeing.sum()) * source.metres
        self.contradicting = contradicting * source.metres
        self._points, self._at, self._sides = points[seen], at[seen], sides[seen]
        self._facing, self._agreeing = facing[seen], agreeing[seen]

    def direction(self, turn: float) -> complex:
        """Agreeing wall, metres, times exp(2iφ), φ being where it faces in axes turned by −turn; radians.

        Walls along one line add up, those across take away, and a post that faces everywhere does neither.
        """
        known = ~np.isnan(self._facing)
        double = 2 * (self._facing[known] + self._source.grid.origin.theta + turn)
        return complex((self._agreeing[known] * np.exp(1j * double)).sum()) * self._source.metres

    def floor(self) -> float:
        """Floor of the source on floor of the target; m²."""
        cell = self._target.grid.resolution
        at = self._T.apply(self._source.floor) / cell
        return _on_floor(at, self._target.grid.free) * self._source.floor_area

    def slipped(self, T_ref_source: Pose2) -> Slipped:
        """The walls that both should have seen, patch by patch.

        T_ref_source : for telling where patches slipped
        """
        return slip_patches(
            self._points, self._at, self._sides, self._anchor, self._source, self._target, T_ref_source
        )


@kernel
def _look_up(
    at: FloatArray,
    sides: ByteArray,
    level: ByteArray,
    facing: ByteArray,
    free: BoolArray,
    seen: BoolArray,
    agreeing: FloatArray,
) -> float:
    """Points of wall that contradict.

    seen     : (N,) filled: which both robots should have seen
    agreeing : (N,) filled: by how much they are one wall
    """
    contradicting = 0.0
    for n in range(len(at)):
        col, row = int(np.floor(at[n, 0])), int(np.floor(at[n, 1]))
        if not (0 <= row < level.shape[0] and 0 <= col < level.shape[1]):
            continue
        near = level[row, col]
        same = SHARES[near]
        if sides[n] == ANY_SIDE or (facing[row, col] >> sides[n]) & 1:
            agreeing[n] = same
        if free[row, col]:
            contradicting += 1 - same
        seen[n] = free[row, col] or near >= NEAR
    return contradicting


@kernel
def _on_floor(at: FloatArray, free: BoolArray) -> int:
    count = 0
    for n in range(len(at)):
        col, row = int(np.floor(at[n, 0])), int(np.floor(at[n, 1]))
        if 0 <= row < free.shape[0] and 0 <= col < free.shape[1] and free[row, col]:
            count += 1
    return count
