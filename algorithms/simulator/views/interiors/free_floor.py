"""Where in a building one can stand: its floor indoors, and how far each place is from what stands there."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
import scipy  # its parts are loaded where they are first used
from numpy.typing import NDArray

from algorithms.common.pose import FloatArray
from algorithms.simulator.buildings.floor_plan import Building
from algorithms.simulator.portable_random import snap, whole

Mask = NDArray[np.bool_]


@dataclass(frozen=True, eq=False)
class FreeFloor:
    """The floor indoors that robots get to.

    inside    : (H, W) cells of air within the walls, as in ``Building.surface``
    clearance : (H, W) distance to the nearest solid cell; metres
    cell      : metres
    """

    inside: Mask
    clearance: FloatArray
    cell: float

    def clear_of_walls(self, x: float, y: float) -> float:
        """Distance of a point from the nearest solid cell, 0 outdoors; metres."""
        col, row = int(x / self.cell), int(y / self.cell)
        height, width = self.inside.shape
        if not (0 <= row < height and 0 <= col < width and self.inside[row, col]):
            return 0.0
        return float(self.clearance[row, col])

    def is_indoors(self, x: float, y: float) -> bool:
        return self.clear_of_walls(x, y) > 0

    def draw(self, rng: np.random.Generator, clearance: float) -> tuple[float, float] | None:
        """A place so far from everything, or None where there is none; metres."""
        cells = _cells(self, round(clearance / 0.05))
        if not len(cells):
            return None
        row, col = cells[whole(rng, 0, len(cells) - 1)].tolist()
        x, y = snap((np.array([col, row]) + 0.5) * self.cell).tolist()
        return x, y

    def footprint_clear(self, corners: FloatArray) -> bool:
        """Whether a convex outline, (4, 2) corners in order, lies on free floor."""
        low, high = corners.min(axis=0) / self.cell - 1, corners.max(axis=0) / self.cell + 2
        (c0, r0), (c1, r1) = np.maximum(low, 0).astype(int).tolist(), np.maximum(high, 0).astype(int).tolist()
        part = self.inside[r0:r1, c0:c1]
        if part.size == 0:
            return False
        rows, cols = np.indices(part.shape)
        x, y = (cols + c0 + 0.5) * self.cell, (rows + r0 + 0.5) * self.cell
        within = np.ones(part.shape, dtype=bool)
        for (ax, ay), (bx, by) in zip(corners.tolist(), np.roll(corners, -1, axis=0).tolist(), strict=True):
            within &= (bx - ax) * (y - ay) - (by - ay) * (x - ax) >= 0
        return bool(part[within].all()) and bool(within.any())


@lru_cache(maxsize=64)
def _cells(floor: FreeFloor, steps: int) -> NDArray[np.int64]:
    """(N, 2) row and column of the cells so many times 5 cm from everything."""
    return np.argwhere(floor.inside & (floor.clearance >= steps * 0.05))


@lru_cache(maxsize=4)
def free_floor(building: Building) -> FreeFloor:
    """Air that leads to no edge of the raster, or holds a stop where all of it leads there."""
    labels, count = scipy.ndimage.label(~building.solid)
    edges = np.concatenate([labels[0], labels[-1], labels[:, 0], labels[:, -1]])
    outdoors = np.zeros(count + 1, dtype=bool)
    outdoors[edges] = True
    outdoors[0] = True
    inside = ~outdoors[labels]
    if not inside.any():
        inside = ~building.solid
    far = scipy.ndimage.distance_transform_edt(~building.solid) * building.resolution
    return FreeFloor(inside, np.asarray(far, dtype=np.float64), building.resolution)
