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
from math import ceil, sqrt

import numpy as np
from numpy.typing import NDArray

from algorithms.discs import distances, stamp
from algorithms.gridmap import BoolArray, GridMap, where
from algorithms.kernels import kernel, spread
from algorithms.pose import FloatArray, Pose2

SAME_WALL = 0.12  # metres; two drawings of one wall: the sum of two ragged cells of 0.05 m and a bit
NEAR_WALL = 0.3  # metres; a wall in unknown ground counts as seen by both where the other has one so near
PATCH = 7.0  # metres; a room and the wall behind it: large enough that chance does not fit it
RASTERS = (0.0, 0.5)  # patches; where the patches' borders lie must not matter, so two are averaged
SLIP = 0.6  # metres that a patch may slip
SLIP_STEP = 0.15  # metres; a wall within SAME_WALL of a step is met by it
TURN = 0.07  # radians that a patch may turn, 4°
TURN_STEPS = 2  # to either side
FLOOR, NEAR, SAME = 1, 2, 4  # of the other map: free floor; a wall within NEAR_WALL; within SAME_WALL
INERTIA = 0.05  # share of a patch's walls that the farthest slip must win to be worth it

GroundArray = NDArray[np.uint8]
IntArray = NDArray[np.intp]


@dataclass(frozen=True)
class Evidence:
    """Wall that both robots should have seen under a transform, both maps' walls counted; metres.

    agreeing, contradicting : with every patch where it fits best: the other map has a wall there, or
                              free floor
    rigid_agreeing, rigid_contradicting : the same with the maps as they are
    slip : how far patches slipped, root of the mean square over the agreeing wall
    """

    agreeing: float
    contradicting: float
    rigid_agreeing: float
    rigid_contradicting: float
    slip: float = 0.0

    @property
    def contradiction(self) -> float:
        """Share of the walls seen by both that the other map denies, patches slipped; 1 without walls."""
        return _share(self.contradicting, self.agreeing)

    @property
    def rigid_contradiction(self) -> float:
        """The same with the maps as they are."""
        return _share(self.rigid_contradicting, self.rigid_agreeing)

    @property
    def bent(self) -> float:
        """Share of the contradictions that go away when patches slip, 0 … 1."""
        before = self.rigid_contradiction
        return max(0.0, 1 - self.contradiction / before) if before > 0 else 0.0


def _share(against: float, agreeing: float) -> float:
    return against / (against + agreeing) if against + agreeing > 0 else 1.0


def evidence(ref: GridMap, mov: GridMap, T_ref_mov: Pose2) -> Evidence:
    """Weigh the walls of both maps, each looked up in the other."""
    totals = np.zeros(5)
    for source, target, T in ((mov, ref, T_ref_mov), (ref, mov, T_ref_mov.inverse())):
        totals += _one_way(source, target, T) * source.resolution
    agreeing, contradicting, rigid_agreeing, rigid_contradicting, squared = totals.tolist()
    slip = sqrt(squared / agreeing) if agreeing else 0.0
    return Evidence(agreeing, contradicting, rigid_agreeing, rigid_contradicting, slip)


def _one_way(source: GridMap, target: GridMap, T_target_source: Pose2) -> FloatArray:
    """(5,) cells of the source's walls, in the order of ``Evidence``; the last times squared slips, m²."""
    rows, cols = _surface_cells(source)
    places = target.grid_coordinates(T_target_source.apply(source.centres(rows, cols)))
    margin = ceil((SLIP + PATCH * TURN + NEAR_WALL) / target.resolution) + 1
    inside = np.all((places >= 0) & (places < (target.width, target.height)), axis=1)
    places = places[inside]
    if not len(places):
        return np.zeros(5)
    low = np.maximum(0, places.min(axis=0).astype(int) - margin)
    high = np.minimum((target.width, target.height), places.max(axis=0).astype(int) + margin + 1)
    part = slice(low[1], high[1]), slice(low[0], high[0])
    ground = _ground(target.occupied[part], target.free[part], target.resolution)
    places = places - low
    at = places.astype(np.intp)
    places = places[ground[at[:, 1], at[:, 0]] > 0]
    if not len(places):
        return np.zeros(5)
    totals = np.zeros(5)
    for offset in RASTERS:
        totals += _patch_by_patch(places, offset, ground, target.resolution)
    return totals / len(RASTERS)


