"""The transforms that branch and bound searches, numbered, and blocks of them by level."""

from __future__ import annotations

from math import ceil, isfinite, pi, sqrt

import numpy as np
from numpy.typing import NDArray

from algorithms.common.errors import TooLargeError
from algorithms.common.pose import FloatArray, Pose2, chord, rotation, wrap_angles
from algorithms.observations.search_window import CoupledWindow
from algorithms.optimisation.objective import PAD, Objective, Side
from algorithms.optimisation.search_box import transforms_about

IntArray = NDArray[np.int64]

MOST_ROOTS = 10_000_000  # blocks to begin with: half a gigabyte; a usual sighting makes thousands
LEVELS = 4  # the coarsest blocks are 16 × 16 × 16 transforms
RADII = (1, 2, 3, 4, 6, 8, 11, 16, 22, 32)  # cells; a table of maxima is made for each that is needed
MERGE_FROM = 1  # from this level on, points that lie close together are looked up as one


class TransformLattice:
    """The transforms that are searched, numbered (turn, column, row); blocks of them by level.

    The pivot is the first seen robot: T puts it at its place in the ref map plus the shift.
    """

    def __init__(self, objective: Objective, window: CoupledWindow) -> None:
        self.window = window
        self.cell = max(side.grid.resolution for side in objective.sides)
        reaches = [
            float(np.linalg.norm(from_pivot(side, side.points, window), axis=1).max(initial=0.0))
            for side in objective.sides
        ]
        self.reach = max(self.cell, *reaches)
        self._tables = {side.backward: _table_reach(side, window) for side in objective.sides}
        self.disc = window.disc
        if not isfinite(self.disc):  # farther off no wall of one map meets anything that the other shows
            self.disc = self.reach + max(self._tables.values())
        finest = min(side.grid.resolution for side in objective.sides)
        block = 2**LEVELS
        self.turns = block * ceil(2 * pi * self.reach / self.cell / block)
        self.levels = LEVELS
        while self.levels and self.spread(self.levels) > (RADII[-1] - 1) * finest:
            self.levels -= 1
        # whole blocks, and a transform right on the sighting: there is one in every window
        blocks = 2 * ceil(self.disc / (2**self.levels * self.cell) - 0.5) + 1
        self.side = max(1, blocks) * 2**self.levels
        # shifts along the ref grid's own axes: there a block of them is a square of its cells
        self.yaw = objective.sides[0].grid.origin.theta

    def table_reach(self, side: Side) -> float:
        """How far from what a turn leaves in its place the table of a side holds anything; metres."""
        return self._tables[side.backward]

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
        swing = (self.reach + self.disc + shift) * chord(self.half_turn(level))
        return float(shift + swing + cluster_edge(level, self.cell) * sqrt(2))

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
        goes_to = coordinates[:, :2] @ rotation(self.yaw).T + self.window.place
        out = transforms_about(self.window.pivot, np.column_stack([goes_to, coordinates[:, 2]]))
        out[:, 2] = wrap_angles(out[:, 2])
        return out

    def nearest(self, T_ref_mov: Pose2) -> IntArray:
        """(27, 3) the transform nearest to another one and those around it; of one outside, at the edge."""
        goes_to = T_ref_mov.apply(self.window.pivot) - self.window.place
        shift = rotation(-self.yaw) @ goes_to / self.cell + self.side // 2
        around = np.stack(np.meshgrid(*3 * [[-1, 0, 1]], indexing="ij"), axis=-1).reshape(-1, 3)
        nodes = np.rint(np.append(T_ref_mov.theta / self.step, shift)).astype(np.int64) + around
        nodes[:, 0] %= self.turns
        nodes[:, 1:] = np.clip(nodes[:, 1:], 0, self.side - 1)
        return np.asarray(nodes, dtype=np.int64)

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
        """(P, S + priors) lower bound of the window's deviations anywhere in blocks; (P, 3) x, y, theta."""
        slack = self.window.slack(self.half(level) * sqrt(2), self.half_turn(level))
        middle = self.window.deviations(middles)
        return np.asarray(np.maximum(0.0, middle - slack * (1 + 1e-9)), dtype=np.float64)


def cluster_edge(level: int, cell: float) -> float:
    """Edge of the squares in which points are looked up as one; metres."""
    return cell * 2 ** (level - 1) if level >= MERGE_FROM else 0.0


def from_pivot(side: Side, points: FloatArray, window: CoupledWindow) -> FloatArray:
    """(N, 2) points of a side relative to the place that a turn leaves as it is."""
    pivot = window.place if side.backward else window.pivot
    return np.asarray(points + (side.anchor - pivot), dtype=np.float64)


def _table_reach(side: Side, window: CoupledWindow) -> float:
    """As in ``TransformLattice.table_reach``."""
    rows, cols = np.nonzero(side.table)
    at = np.column_stack([cols, rows]) + side.corner - PAD + 0.5
    pivot = side.grid.grid_coordinates(window.pivot if side.backward else window.place)
    farthest = float(np.linalg.norm(at - pivot, axis=1).max(initial=0.0))
    return (farthest + sqrt(0.5)) * side.grid.resolution
