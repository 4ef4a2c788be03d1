"""Another day in a building: doors are shut, furniture is moved."""

from __future__ import annotations

from dataclasses import replace

import cv2
import numpy as np
import scipy  # its parts are loaded where they are first used

from algorithms.common.pose import FloatArray
from algorithms.simulator.buildings.floor_plan import AIR, WALL, Building, FloorPlan
from algorithms.simulator.portable_random import TURN, chance, uniform, whole

LOOSE = 1.5  # metres; what is smaller than this each way and touches nothing is furniture
TAKEN_AWAY = 0.35  # how likely a piece of furniture is gone
SHUT = 0.3  # how likely a door is shut that nobody went through
AROUND = 0.55  # metres around a robot's way in which nothing new may stand
FLOOR_PER_PIECE = 18.0  # m² of floor for each new piece that is tried


def rearranged(building: Building, way: FloatArray, rng: np.random.Generator) -> Building:
    """The building with doors shut, furniture taken away and other furniture set up.

    way : (N, 2) where a robot drives, which stays clear; metres, world frame
    """
    plan = FloorPlan.of(building)
    near = scipy.spatial.cKDTree(way)

    def clear(x: float, y: float, reach: float) -> bool:
        return bool(near.query([x, y])[0] > reach + AROUND)

    _take_away(plan, rng)
    for x0, y0, x1, y1 in building.doors.tolist():
        if chance(rng, SHUT) and clear((x0 + x1) / 2, (y0 + y1) / 2, 0.5):
            plan.line(x0, y0, x1, y1, 0.05)
    height, width = (side * building.resolution for side in building.surface.shape)
    for _ in range(int(width * height / FLOOR_PER_PIECE)):
        x, y = uniform(rng, 0.0, width), uniform(rng, 0.0, height)
        long, deep = uniform(rng, 0.3, 1.4), uniform(rng, 0.25, 0.8)
        reach = (long + deep) / 2
        if clear(x, y, reach) and plan.is_empty(x - reach, y - reach, x + reach, y + reach):
            plan.turned_box(x, y, long, deep, TURN // 4 * whole(rng, 0, 1) + whole(rng, -300, 300))
    return replace(building, surface=plan.cells)


def _take_away(plan: FloorPlan, rng: np.random.Generator) -> None:
    """Remove small things that touch no wall."""
    count, labels, stats, _ = cv2.connectedComponentsWithStats((plan.cells == WALL).astype(np.uint8))
    small = LOOSE / plan.resolution
    gone = np.zeros(count, dtype=bool)
    for label in range(1, count):
        loose = max(stats[label, cv2.CC_STAT_WIDTH], stats[label, cv2.CC_STAT_HEIGHT]) <= small
        gone[label] = loose and chance(rng, TAKEN_AWAY)
    plan.cells[gone[labels]] = AIR