def _ground(walls: BoolArray, free: BoolArray, cell: float) -> GroundArray:
    """(H, W) what is at a place, as a sum: FLOOR on free floor, NEAR and SAME by the nearest wall.

    A disc is stamped around every wall: beyond NEAR_WALL nobody asks how far it is.
    """
    ground = free.astype(np.uint8)  # FLOOR is 1
    metres = distances(ceil(NEAR_WALL / cell) + 1) * np.float32(cell)
    kind = np.where(metres <= np.float32(NEAR_WALL), NEAR, 0)
    kind[metres.astype(np.float64) <= SAME_WALL] = NEAR | SAME
    stamp(walls, kind.astype(np.uint8), ground)
    return ground


def _patch_by_patch(places: FloatArray, offset: float, ground: GroundArray, cell: float) -> FloatArray:
    """(5,) the sums over all patches; offset: of the raster of patches, in patches."""
    patch = np.floor(places * (cell / PATCH) + offset).astype(np.int64)
    number = patch[:, 1] * (patch[:, 0].max() + 1) + patch[:, 0]
    order = np.argsort(number, kind="stable")
    places = np.ascontiguousarray(places[order])
    starts = np.flatnonzero(np.diff(number[order], prepend=-1))
    starts = np.append(starts, len(places))
    counts = np.zeros((len(starts) - 1, 5))

    def work(start: int, stop: int) -> None:
        _slip(places, starts[start : stop + 1], ground, cell, counts[start:stop])

    spread(work, len(counts), at_least=4)
    return np.asarray(counts.sum(axis=0), dtype=np.float64)


def _surface_cells(grid: GridMap) -> tuple[IntArray, IntArray]:
    """Rows and columns of the walls that were seen, as ``agreement.surface`` defines them."""
    rows, cols = where(grid.occupied)
    seen = np.zeros(len(rows), dtype=bool)
    for down in (-1, 0, 1):
        for right in (-1, 0, 1):
            row, col = rows + down, cols + right
            inside = (row >= 0) & (row < grid.height) & (col >= 0) & (col < grid.width)
            seen[inside] |= grid.free[row[inside], col[inside]]
    return rows[seen], cols[seen]


@kernel
def _look(
    places: FloatArray,
    start: int,
    stop: int,
    ground: GroundArray,
    x: float,
    y: float,
    turn: float,
) -> tuple[int, int]:
    """How many points of a patch lie on a wall and how many on free floor, the patch slipped."""
    middle_x = places[start:stop, 0].mean()
    middle_y = places[start:stop, 1].mean()
    c, s = np.cos(turn), np.sin(turn)
    agreeing = 0
    contradicting = 0
    for n in range(start, stop):
        u, v = places[n, 0] - middle_x, places[n, 1] - middle_y
        col = int(np.floor(c * u - s * v + middle_x + x))
        row = int(np.floor(s * u + c * v + middle_y + y))
        if 0 <= row < ground.shape[0] and 0 <= col < ground.shape[1]:
            if ground[row, col] & SAME:
                agreeing += 1
            elif ground[row, col] & FLOOR:
                contradicting += 1
    return agreeing, contradicting


@kernel
def _slip(
    places: FloatArray,
    starts: IntArray,
    ground: GroundArray,
    cell: float,
    out: FloatArray,
) -> None:
    steps = round(SLIP / SLIP_STEP)
    for patch in range(len(starts) - 1):
        start, stop = starts[patch], starts[patch + 1]
        best = -np.inf
        for a in range(-TURN_STEPS, TURN_STEPS + 1):
            turn = a * TURN / TURN_STEPS
            for i in range(-steps, steps + 1):
                for j in range(-steps, steps + 1):
                    if i * i + j * j > steps * steps:
                        continue
                    agreeing, contradicting = _look(
                        places, start, stop, ground,
                        i * SLIP_STEP / cell, j * SLIP_STEP / cell, turn,
                    )  # fmt: skip
                    far = (i * i + j * j) / (steps * steps) + (a / TURN_STEPS) ** 2
                    value = agreeing - contradicting - INERTIA * (stop - start) * far
                    if a == 0 and i == 0 and j == 0:
                        out[patch, 2], out[patch, 3] = agreeing, contradicting
                    if value > best:
                        best = value
                        out[patch, 0], out[patch, 1] = agreeing, contradicting
                        out[patch, 4] = agreeing * (i * i + j * j) * SLIP_STEP**2
