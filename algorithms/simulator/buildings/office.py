"""Office floors: rooms on both sides of long corridors, and cross corridors."""

from __future__ import annotations

import itertools
from math import ceil

import numpy as np

from algorithms.simulator.buildings.floor_plan import AIR, DARK, Building, FloorPlan, Rectangle, along
from algorithms.simulator.buildings.furniture import DOOR, boxes, door, furnish, plant
from algorithms.simulator.portable_random import chance, pick, uniform, whole

MARGIN = 0.6  # metres of open ground around a building
INNER, OUTER = 0.12, 0.35  # metres; thickness of walls


def split(rng: np.random.Generator, low: float, high: float, least: float, most: float) -> list[float]:
    """Cut an interval into pieces of random lengths; returns the cuts with both ends; metres."""
    cuts = [low]
    while high - cuts[-1] > most:
        step = uniform(rng, least, most)
        if high - cuts[-1] - step < least:
            break
        cuts.append(cuts[-1] + step)
    if high - cuts[-1] > most + least / 2:
        cuts.append((cuts[-1] + high) / 2)
    return [*cuts, high]


def evenly(low: float, high: float, step: float) -> list[float]:
    """Places from ``low`` on, ``step`` apart and below ``high``; metres."""
    return [low + k * step for k in range(max(0, ceil((high - low) / step)))]


def windows(plan: FloorPlan, rng: np.random.Generator, x0: float, y0: float, x1: float, y1: float) -> None:
    """Glaze stretches of the four outer walls of a box: beams are stopped, few come back."""
    half = OUTER / 2
    walls = (False, y0, x0, x1), (False, y1, x0, x1), (True, x0, y0, y1), (True, x1, y0, y1)
    for upright, level, low, high in walls:
        for a in split(rng, low + 1, high - 1, 2.0, 5.0)[:-1]:
            if chance(rng, 0.3):
                plan.box(*along(upright, level - half, level + half, a, a + 1.2), DARK)


def _room(plan: FloorPlan, rng: np.random.Generator, room: Rectangle, corridor_above: bool) -> None:
    """One room with its door to the corridor; sometimes round inside, sometimes open in front."""
    x0, y0, x1, y1 = room
    plan.outline(x0, y0, x1, y1, INNER)
    wall_y, into = (y1, -1) if corridor_above else (y0, 1)
    inside = (x0 + INNER / 2, y0 + INNER / 2, x1 - INNER / 2, y1 - INNER / 2)
    centre = ((x0 + x1) / 2, (y0 + y1) / 2)
    if chance(rng, 0.08) and x1 - x0 > 2.5:  # a niche of the corridor: kitchenette, copier
        plan.box(x0 + 0.3, wall_y - 0.2, x1 - 0.3, wall_y + 0.2, AIR)
        furnish(plan, rng, inside, "kitchen")
        plan.stops.append(centre)
        return
    if chance(rng, 0.07) and min(x1 - x0, y1 - y0) > 3.6:
        radius = min(x1 - x0, y1 - y0) / 2 - INNER
        plan.ring(*centre, radius, radius + 0.15)
        x, (low, high) = centre[0] - DOOR / 2, sorted((wall_y, centre[1]))
        plan.box(x, low, centre[0] + DOOR / 2, high, AIR)
        door(plan, rng, x, wall_y, (1, 0), (0, into), leafless=1.0)
        plan.stops.append(centre)
        return
    at = uniform(rng, x0 + 0.25, max(x0 + 0.26, x1 - 0.25 - DOOR))
    jamb, ahead = (at, 1) if chance(rng, 0.5) else (at + DOOR, -1)
    passable = door(plan, rng, jamb, wall_y, (ahead, 0), (0, into))
    if chance(rng, 0.12):  # a glass front beside the door
        plan.box(x0 + 0.1, wall_y - 0.06, max(x0 + 0.1, at - 0.2), wall_y + 0.06, DARK)
    area = (x1 - x0) * (y1 - y0)
    uses = ("work", "work", "meeting", "study") if area > 16 else ("study", "work", "store", "empty")
    furnish(plan, rng, inside, pick(rng, uses))
    if passable:
        plan.stops.append(centre)


