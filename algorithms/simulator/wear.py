"""What happens to a map between the drive and the file: walls thickened, cells lost, specks."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np

from algorithms.maps.grid_map import FREE, OCCUPIED, UNKNOWN, GridMap
from algorithms.simulator.portable_random import uniforms


@dataclass(frozen=True)
class Wear:
    """How a finished map is worn; without anything it stays as it is."""

    thicker: int = 0
    """Cells by which every wall grows on both sides."""
    lost: float = 0.0
    """Share of the wall cells that become free floor."""
    dotted: float = 0.0
    """Share of the wall cells that become unknown, as in a 3-D map that was projected to the floor."""
    holes: float = 0.0
    """Share of the floor cells that become unknown."""
    specks: float = 0.0
    """Share of the floor cells that become wall."""


def worn(grid: GridMap, wear: Wear, rng: np.random.Generator) -> GridMap:
    """The map after its wear. One state of the generator, one map, bit for bit."""
    if wear == Wear():
        return grid
    cells = grid.cells.copy()
    if wear.thicker:
        side = 2 * wear.thicker + 1
        grown = cv2.dilate(grid.occupied.astype(np.uint8), np.ones((side, side), dtype=np.uint8))
        cells[grown > 0] = OCCUPIED
    for share, before, after in (
        (wear.lost, OCCUPIED, FREE),
        (wear.dotted, OCCUPIED, UNKNOWN),
        (wear.holes, FREE, UNKNOWN),
        (wear.specks, FREE, OCCUPIED),
    ):
        if share > 0:
            at = np.flatnonzero(cells == before)
            cells.flat[at[uniforms(rng, len(at)) < share]] = after
    return GridMap(cells, grid.resolution, grid.origin, grid.name)
