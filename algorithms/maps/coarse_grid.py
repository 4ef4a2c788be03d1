"""A map in coarser cells, and without the unknown ground around it."""

from __future__ import annotations

from dataclasses import replace
from math import ceil

import numpy as np

from algorithms.common.parallel_kernels import kernel
from algorithms.common.pose import Pose2
from algorithms.maps.grid_map import FREE, FREE_UP_TO, OCCUPIED, OCCUPIED_FROM, UNKNOWN, CellArray, GridMap


def pooled(grid: GridMap, factor: int) -> GridMap:
    """The map in cells ``factor`` times as wide; a cell is a wall where a part is, else free where one is.

    With a factor of 1 it is the map itself.
    """
    if factor <= 1:
        return grid
    height, width = ceil(grid.height / factor), ceil(grid.width / factor)
    cells = np.full((height, width), UNKNOWN, dtype=np.int8)
    _pool(grid.cells, factor, cells)
    return GridMap(cells, grid.resolution * factor, grid.origin, grid.name)


def trimmed(grid: GridMap) -> GridMap:
    """The part of the map in which anything is known; the map itself where nothing is."""
    known = grid.cells != UNKNOWN
    rows, cols = (np.flatnonzero(known.any(axis=axis)) for axis in (1, 0))
    if not len(rows):
        return grid
    low, left = int(rows[0]), int(cols[0])
    cells = np.ascontiguousarray(grid.cells[low : rows[-1] + 1, left : cols[-1] + 1])
    corner = Pose2(left * grid.resolution, low * grid.resolution)
    return replace(grid, cells=cells, origin=grid.origin @ corner)


@kernel
def _pool(cells: CellArray, factor: int, out: CellArray) -> None:
    height, width = cells.shape
    for i in range(out.shape[0]):
        for row in range(i * factor, min(height, (i + 1) * factor)):
            for j in range(out.shape[1]):
                best = out[i, j]
                for col in range(j * factor, min(width, (j + 1) * factor)):
                    value = cells[row, col]
                    if value >= OCCUPIED_FROM:
                        best = OCCUPIED
                    elif FREE <= value <= FREE_UP_TO and best == UNKNOWN:
                        best = FREE
                out[i, j] = best
