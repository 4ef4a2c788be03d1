"""Upper bounds of all blocks of the plane, a sector of turns at a time, by fast Fourier transforms.

What a point may find anywhere in a block is at most the largest table value within the block's reach, and for
one sector of turns the sum over the points is a correlation: of the walls with the largest values, cell by
cell of a raster as coarse as the blocks. One inverse transform bounds the blocks of all shifts.
"""

from __future__ import annotations

from functools import cached_property
from math import ceil, sqrt
from typing import Any

import cv2
import numpy as np

from algorithms.common.parallel_kernels import each_on_a_core
from algorithms.common.pose import FloatArray, chord, rotation
from algorithms.maps.grid_map import Float32Array
from algorithms.optimisation.objective import PAD, Objective, Side
from algorithms.optimisation.plane_correlation import correlated, spectrum
from algorithms.optimisation.transform_lattice import IntArray, TransformLattice, from_pivot

ROUNDING = 1e-5  # of the norms of what is correlated: 32-bit transforms are off by a hundredth of it
HAIR = 1e-3  # metres; what rounding may shift a point by
SOUGHT_EDGE = 0.25  # metres; blocks of such an edge are few enough, and their bounds tight enough
MOST_SHIFTS = 25_000_000  # blocks of a sector; of more it is not asked which sectors are left
COARSER = 3  # levels above the blocks, at which it is asked which sectors are left at all


class PlaneBlocks:
    """The blocks of one level of a lattice.

    level : in the lattice
    turns : sectors of turns
    side  : blocks along an edge of the plane
    """

    def __init__(self, lattice: TransformLattice) -> None:
        self.lattice = lattice
        self.level = min(lattice.levels, max(1, int(np.log2(SOUGHT_EDGE / lattice.cell))))
        self.turns, self.side = lattice.turns >> self.level, lattice.side >> self.level

    @cached_property
    def left(self) -> list[int]:
        """The sectors in which the window holds anything."""
        window = self.lattice.window
        if (not len(window.x_ref) and not window.priors) or self.side**2 > MOST_SHIFTS:
            return list(range(self.turns))
        groups = range(ceil(self.turns / 2**COARSER))
        found = zip(groups, each_on_a_core(self._is_left, groups), strict=True)
        held = {group for group, left in found if left}
        return [turn for turn in range(self.turns) if turn >> COARSER in held]

    @property
    def count(self) -> int:
        """How many there are in these sectors."""
        return int(len(self.left) * self.side**2)

    def _is_left(self, group: int) -> bool:
        """Whether the window holds any transform of some neighbouring sectors."""
        coarser = self.level + COARSER
        across = np.arange(ceil(self.side / 2**COARSER))
        cols, rows = (axis.ravel() for axis in np.meshgrid(across, across))
        nodes = np.column_stack([np.full(len(cols), group), cols, rows])
        poses = self.lattice.poses(self.lattice.coordinates(nodes, coarser))
        off = self.lattice.nearest_deviations(poses, coarser)
        return bool((off <= self.lattice.window.k).all(axis=1).any())


