"""Apartments and homes: a rectangle split again and again, a door in every dividing wall."""

from __future__ import annotations

import numpy as np

from algorithms.simulator.buildings.floor_plan import Building, FloorPlan, Rectangle, along
from algorithms.simulator.buildings.furniture import DOOR, boxes, door, furnish
from algorithms.simulator.buildings.office import INNER, MARGIN, OUTER, windows
from algorithms.simulator.portable_random import chance, pick, uniform

Wall = tuple[bool, float, float, float]  # upright?, its level, from, to; metres


def _divide(rng: np.random.Generator, room: Rectangle, rooms: list[Rectangle], walls: list[Wall]) -> None:
    """Split a room until it is small enough; collects rooms and dividing walls."""
    x0, y0, x1, y1 = room
    wide, deep = x1 - x0, y1 - y0
    if max(wide, deep) < 4.2 or (wide * deep < 26 and chance(rng, 0.6)) or min(wide, deep) < 1.9:
        rooms.append(room)
        return
    if wide > deep:
        cut = x0 + wide * uniform(rng, 0.34, 0.66)
        walls.append((True, cut, y0, y1))
        halves: tuple[Rectangle, Rectangle] = (x0, y0, cut, y1), (cut, y0, x1, y1)
    else:
        cut = y0 + deep * uniform(rng, 0.34, 0.66)
        walls.append((False, cut, x0, x1))
        halves = (x0, y0, x1, cut), (x0, cut, x1, y1)
    for half in halves:
        _divide(rng, half, rooms, walls)


def _door_in(plan: FloorPlan, rng: np.random.Generator, wall: Wall) -> None:
    """A door where no other wall ends in the way."""
    upright, level, low, high = wall
    for _ in range(60):
        a = uniform(rng, low + 0.3, high - 0.3 - DOOR)
        before, after = level - INNER, level + INNER
        beside = (before - 0.8, before), (after, after + 0.8)
        if all(plan.is_empty(*along(upright, *levels, a - 0.15, a + DOOR + 0.15)) for levels in beside):
            side = pick(rng, (-1, 1))
            x, y = (level, a) if upright else (a, level)
            ahead, into = ((0, 1), (side, 0)) if upright else ((1, 0), (0, side))
            door(plan, rng, x, y, ahead, into, leafless=0.4, shut=0.0)
            return


def apartment(shell: np.random.Generator, rng: np.random.Generator, resolution: float = 0.025) -> Building:
    """An apartment of about 16 m × 13 m: eight to fourteen rooms that open into one another."""
    width, height = uniform(shell, 14, 18), uniform(shell, 11, 14)
    return _rooms(rng, width, height, resolution, "apartment")


def home(shell: np.random.Generator, rng: np.random.Generator, resolution: float = 0.025) -> Building:
    """A small home of about 9 m × 7 m: three to six rooms."""
    width, height = uniform(shell, 7, 11), uniform(shell, 5.5, 8.5)
    return _rooms(rng, width, height, resolution, "home")


def _rooms(rng: np.random.Generator, width: float, height: float, resolution: float, name: str) -> Building:
    """A rectangle divided into rooms that open into one another; metres."""
    plan = FloorPlan(width + 2 * MARGIN, height + 2 * MARGIN, resolution)
    outline = (MARGIN, MARGIN, MARGIN + width, MARGIN + height)
    rooms: list[Rectangle] = []
    walls: list[Wall] = []
    _divide(rng, outline, rooms, walls)
    plan.outline(*outline, OUTER)
    for upright, level, low, high in walls:
        plan.box(*along(upright, level - INNER / 2, level + INNER / 2, low, high))
    for wall in walls:
        _door_in(plan, rng, wall)
        if wall[3] - wall[2] > 7:
            _door_in(plan, rng, wall)
    windows(plan, rng, *outline)
    if chance(rng, 0.5):  # a bay: one corner of the house is slanted
        cut = uniform(rng, 1.2, 2.4)
        plan.line(outline[0] + cut, outline[1], outline[0], outline[1] + cut, OUTER)
    for x0, y0, x1, y1 in rooms:
        t = INNER / 2
        inside = (x0 + t, y0 + t, x1 - t, y1 - t)
        area = (x1 - x0) * (y1 - y0)
        uses = ("sleeping", "study", "kitchen", "store")
        if area > 12:
            uses = ("living", "living", "meeting", "sleeping")
        furnish(plan, rng, inside, "empty" if area < 5 else pick(rng, uses))
        if chance(rng, 0.15):
            boxes(plan, rng, inside)
        plan.stops.append(((x0 + x1) / 2, (y0 + y1) / 2))
        if area > 14:
            plan.stops.append((x0 + 0.25 * (x1 - x0), y0 + 0.3 * (y1 - y0)))
    return plan.finish(name)
