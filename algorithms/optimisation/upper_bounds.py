"""Blocks of transforms and their upper bounds: what the certificate searches.

A block holds 2^k × 2^k × 2^k transforms of a lattice: turns so fine that no point moves more than a cell
between neighbours, shifts a cell apart. A point under any transform of a block falls within a known
distance of where the block's middle puts it, so the largest table value within that distance bounds what
the point can add, and the sum of these bounds the block.
"""

from __future__ import annotations

from math import ceil, pi, sin, sqrt

import cv2
import numpy as np
from numpy.typing import NDArray

from algorithms.common.errors import TooLargeError
from algorithms.common.parallel_kernels import fast_kernel, spread
from algorithms.common.pose import FloatArray, rotation, wrap_angles
from algorithms.maps.grid_map import Float32Array
from algorithms.observations.search_window import CoupledWindow
from algorithms.optimisation.objective import PAD, Lookup, Objective, Side

IntArray = NDArray[np.int64]

MOST_ROOTS = 10_000_000  # blocks to begin with: half a gigabyte; a usual sighting makes thousands
LEVELS = 4  # the coarsest blocks are 16 × 16 × 16 transforms
RADII = (1, 2, 3, 4, 6, 8, 11, 16, 22, 32)  # cells; a table of maxima is made for each that is needed
MERGE_FROM = 1  # from this level on, points that lie close together are looked up as one

# Float32 sums of many terms: a bound and the value that it bounds are summed in different orders.
ROUNDING = 1e-5
HAIR = 1e-3  # cells; what 32-bit coordinates may be off

_LOOKUPS_WORTH_A_THREAD = 100_000


class Lattice:
    """The transforms that are searched, numbered (turn, column, row); blocks of them by level.

    The pivot is the first seen robot: T puts it at its place in the ref map plus the shift.
    """

    def __init__(self, objective: Objective, window: CoupledWindow) -> None:
        self.window = window
        pivot_ref = window.x_ref[0]
        self.cell = max(side.grid.resolution for side in objective.sides)
        reaches = [
            float(np.linalg.norm(_from_pivot(side, side.points, window), axis=1).max(initial=0.0))
            for side in objective.sides
        ]
        self.reach = max(self.cell, *reaches)
        self.disc = window.k * sqrt(float(np.linalg.eigvalsh(window.covariances[0])[-1]))
        finest = [side.grid.resolution for side in objective.sides]
        block = 2**LEVELS
        self.turns = block * ceil(2 * pi * self.reach / self.cell / block)
        self.levels = LEVELS
        while self.levels and self.spread(self.levels) > (RADII[-1] - 1) * min(finest):
            self.levels -= 1
        # whole blocks, and a transform right on the sighting: there is one in every window
        blocks = 2 * ceil(self.disc / (2**self.levels * self.cell) - 0.5) + 1
        self.side = max(1, blocks) * 2**self.levels
        self._pivot_ref = pivot_ref
        # shifts along the ref grid's own axes: there a block of them is a square of its cells
        self.yaw = objective.sides[0].grid.origin.theta

    @property
    def step(self) -> float:
        """Turn between neighbours; radians."""
        return float(2 * pi / self.turns)

    def half(self, level: int) -> float:
        """How far the outermost shifts of a block lie from its middle, along x and y; metres."""
        return float((2**level - 1) * self.cell / 2)

    def half_turn(self, level: int) -> float:
        """The same of the turns; radians."""
        return float((2**level - 1) * self.step / 2)

    def spread(self, level: int) -> float:
        """How far a block's transforms scatter the farthest point, its own cluster included; metres."""
        shift = self.half(level) * sqrt(2)
        swing = (self.reach + self.disc + shift) * _chord(self.half_turn(level))
        return float(shift + swing + _cluster(level, self.cell) * sqrt(2))

    def coordinates(self, nodes: IntArray, level: int) -> FloatArray:
        """(P, 3) shift of the pivot along the ref grid's axes, and turn, at the middles of (P, 3) blocks;
        metres, radians.
        """
        middle = (nodes + 0.5) * 2**level - 0.5
        out = np.empty((len(nodes), 3))
        out[:, :2] = (middle[:, 1:] - self.side // 2) * self.cell
        out[:, 2] = middle[:, 0] * self.step
        return out

    def poses(self, coordinates: FloatArray) -> FloatArray:
        """(P, 3) x, y, theta of T_ref_mov from ``coordinates``; the angle wrapped."""
        c, s = np.cos(coordinates[:, 2]), np.sin(coordinates[:, 2])
        x, y = self.window.pivot
        goes_to = coordinates[:, :2] @ rotation(self.yaw).T + self._pivot_ref
        return np.column_stack(
            [
                goes_to[:, 0] - c * x + s * y,
                goes_to[:, 1] - s * x - c * y,
                wrap_angles(coordinates[:, 2]),
            ]
        )

    def roots(self) -> IntArray:
        """(P, 3) the coarsest blocks; raises TooLargeError where they are too many."""
        count, sectors = self.side // 2**self.levels, self.turns // 2**self.levels
        blocks = sectors * count**2
        if blocks > MOST_ROOTS:
            raise TooLargeError(
                f"the sighting leaves the seen robot {self.disc:.3g} m around its place, which is {blocks:,} "
                f"blocks of transforms at a resolution of {self.cell:g} m; the limit is {MOST_ROOTS:,}. "
                "Use a coarser resolution, or smaller deviations of the sighting"
            )
        axes = np.arange(sectors), np.arange(count), np.arange(count)
        return np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)

    @staticmethod
    def children(nodes: IntArray) -> IntArray:
        """(8·P, 3) the blocks one level finer that (P, 3) blocks consist of."""
        octants = np.stack(np.meshgrid([0, 1], [0, 1], [0, 1], indexing="ij"), axis=-1).reshape(-1, 3)
        return np.asarray(2 * nodes[:, None, :] + octants, dtype=np.int64).reshape(-1, 3)

    def nearest_deviations(self, middles: FloatArray, level: int) -> FloatArray:
        """(P, S) lower bound of the deviations from the sightings anywhere in blocks; (P, 3) x, y, theta."""
        window = self.window
        lever = np.linalg.norm(window.x_mov - window.pivot, axis=1)
        slack = self.half(level) * sqrt(2) + lever * _chord(self.half_turn(level))
        sharpest = np.linalg.norm(window.whitening, ord=2, axis=(1, 2))
        middle = window.deviations(middles)
        return np.asarray(np.maximum(0.0, middle - slack * sharpest * (1 + 1e-9)), dtype=np.float64)


