"""A long corridor that looks alike both ways, nearly: a building made to mislead."""

from __future__ import annotations

import numpy as np

from algorithms.simulator.buildings.floor_plan import AIR, Building, FloorPlan
from algorithms.simulator.buildings.furniture import DOOR, boxes, door, furnish, plant
from algorithms.simulator.buildings.office import INNER, MARGIN, OUTER, evenly
from algorithms.simulator.portable_random import chance, pick, uniform


def _side_room(plan: FloorPlan, rng: np.random.Generator, x: float, wall: float, up: int) -> None:
    """A room behind a corridor wall, its door open or shut."""
    wide, deep = uniform(rng, 3.2, 4.4), uniform(rng, 3.0, 4.0)
    low, high = sorted((wall, wall + up * deep))
    plan.outline(x, low, x + wide, high, INNER)
    passable = door(plan, rng, x + uniform(rng, 0.4, wide - 1.5), wall, (1, 0), (0, up), shut=0.1)
    inside = (x + 0.1, low + 0.1, x + wide - 0.1, high - 0.1)
    furnish(plan, rng, inside, pick(rng, ("study", "store", "work")))
    if passable:
        plan.stops.append((x + wide / 2, (low + high) / 2))


def corridor(shell: np.random.Generator, rng: np.random.Generator, resolution: float = 0.025) -> Building:
    """A corridor of about 50 m between two lobbies, alike when turned by 180°, nearly.

    Closed doors sit in recesses at an even pitch on both walls; every feature has a twin at the
    place half a turn away, except for the few that don't.
    """
    length, wide, lobby = uniform(shell, 42, 52), uniform(shell, 2.0, 2.4), uniform(shell, 5.0, 6.5)
    deep = 4.6  # metres on each side of the corridor
    height = 2 * deep + wide
    plan = FloorPlan(length + 2 * MARGIN, height + 2 * MARGIN, resolution)
    left, right, middle = MARGIN, MARGIN + length, MARGIN + height / 2
    low, high = middle - wide / 2, middle + wide / 2
    plan.box(left, low - OUTER, right, high + OUTER)
    plan.box(left + OUTER, low, right - OUTER, high, AIR)
    for x in (left, right - lobby):
        plan.outline(x, middle - lobby / 2 - 0.8, x + lobby, middle + lobby / 2 + 0.8, OUTER)
        plan.box(x + 0.2, middle - lobby / 2 - 0.6, x + lobby - 0.2, middle + lobby / 2 + 0.6, AIR)
        plan.box(x - 0.3 if x > left else x + 1, low, x + lobby + 0.3 if x == left else x + 1, high, AIR)
        plan.pillar(x + lobby / 2, middle + 1.6, 0.3)  # one each, not turned with the rest
        plan.stops.append((x + lobby / 2, middle - 1.0))
        inside = (x + 0.25, middle - lobby / 2 - 0.5, x + lobby - 0.25, middle + lobby / 2 + 0.5)
        furnish(plan, rng, inside, "living")
    pitch = uniform(rng, 3.4, 4.2)
    first, last = left + lobby + 0.8, right - lobby - 0.8 - DOOR
    for x in evenly(first, last, pitch):
        twin_x = left + right - x - DOOR
        for at, up in ((x, 1), (twin_x, -1)):
            wall = high if up > 0 else low
            if chance(rng, 0.1):
                continue
            bottom, top = sorted((wall, wall + up * 0.15))
            plan.box(at, bottom, at + DOOR, top, AIR)  # a closed door in its recess
            plan.note("recess", (at, bottom, at + DOOR, top), 3 if up > 0 else 1)
    for x in evenly(first + 1.4, last - 4, 9.0):
        if chance(rng, 0.75):
            _side_room(plan, rng, x, high + OUTER / 2, 1)
        if chance(rng, 0.75):
            _side_room(plan, rng, left + right - x - 4.4, low - OUTER / 2, -1)
    inside = (left + lobby, low, right - lobby, high)
    for _ in range(int(length / 8)):
        plant(plan, rng, inside)
        if chance(rng, 0.25):
            boxes(plan, rng, inside)
    plan.stops += [(x, middle) for x in evenly(left + lobby + 1, right - lobby, 3.2)]
    return plan.finish("corridor")