class PlaneBounds:
    """Their bounds, a sector at a time."""

    def __init__(self, objective: Objective, blocks: PlaneBlocks) -> None:
        self.lattice, self.level, self.side = blocks.lattice, blocks.level, blocks.side
        self._edge = 2**self.level * self.lattice.cell
        middle = self.lattice.coordinates(np.zeros((1, 3), dtype=np.int64), self.level)
        self._first = middle[0, :2]  # shift of the first block's middle
        self._swing = chord(self.lattice.half_turn(self.level))
        self._forward, self._backward = objective.sides
        self._reach = max(
            float(np.linalg.norm(self._points(self._forward), axis=1).max(initial=0.0)),
            self.lattice.table_reach(self._backward),
        )
        self._margin = ceil(self._reach / self._edge) + 2  # cells on each side of a turned raster
        span = self.side + 2 * self._margin
        self.shape = (cv2.getOptimalDFTSize(span),) * 2
        field, walls = self._forward_field(span), self._backward_walls(span)
        self._largest = self._turnable_field()
        self._norms = float(np.linalg.norm(field)), float(np.linalg.norm(walls))
        self._spectra = spectrum(field, self.shape), spectrum(walls, self.shape)

    def above(self, turn: int, value: float) -> tuple[IntArray, FloatArray, float]:
        """(P, 3) the blocks of a sector that may hold more than a value, (P,) their bounds, and the largest
        bound of the others.
        """
        bounds = self.bounds(turn)
        rows, cols = np.nonzero(bounds > value)
        found = bounds[rows, cols]
        bounds[rows, cols] = -np.inf
        nodes = np.column_stack([np.full(len(rows), turn), cols, rows]).astype(np.int64)
        return nodes, found.astype(np.float64), float(bounds.max())

    def bounds(self, turn: int) -> Float32Array:
        """(side, side), row by row: no transform of the lattice in a block has a higher value; what is known
        of the transform left aside.
        """
        middle = ((turn + 0.5) * 2**self.level - 0.5) * self.lattice.step
        to_ref = rotation(middle - self.lattice.yaw)  # from the mov frame's axes to the ref grid's
        walls, field = self._forward_walls(to_ref), self._backward_field(to_ref)
        rounding = ROUNDING * (
            self._norms[0] * float(np.linalg.norm(walls)) + self._norms[1] * float(np.linalg.norm(field))
        )
        both: Any = cv2.mulSpectrums(self._spectra[0], spectrum(walls, self.shape), 0, conjB=True)
        both += cv2.mulSpectrums(self._spectra[1], spectrum(field, self.shape), 0, conjB=True)
        return np.asarray(correlated(both)[: self.side, : self.side] + np.float32(rounding))

    def _points(self, side: Side) -> FloatArray:
        """(N, 2) metres from what a turn leaves in its place; the axes of the points' own frame."""
        return from_pivot(side, side.points, self.lattice.window)

    def _raster(self, points: FloatArray, weights: FloatArray, size: int) -> Float32Array:
        """(size, size) weights of (N, 2) points, metres, in cells of which the ``margin``-th begins at 0."""
        cols, rows = (np.floor(points / self._edge).astype(np.intp) + self._margin).T
        inside = (cols >= 0) & (cols < size) & (rows >= 0) & (rows < size)
        at = rows[inside] * size + cols[inside]
        return np.bincount(at, weights[inside], size * size).reshape(size, size).astype(np.float32)

    def _forward_walls(self, to_ref: FloatArray) -> Float32Array:
        """Map 2's walls, turned."""
        side = self._forward
        return self._raster(self._points(side) @ to_ref.T, side.weights, 2 * self._margin + 1)

    def _forward_field(self, span: int) -> Float32Array:
        """(span, span) the largest value of map 1's table that a point may find whose turned place and shift
        add up to this cell.
        """
        side, grid = self._forward, self._forward.grid
        reach = self.lattice.half(self.level) + self._swing * self._reach + HAIR
        place = grid.grid_coordinates(self.lattice.window.place) * grid.resolution
        low = place + self._first - self._margin * self._edge - reach  # of the first cell's reach
        wide = ceil((self._edge + 2 * reach) / grid.resolution) + 1
        padded = np.pad(side.table, wide)
        largest = cv2.dilate(padded, np.ones((wide, wide), dtype=np.uint8), anchor=(0, 0))
        field = np.zeros((span, span), dtype=np.float32)
        at = [
            np.floor((low[axis] + np.arange(span) * self._edge) / grid.resolution - side.corner[axis])
            .astype(np.intp) + PAD + wide
            for axis in range(2)
        ]  # fmt: skip
        cols, rows = (
            np.flatnonzero((k >= 0) & (k < n)) for k, n in zip(at, largest.shape[::-1], strict=True)
        )
        field[np.ix_(rows, cols)] = largest[np.ix_(at[1][rows], at[0][cols])]
        return field

    def _backward_walls(self, span: int) -> Float32Array:
        """(span, span) map 1's walls, less the shift of the first block's middle."""
        side = self._backward
        turned = self._points(side) @ rotation(-self.lattice.yaw).T
        return self._raster(turned - self._first, side.weights, span)

    def _turnable_field(self) -> Float32Array:
        """Map 2's table, every cell the largest within a block's reach of it, however that is turned."""
        side = self._backward
        # what turns farther out than the table reaches finds nothing, at any turn
        swing = self._swing * self.lattice.table_reach(side)
        reach = self._edge * sqrt(0.5) + self.lattice.half(self.level) * sqrt(2) + swing + HAIR
        cells = reach / side.grid.resolution
        across = np.maximum(np.abs(np.arange(-ceil(cells) - 1, ceil(cells) + 2)) - 1, 0)
        disc = (np.hypot(across[:, None], across) <= cells).astype(np.uint8)
        padded = np.pad(side.table, len(across))
        return np.asarray(cv2.dilate(padded, disc), dtype=np.float32)

    def _backward_field(self, to_ref: FloatArray) -> Float32Array:
        """The same, turned, in the raster's cells."""
        side, grid = self._backward, self._backward.grid
        size, shape = 2 * self._margin + 1, self._largest.shape
        pad = (shape[0] - side.table.shape[0]) // 2 + PAD
        centres = (np.arange(size) - self._margin + 0.5) * self._edge
        to_grid = rotation(-grid.origin.theta) @ to_ref.T / grid.resolution
        start = grid.grid_coordinates(self.lattice.window.pivot) - side.corner + pad
        x = to_grid[0, 0] * centres + to_grid[0, 1] * centres[:, None] + start[0]
        y = to_grid[1, 0] * centres + to_grid[1, 1] * centres[:, None] + start[1]
        inside = (x >= 0) & (x < shape[1]) & (y >= 0) & (y < shape[0])
        at = (y * inside).astype(np.intp) * shape[1] + (x * inside).astype(np.intp)
        return np.asarray(self._largest.ravel()[at] * inside, dtype=np.float32)
