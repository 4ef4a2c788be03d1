"""Patches of wall that slip to where they fit best, for maps that bend.

Right where the robots met bent maps may fit, and ten metres on miss each other by a wall's thickness. So
every patch of a few metres may slip a little to where it fits best; what still contradicts then is not bent
but wrong. A right merge of bent maps loses most of its contradictions that way, a wrong merge keeps about as
many as it had.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import ceil, cos, hypot, sin

import numpy as np

from algorithms.common.parallel_kernels import kernel, run_in_threads
from algorithms.common.pose import FloatArray, Pose2
from algorithms.maps.grid_map import BoolArray
from algorithms.verdict.wall_map import ANY_SIDE, SHARES, ByteArray, IntArray, WallMap

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
LEAST_WALL = 1.5  # metres of agreeing wall that a patch must bring to be counted


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
class Slipped:
    """Every patch where it fits best.

    totals : agreeing and contradicting wall, metres; and the first times the squared slips, m³
    """

    totals: tuple[float, float, float]
    apart: tuple[Apart, ...]


def slip_patches(
    points: FloatArray,
    at: FloatArray,
    sides: ByteArray,
    anchor: FloatArray,
    source: WallMap,
    target: WallMap,
    T_ref_source: Pose2,
) -> Slipped:
    """The walls of the source that both should have seen, patch by patch.

    points       : (N, 2) where they are in the source; metres
    at           : (N, 2) where they lie in the target; cells
    sides        : (N,) from which they were seen; axes of the target
    anchor       : (2,) that the raster of patches goes through; metres, in the source
    T_ref_source : for telling where patches slipped
    """
    stride = max(1, ceil(len(at) / MOST_SLIPPING))
    at, sides, points = at[::stride], sides[::stride], points[::stride]
    metres = source.metres * stride
    agreeing = contradicting = squared = 0.0
    apart: list[Apart] = []
    for offset in RASTERS if len(at) else ():
        order, starts = _patches((points - anchor) / PATCH + offset)
        found = np.zeros((len(starts) - 1, 6))
        _slip_all(at[order], sides[order], starts, target, found)
        found[:, (0, 1, 5)] *= metres
        agreeing += float(found[:, 0].sum()) / len(RASTERS)
        contradicting += float(found[:, 1].sum()) / len(RASTERS)
        squared += float((found[:, 0] * (found[:, 2] ** 2 + found[:, 3] ** 2)).sum()) / len(RASTERS)
        if offset == 0:
            middles = np.add.reduceat(points[order], starts[:-1]) / np.diff(starts)[:, None]
            apart = _apart(found, (T_ref_source @ source.grid.origin).apply(middles))
    return Slipped((agreeing, contradicting, squared), tuple(apart))


def _slip_all(at: FloatArray, sides: ByteArray, starts: IntArray, target: WallMap, out: FloatArray) -> None:
    level, facing, free = target.level, target.sides, target.grid.free
    at, sides, cell = np.ascontiguousarray(at), np.ascontiguousarray(sides), target.grid.resolution

    def work(start: int, stop: int) -> None:
        _slip(at, sides, starts[start : stop + 1], level, facing, free, cell, out[start:stop])

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
    return [
        Apart(x, y, hypot(right, up), wall)
        for (wall, _, right, up, _, gained), (x, y) in zip(found.tolist(), middles.tolist(), strict=True)
        if hypot(right, up) >= LEAST_APART and gained >= LEAST_WALL
    ]


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
