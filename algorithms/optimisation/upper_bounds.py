"""Blocks of transforms and their upper bounds: what the certificate searches.

A block holds 2^k × 2^k × 2^k transforms of a lattice: turns so fine that no point moves more than a cell
between neighbours, shifts a cell apart. A point under any transform of a block falls within a known
distance of where the block's middle puts it, so the largest table value within that distance bounds what
the point can add, and the sum of these bounds the block.
"""

from __future__ import annotations

from math import sqrt

import cv2
import numpy as np

from algorithms.common.pose import FloatArray, chord
from algorithms.maps.grid_map import Float32Array
from algorithms.observations.search_window import CoupledWindow
from algorithms.optimisation.objective import PAD, Lookup, Objective, Side, nearest, sum_in_table
from algorithms.optimisation.transform_lattice import (
    RADII,
    IntArray,
    TransformLattice,
    cluster_edge,
    from_pivot,
)

# Float32 sums of many terms: a bound and the value that it bounds are summed in different orders.
ROUNDING = 1e-5
HAIR = 1e-3  # cells; what 32-bit coordinates may be off


def _within_reach(side: Side, lattice: TransformLattice) -> tuple[Float32Array, FloatArray]:
    """The part of a side's table that some transform of the lattice may look up, and its first (2,)
    column and row: the encounter's surroundings, not the building.
    """
    window = lattice.window
    pivot = window.pivot if side.backward else window.place
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


class _Pyramid:
    """A side of the objective made ready for blocks: tables of maxima, points per level."""

    def __init__(self, side: Side, lattice: TransformLattice) -> None:
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
        side: Side, lattice: TransformLattice, level: int
    ) -> tuple[Float32Array, Float32Array, Float32Array, IntArray]:
        """x, y in cells, weight, and radius of the table that bounds it, for every (merged) point."""
        points, weights, blur = side.points, side.weights, np.zeros(len(side.points))
        edge = cluster_edge(level, lattice.cell)
        if edge and len(points):
            points, weights, blur = _merged(points, weights, edge)
        shift = lattice.half(level)  # along either axis of the table
        lever = np.linalg.norm(from_pivot(side, points, lattice.window), axis=1)
        if side.backward:  # T⁻¹ p = C(−Δθ) (p − Δ): the turn swings the shift, too
            shift *= sqrt(2)
            # what turns farther out than the table reaches finds nothing, at any turn
            lever = np.minimum(lever + lattice.disc + shift, lattice.table_reach(side))
        moved = shift + chord(lattice.half_turn(level)) * lever + blur
        radii = np.array(RADII)[np.searchsorted(RADII, np.ceil(moved / side.grid.resolution + HAIR))]
        order = np.argsort(radii, kind="stable")  # neighbours in one table are neighbours in memory
        x, y = np.ascontiguousarray((points[order] / side.grid.resolution).T, dtype=np.float32)
        return x, y, weights[order].astype(np.float32), radii[order]

    def __call__(self, poses: FloatArray, level: int) -> FloatArray:
        """(P,) bound of the side's sum over the blocks with these middles; level 0: the sum itself."""
        if level == 0:
            return self.side(poses, Lookup.NEAREST)
        motions = self.side.motions(poses)
        motions[:, 2:] -= self.shift
        *points, offset = self.levels[level - 1]
        return sum_in_table(nearest, self.flat, self.shape, points, motions, offset)


class UpperBounds:
    """Values of single transforms of the lattice, and upper bounds of its blocks."""

    def __init__(self, objective: Objective, window: CoupledWindow) -> None:
        self.objective = objective
        self.lattice = TransformLattice(objective, window)
        self._pyramids = [_Pyramid(side, self.lattice) for side in objective.sides]
        self._rounding = ROUNDING * sum(pyramid.weight for pyramid in self._pyramids)

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