def _cluster(level: int, cell: float) -> float:
    """Edge of the squares in which points are looked up as one; metres."""
    return cell * 2 ** (level - 1) if level >= MERGE_FROM else 0.0


def _from_pivot(side: Side, points: FloatArray, window: CoupledWindow) -> FloatArray:
    """(N, 2) points of a side relative to the place that a turn leaves as it is."""
    pivot = window.x_ref[0] if side.backward else window.x_mov[0]
    return np.asarray(points + (side.anchor - pivot), dtype=np.float64)


def _within_reach(side: Side, lattice: Lattice) -> tuple[Float32Array, FloatArray]:
    """The part of a side's table that some transform of the lattice may look up, and its first (2,)
    column and row: the encounter's surroundings, not the building.
    """
    window = lattice.window
    pivot = window.x_mov[0] if side.backward else window.x_ref[0]
    middle = side.grid.grid_coordinates(pivot) - side.corner + PAD
    reach = (lattice.reach + lattice.disc + lattice.spread(lattice.levels)) / side.grid.resolution + 2
    size = np.array(side.table.shape[::-1])
    low = np.clip(np.floor(middle - reach).astype(int), 0, size - 1)
    high = np.clip(np.ceil(middle + reach).astype(int) + 1, low + 1, size)
    part = side.table[low[1] : high[1], low[0] : high[0]]
    return np.ascontiguousarray(part), low.astype(np.float64)


