"""What the walls of two maps say for a transform, and what against it: what the verdict rests on.

Metres of wall are counted over the whole of both maps, not only near the encounter where the search has
chosen the best of thousands of places: farther out nothing was chosen, so agreement there is worth more.

Maps bend. Right where the robots met they may fit, and ten metres on miss each other by a wall's
thickness. So every patch of a few metres may slip a little to where it fits best; what still contradicts
then is not bent but wrong. A right merge of bent maps loses most of its contradictions that way, a wrong
merge keeps about as many as it had.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import ceil, cos, hypot, sin, sqrt

import numpy as np

from algorithms.common.parallel_kernels import kernel, run_in_threads
from algorithms.common.pose import FloatArray, Pose2
from algorithms.maps.grid_map import BoolArray
from algorithms.maps.robots import NOWHERE, Robots
from algorithms.verdict.wall_map import (
    ANY_SIDE,
    NEAR,
    SHARES,
    ByteArray,
    IntArray,
    WallMap,
    sectors,
    transform_between,
)

PATCH = 7.0  # metres; a room and the wall behind it: large enough that chance does not fit it
RASTERS = (0.0, 0.5)  # patches; where the patches' borders lie must not matter, so two are averaged
SLIP = 0.6  # metres that a patch may slip
SLIP_STEP = 0.15  # metres; a wall within SAME_WALL of a step is met by it
TURN = 0.07  # radians that a patch may turn, 4°
TURN_STEPS = 2  # to either side
CLOSER = 2  # times that steps are halved around the best place
INERTIA = 0.05  # share of a patch's walls that the farthest slip must win to be worth it
MOST_SLIPPING = 1_500  # points that are slipped; of more every second, third … stands for all
LEAST_APART = 0.2  # metres; of a patch that slips by less nobody would say that its walls are double
LEAST_WALL = 1.5  # metres of agreeing wall that a patch must bring to be told of


@dataclass(frozen=True)
class Apart:
    """A place where bent maps lie beside each other.

    x, y   : its middle; metres, ref frame
    metres : how far the maps are apart there
    wall   : how much of their wall lies on each other once the patch has slipped; metres
    """

    x: float
    y: float
    metres: float
    wall: float


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


def _share(against: float, agreeing: float) -> float:
    return against / (against + agreeing) if against + agreeing > 0 else 1.0


def evidence(
    ref: WallMap, mov: WallMap, T_ref_mov: Pose2, robots: Robots = NOWHERE, slip: bool = True
) -> Evidence:
    """Weigh the walls of both maps, each looked up in the other.

    robots : what lies around them says nothing
    slip   : whether patches may slip; without it only the walls as they are and the floor are counted
    """
    T_mov_ref, places = T_ref_mov.inverse(), robots.places(T_ref_mov)
    sides = (
        _Side(mov, ref, T_ref_mov, T_mov_ref.apply(places), robots.size),
        _Side(ref, mov, T_mov_ref, places, robots.size),
    )
    slipped = []
    if slip:
        slipped = [side.slipped(to_ref) for side, to_ref in zip(sides, (T_ref_mov, Pose2()), strict=True)]
    agreeing, contradicting, squared = (sum((found.totals[k] for found in slipped), 0.0) for k in range(3))
    apart = [place for found in slipped for place in found.apart]
    rigid_agreeing = sum(side.agreeing for side in sides)
    one_way = abs(sides[0].direction(T_ref_mov.theta) + sides[1].direction(0.0))
    return Evidence(
        agreeing=agreeing,
        contradicting=contradicting,
        rigid_agreeing=rigid_agreeing,
        rigid_contradicting=sum(side.contradicting for side in sides),
        across=max(0.0, rigid_agreeing - one_way) / 2,
        floor=sum(side.floor() for side in sides) / 2,
        slip=sqrt(squared / agreeing) if agreeing else 0.0,
        apart=tuple(sorted(apart, key=lambda place: (-place.metres, place.x, place.y))),
    )


@dataclass(frozen=True)
class _Slipped:
    """Every patch where it fits best.

    totals : agreeing and contradicting wall, metres; and the first times the squared slips, m³
    """

    totals: tuple[float, float, float]
    apart: tuple[Apart, ...]


class _Side:
    """One map's walls looked up in the other map as they lie, ``at`` in its cells.

    agreeing, contradicting : metres, as they lie
    """

    def __init__(
        self, source: WallMap, target: WallMap, T_target_source: Pose2, robots: FloatArray, size: float
    ) -> None:
        self._source, self._target = source, target
        self._T = transform_between(target, source, T_target_source)
        robots = source.grid.origin.inverse().apply(robots)
        self._anchor = robots.mean(axis=0) if len(robots) else np.zeros(2)  # the same for either map
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
        self.agreeing, self.contradicting = (
            float(agreeing.sum()) * source.metres,
            contradicting * source.metres,
        )
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

    def slipped(self, T_ref_source: Pose2) -> _Slipped:
        """The walls that both should have seen, patch by patch.

        T_ref_source : for telling where patches slipped
        """
        stride = max(1, ceil(len(self._at) / MOST_SLIPPING))
        at, sides, points = self._at[::stride], self._sides[::stride], self._points[::stride]
        metres = self._source.metres * stride
        agreeing = contradicting = squared = 0.0
        apart: list[Apart] = []
        for offset in RASTERS if len(at) else ():
            order, starts = _patches((points - self._anchor) / PATCH + offset)
            found = np.zeros((len(starts) - 1, 6))
            self._slip(at[order], sides[order], starts, found)
            found[:, (0, 1, 5)] *= metres
            agreeing += float(found[:, 0].sum()) / len(RASTERS)
            contradicting += float(found[:, 1].sum()) / len(RASTERS)
            squared += float((found[:, 0] * (found[:, 2] ** 2 + found[:, 3] ** 2)).sum()) / len(RASTERS)
            if offset == 0:
                middles = np.add.reduceat(points[order], starts[:-1]) / np.diff(starts)[:, None]
                apart = _apart(found, (T_ref_source @ self._source.grid.origin).apply(middles))
        return _Slipped((agreeing, contradicting, squared), tuple(apart))

    def _slip(self, at: FloatArray, sides: ByteArray, starts: IntArray, out: FloatArray) -> None:
        target = self._target
        level, facing, free = target.level, target.sides, target.grid.free
        at, sides = np.ascontiguousarray(at), np.ascontiguousarray(sides)

        def work(start: int, stop: int) -> None:
            _slip(
                at, sides, starts[start : stop + 1], level, facing, free, target.grid.resolution,
                out[start:stop],
            )  # fmt: skip

        run_in_threads(work, len(out), at_least=4)


def _patches(place: FloatArray) -> tuple[IntArray, IntArray]:
    """(N,) the order of points by patch, and (P + 1,) where each patch begins and the last one ends.

    place : (N, 2) in patches
    """
    patch = np.floor(place).astype(np.int64)
    patch -= patch.min(axis=0)
    number = patch[:, 1] * (patch[:, 0].max() + 1) + patch[:, 0]
    order = np.argsort(number, kind="stable")
    starts = np.flatnonzero(np.diff(number[order], prepend=-1))
    return order, np.append(starts, len(order))


def _apart(found: FloatArray, middles: FloatArray) -> list[Apart]:
    """Patches that lie beside the other map: those which gain much agreeing wall by a long slip."""
    out = []
    for (wall, _, right, up, _, gained), (x, y) in zip(found.tolist(), middles.tolist(), strict=True):
        if hypot(right, up) >= LEAST_APART and gained >= LEAST_WALL:
            out.append(Apart(x, y, hypot(right, up), wall))
    return out


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
    """How many places lie on free floor."""
    count = 0
    for n in range(len(at)):
        col, row = int(np.floor(at[n, 0])), int(np.floor(at[n, 1]))
        if 0 <= row < free.shape[0] and 0 <= col < free.shape[1] and free[row, col]:
            count += 1
    return count


@kernel
def _slip(
    at: FloatArray,
    sides: ByteArray,
    starts: IntArray,
    level: ByteArray,
    facing: ByteArray,
    free: BoolArray,
    cell: float,
    out: FloatArray,
) -> None:
    """For every patch: agreeing and contradicting points where it fits best, how far it slipped to the
    right and up, metres, by how much it turned, radians, and how many points more agree there.

    It is tried everywhere within reach, then closer and closer around the best place: else the result would
    depend on where the places that are tried happen to lie.
    """
    for patch in range(len(starts) - 1):
        points = at[starts[patch] : starts[patch + 1]]
        mine = sides[starts[patch] : starts[patch + 1]]
        x, y = points[:, 0].mean(), points[:, 1].mean()
        best, right, up, turn = -np.inf, 0.0, 0.0, 0.0
        step, turn_step = SLIP_STEP, TURN / TURN_STEPS
        reach, turns = round(SLIP / SLIP_STEP), TURN_STEPS
        for _ in range(1 + CLOSER):
            x0, y0, turn0 = right, up, turn
            for a in range(-turns, turns + 1):
                to = turn0 + a * turn_step
                c, s = cos(to), sin(to)
                for i in range(-reach, reach + 1):
                    for j in range(-reach, reach + 1):
                        dx, dy = x0 + i * step, y0 + j * step
                        far = (dx * dx + dy * dy) / (SLIP * SLIP)
                        if far > 1 + 1e-9 or abs(to) > TURN + 1e-9:
                            continue
                        agreeing, contradicting = 0.0, 0.0
                        for n in range(len(points)):
                            u, v = points[n, 0] - x, points[n, 1] - y
                            col = int(np.floor(c * u - s * v + x + dx / cell))
                            row = int(np.floor(s * u + c * v + y + dy / cell))
                            if not (0 <= row < level.shape[0] and 0 <= col < level.shape[1]):
                                continue
                            same = SHARES[level[row, col]]
                            if mine[n] == ANY_SIDE or (facing[row, col] >> mine[n]) & 1:
                                agreeing += same
                            if free[row, col]:
                                contradicting += 1 - same
                        cost = INERTIA * len(points) * (far + (to / TURN) ** 2)
                        if dx == 0 and dy == 0 and to == 0:
                            out[patch, 5] = -agreeing
                        if agreeing - contradicting - cost > best:
                            best = agreeing - contradicting - cost
                            out[patch, 0], out[patch, 1] = agreeing, contradicting
                            right, up, turn = dx, dy, to
            step, turn_step, reach, turns = step / 2, turn_step / 2, 1, 1
        out[patch, 2], out[patch, 3], out[patch, 4] = right, up, turn
        out[patch, 5] += out[patch, 0]
