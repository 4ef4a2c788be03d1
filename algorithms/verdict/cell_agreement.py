"""Which walls of two maps coincide under a transform, and which the other map denies; cell by cell.

For the eye. The verdict counts the same two with every patch slipped to where it fits best
(``algorithms.verdict.wall_evidence``); here the maps lie as they are.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from algorithms.common.pose import Pose2
from algorithms.maps.grid_map import GridMap, where
from algorithms.maps.wall_distance import distance_to_walls
from algorithms.verdict.wall_map import SAME_WALL

SILENT, AGREES, CONTRADICTS = 0, 1, 2
CellAgreement = NDArray[np.uint8]


@dataclass(frozen=True, eq=False)
class WallLookup:
    """A map ready to be held against another one at many transforms."""

    grid: GridMap

    @cached_property
    def cells(self) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
        """(N,) rows and (N,) columns of the walls."""
        return where(self.grid.occupied)

    @cached_property
    def _table(self) -> CellAgreement:
        """(H, W) what a wall of another map is told at each cell."""
        table = np.where(self.grid.free, CONTRADICTS, SILENT).astype(np.uint8)
        table[distance_to_walls(self.grid.occupied) * np.float32(self.grid.resolution) <= SAME_WALL] = AGREES
        return table

    def agreement_with(self, other: WallLookup, T_other_self: Pose2) -> CellAgreement:
        """(N,) SILENT, AGREES or CONTRADICTS: what another map says of each wall cell of this one."""
        at = np.floor(other.grid.grid_coordinates(T_other_self.apply(self.grid.points))).astype(np.intp)
        cols, rows = at.T
        inside = (cols >= 0) & (rows >= 0) & (cols < other.grid.width) & (rows < other.grid.height)
        says = np.full(len(at), SILENT, dtype=np.uint8)
        says[inside] = other._table[rows[inside], cols[inside]]
        return says