def _corridor(plan: FloorPlan, rng: np.random.Generator, room: Rectangle) -> None:
    """Stops along a corridor, and the odd thing that stands in it."""
    x0, y0, x1, y1 = room
    along_x = x1 - x0 > y1 - y0
    low, high = (x0, x1) if along_x else (y0, y1)
    for a in evenly(low + 1.2, high - 1.0, 4.6):
        plan.stops.append((a, (y0 + y1) / 2) if along_x else ((x0 + x1) / 2, a))
    for _ in range(int((high - low) / 7)):
        if chance(rng, 0.6):
            plant(plan, rng, room)
        if chance(rng, 0.15):
            boxes(plan, rng, room)


def floor(
    shell: np.random.Generator,
    rng: np.random.Generator,
    width: float,
    height: float,
    resolution: float,
    name: str,
) -> Building:
    """An office floor of the given size; metres.

    Bands of rooms, corridor, rooms are stacked upwards; corridors across join them.

    shell : draws outer walls and corridors
    rng   : draws the rooms, and what stands in them
    """
    plan = FloorPlan(width + 2 * MARGIN, height + 2 * MARGIN, resolution)
    left, bottom, right, top = MARGIN, MARGIN, MARGIN + width, MARGIN + height
    units = max(1, round(height / 12.5))
    depths = [
        (uniform(shell, 3.6, 6.0), uniform(shell, 1.7, 2.4), uniform(shell, 3.6, 6.0)) for _ in range(units)
    ]
    spare = (height - sum(c for _, c, _ in depths)) / sum(a + b for a, _, b in depths)
    across = [left]
    for cut in split(shell, left, right, 11.0, 19.0)[1:-1]:
        across += [cut - 0.9, cut + uniform(shell, 0.8, 1.2)]
        _corridor(plan, rng, (across[-2], bottom, across[-1], top))
    across.append(right)
    y = bottom
    for lower, corridor, upper in depths:
        below, above = y + lower * spare, y + lower * spare + corridor
        end = above + upper * spare
        for x0, x1 in zip(across[::2], across[1::2], strict=True):
            for low, high, up in ((y, below, True), (above, end, False)):
                cuts = split(rng, x0, x1, 2.8, 6.5)
                for a, b in itertools.pairwise(cuts):
                    _room(plan, rng, (a, low, b, high), corridor_above=up)
        _corridor(plan, rng, (left, below, right, above))
        y = end
    plan.outline(left, bottom, right, top, OUTER)
    windows(plan, shell, left, bottom, right, top)
    if chance(shell, 0.6):
        _slant(plan, shell, (left, bottom, right, top))
    return plan.finish(name)


def _slant(plan: FloorPlan, rng: np.random.Generator, outline: Rectangle) -> None:
    """Cut a corner of the building off with a straight slanted wall."""
    x0, y0, x1, y1 = outline
    a, b = uniform(rng, 3, 8), uniform(rng, 2, 6)
    corner = whole(rng, 0, 3)
    x, dx = (x0, a) if corner % 2 == 0 else (x1, -a)
    y, dy = (y0, b) if corner < 2 else (y1, -b)
    plan.line(x + dx, y, x, y + dy, OUTER)


def office(shell: np.random.Generator, rng: np.random.Generator, resolution: float = 0.025) -> Building:
    """An office floor of about 30 m × 24 m: two corridors with rooms, joined across."""
    width, height = uniform(shell, 27, 34), uniform(shell, 21, 27)
    return floor(shell, rng, width, height, resolution, "office")


def university(shell: np.random.Generator, rng: np.random.Generator, resolution: float = 0.05) -> Building:
    """A large office floor of about 60 m × 40 m, with corridors that look alike for tens of metres."""
    width, height = uniform(shell, 50, 70), uniform(shell, 32, 46)
    return floor(shell, rng, width, height, resolution, "university")