def _merged(
    points: FloatArray, weights: FloatArray, edge: float
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Points that share a square of a raster as one: its middle, its weight, how far they lie from it."""
    col, row = np.floor(points / edge).astype(np.int64).T
    _, which = np.unique(row * (np.ptp(col) + 1) + col, return_inverse=True)
    total = np.asarray(np.bincount(which, weights), dtype=np.float64)
    middle = np.stack([np.bincount(which, weights * axis) / total for axis in points.T], axis=1)
    blur = np.zeros(len(total))
    np.maximum.at(blur, which, np.linalg.norm(points - middle[which], axis=1))
    return middle, total, blur


def _chord(angle: float) -> float:
    """How far a turn by so many radians moves a point at a distance of one."""
    return 2 * sin(min(angle, pi) / 2)


class _Pyramid:
    """A side of the objective made ready for blocks: tables of maxima, points per level."""

    def __init__(self, side: Side, lattice: Lattice) -> None:
        self.side = side
        table, self.shift = _within_reach(side, lattice)
        self.shape = table.shape
        levels = [self._points(side, lattice, level) for level in range(1, lattice.levels + 1)]
        used = np.unique([radius for *_, radii in levels for radius in np.unique(radii)]).astype(int)
        tables = np.empty((len(used), *table.shape), dtype=np.float32)
        source, reached = table, 0
        for maxima, radius in zip(tables, used, strict=True):
            # a maximum of maxima: the square grows by what is new
            square = np.ones((2 * (radius - reached) + 1,) * 2, dtype=np.uint8)
            cv2.dilate(source, square, dst=maxima)
            source, reached = maxima, radius
        self.flat = tables.ravel()
        self.levels = [
            (x, y, weights, (np.searchsorted(used, radii) * table.size).astype(np.uint32))
            for x, y, weights, radii in levels
        ]
        self.weight = float(np.abs(side.weights).sum() * np.abs(side.table).max(initial=0.0))

    @staticmethod
    def _points(
        side: Side, lattice: Lattice, level: int
    ) -> tuple[Float32Array, Float32Array, Float32Array, IntArray]:
        """x, y in cells, weight, and radius of the table that bounds it, for every (merged) point."""
        points, weights, blur = side.points, side.weights, np.zeros(len(side.points))
        edge = _cluster(level, lattice.cell)
        if edge and len(points):
            points, weights, blur = _merged(points, weights, edge)
        shift = lattice.half(level)  # along either axis of the table
        lever = np.linalg.norm(_from_pivot(side, points, lattice.window), axis=1)
        if side.backward:  # T⁻¹ p = C(−Δθ) (p − Δ): the turn swings the shift, too
            shift *= sqrt(2)
            lever += lattice.disc + shift
        moved = shift + _chord(lattice.half_turn(level)) * lever + blur
        radii = np.array(RADII)[np.searchsorted(RADII, np.ceil(moved / side.grid.resolution + HAIR))]
        order = np.argsort(radii, kind="stable")  # neighbours in one table are neighbours in memory
        x, y = np.ascontiguousarray((points[order] / side.grid.resolution).T, dtype=np.float32)
        return x, y, weights[order].astype(np.float32), radii[order]

    def cost(self, level: int) -> int:
        """Look-ups per block."""
        return len(self.levels[level - 1][0]) if level else len(self.side.points)

    def __call__(self, poses: FloatArray, level: int) -> FloatArray:
        """(P,) bound of the side's sum over the blocks with these middles; level 0: the sum itself."""
        if level == 0:
            return self.side(poses, Lookup.NEAREST)
        motions = self.side.motions(poses)
        motions[:, 2:] -= self.shift
        single = motions.astype(np.float32)
        x, y, weights, offset = self.levels[level - 1]
        values = np.zeros(len(poses))
        rows, cols = self.shape

        def work(start: int, stop: int) -> None:
            _bound(self.flat, rows, cols, x, y, weights, offset, single[start:stop], values[start:stop])

        spread(work, len(poses), at_least=1 + _LOOKUPS_WORTH_A_THREAD // (1 + len(x)))
        return values


@fast_kernel
def _bound(
    flat: Float32Array,
    rows: int,
    cols: int,
    x: Float32Array,
    y: Float32Array,
    weights: Float32Array,
    offset: NDArray[np.uint32],
    motions: Float32Array,
    out: FloatArray,
) -> None:
    zero = np.float32(0)
    u_max, v_max = np.float32(cols - 1), np.float32(rows - 1)
    stride = np.int32(cols)
    for p in range(motions.shape[0]):
        c, s, tx, ty = motions[p, 0], motions[p, 1], motions[p, 2], motions[p, 3]
        total = zero
        for n in range(x.shape[0]):
            u = min(max(c * x[n] - s * y[n] + tx, zero), u_max)
            v = min(max(s * x[n] + c * y[n] + ty, zero), v_max)
            k = np.uint32(np.int32(v) * stride + np.int32(u)) + offset[n]
            total += weights[n] * flat[k]
        out[p] = total


class Bounder:
    """Values of single transforms of the lattice, and upper bounds of its blocks."""

    def __init__(self, objective: Objective, window: CoupledWindow) -> None:
        self.objective = objective
        self.lattice = Lattice(objective, window)
        self._pyramids = [_Pyramid(side, self.lattice) for side in objective.sides]
        self._rounding = ROUNDING * sum(pyramid.weight for pyramid in self._pyramids)

    def cost(self, level: int) -> int:
        """Look-ups that one block of a level costs."""
        return sum(pyramid.cost(level) for pyramid in self._pyramids)

    def __call__(self, nodes: IntArray, level: int) -> FloatArray:
        """(P,) for (P, 3) blocks of a level: no transform in the block and the window has a higher value.

        Level 0: the values themselves. −inf for a block that lies outside the window.
        """
        coordinates = self.lattice.coordinates(nodes, level)
        poses = self.lattice.poses(coordinates)
        off = self.lattice.nearest_deviations(poses, level)
        inside = (off <= self.lattice.window.k).all(axis=1)
        values = np.full(len(nodes), -np.inf)
        if inside.any():
            sums = sum(pyramid(poses[inside], level) for pyramid in self._pyramids)
            prior = 0.0
            if self.objective.window is not None:
                prior = 0.5 * self.objective.trust * (off[inside] ** 2).sum(axis=1)
            values[inside] = sums - prior + (self._rounding if level else 0.0)
        return values
