"""Two buildings made to mislead: aisles that nearly repeat, a corridor that looks alike both ways."""

from __future__ import annotations

import numpy as np

from algorithms.simulator.buildings.floor_plan import AIR, Building, Canvas
from algorithms.simulator.buildings.furniture import DOOR, boxes, door, furnish, plant
from algorithms.simulator.buildings.office import INNER, MARGIN, OUTER, evenly, windows
from algorithms.simulator.portable_random import chance, pick, uniform, whole

BAY = 2.7  # metres between the posts of a rack
POST = 0.1


def _rack(canvas: Canvas, rng: np.random.Generator, x: float, y: float, bays: int, depth: float) -> None:
    """A pallet rack standing upright from (x, y): posts at every bay, pallets between them."""
    for bay in range(bays + 1):
        for side in (x, x + depth - POST):
            canvas.box(side, y + bay * BAY, side + POST, y + bay * BAY + POST)
    for bay in range(bays):
        for slot in (0.2, 1.45):
            if chance(rng, 0.84):
                in_x, in_y = (
                    uniform(rng, -0.06, 0.1),
                    y + bay * BAY + slot + uniform(rng, -0.06, 0.06),
                )
                canvas.box(
                    x + in_x,
                    in_y,
                    x + in_x + uniform(rng, 0.8, 1.0),
                    in_y + uniform(rng, 0.8, 1.15),
                )


def warehouse(shell: np.random.Generator, rng: np.random.Generator, resolution: float = 0.025) -> Building:
    """A hall of about 30 m × 24 m: racks at an even pitch, a dock in front, an office in a corner."""
    pitch, depth = uniform(shell, 3.5, 4.1), 1.1
    racks, bays = whole(shell, 6, 8), whole(shell, 4, 6)
    dock, back = uniform(shell, 4.5, 6.5), uniform(shell, 2.4, 3.2)
    width, height = racks * pitch + 3.0, dock + bays * BAY + POST + back
    canvas = Canvas(width + 2 * MARGIN, height + 2 * MARGIN, resolution)
    left, bottom, right, top = MARGIN, MARGIN, MARGIN + width, MARGIN + height
    canvas.outline(left, bottom, right, top, OUTER)
    windows(canvas, shell, left, bottom, right, top)
    inside = (left + OUTER / 2, bottom + OUTER / 2, right - OUTER / 2, top - OUTER / 2)
    corner = uniform(rng, 4.0, 6.0)
    deep = min(dock - 2.2, uniform(rng, 2.6, 3.4))
    x_office = left if chance(rng, 0.5) else right - corner
    canvas.outline(x_office, bottom, x_office + corner, bottom + deep, INNER)
    door(
        canvas,
        rng,
        x_office + uniform(rng, 0.5, corner - 1.6),
        bottom + deep,
        (1, 0),
        (0, -1),
        shut=0.0,
    )
    furnish(
        canvas,
        rng,
        (x_office + 0.1, bottom + 0.2, x_office + corner - 0.1, bottom + deep - 0.1),
        "work",
    )
    canvas.stops.append((x_office + corner / 2, bottom + deep / 2))
    y_racks = bottom + dock
    for rack in range(racks):
        x = left + 2.6 + rack * pitch
        short = 1 if chance(rng, 0.25) else 0
        _rack(canvas, rng, x, y_racks + short * BAY, bays - short, depth)
        if chance(rng, 0.3):  # a guard at the head of the aisle
            canvas.ring(x + depth / 2, y_racks + short * BAY - 0.35, 0.0, uniform(rng, 0.08, 0.2))
    for column in range(2, racks, 3):  # the pillars of the hall
        x = left + 2.6 + column * pitch + depth / 2
        for y in (bottom + dock * 0.55, top - 0.6):
            if canvas.is_empty(x - 0.3, y - 0.3, x + 0.3, y + 0.3):
                canvas.box(x - 0.2, y - 0.2, x + 0.2, y + 0.2)
    for lane in range(racks + 1):
        x = left + 2.6 + (lane - 0.5) * pitch + depth / 2 if lane else left + 1.3
        x = min(x, right - 1.2)
        for share in (0.15, 0.5, 0.85):
            canvas.stops.append((x, y_racks + share * bays * BAY))
        canvas.stops += [(x, bottom + dock * 0.62), (x, top - back / 2)]
    for _ in range(whole(rng, 3, 6)):
        boxes(canvas, rng, (inside[0], bottom + deep, inside[2], y_racks - 0.5))
        plant(canvas, rng, inside)
    return canvas.finish("warehouse")


def _side_room(canvas: Canvas, rng: np.random.Generator, x: float, wall: float, up: int) -> bool:
    """A room behind a corridor wall, its door open; returns whether one may enter."""
    wide, deep = uniform(rng, 3.2, 4.4), uniform(rng, 3.0, 4.0)
    low, high = sorted((wall, wall + up * deep))
    canvas.outline(x, low, x + wide, high, INNER)
    passable = door(canvas, rng, x + uniform(rng, 0.4, wide - 1.5), wall, (1, 0), (0, up), shut=0.1)
    furnish(
        canvas,
        rng,
        (x + 0.1, low + 0.1, x + wide - 0.1, high - 0.1),
        pick(rng, ("study", "store", "work")),
    )
    if passable:
        canvas.stops.append((x + wide / 2, (low + high) / 2))
    return passable


def corridor(shell: np.random.Generator, rng: np.random.Generator, resolution: float = 0.025) -> Building:
    """A corridor of about 50 m between two lobbies, alike when turned by 180°, nearly.

    Closed doors sit in recesses at an even pitch on both walls; every feature has a twin at the
    place half a turn away, except for the few that don't.
    """
    length, wide, lobby = uniform(shell, 42, 52), uniform(shell, 2.0, 2.4), uniform(shell, 5.0, 6.5)
    deep = 4.6  # metres on each side of the corridor
    height = 2 * deep + wide
    canvas = Canvas(length + 2 * MARGIN, height + 2 * MARGIN, resolution)
    left, right, middle = MARGIN, MARGIN + length, MARGIN + height / 2
    low, high = middle - wide / 2, middle + wide / 2
    canvas.box(left, low - OUTER, right, high + OUTER)
    canvas.box(left + OUTER, low, right - OUTER, high, AIR)
    for x in (left, right - lobby):
        canvas.outline(x, middle - lobby / 2 - 0.8, x + lobby, middle + lobby / 2 + 0.8, OUTER)
        canvas.box(x + 0.2, middle - lobby / 2 - 0.6, x + lobby - 0.2, middle + lobby / 2 + 0.6, AIR)
        canvas.box(x - 0.3 if x > left else x + 1, low, x + lobby + 0.3 if x == left else x + 1, high, AIR)
        canvas.ring(x + lobby / 2, middle + 1.6, 0.0, 0.3)  # one pillar each, not turned with the rest
        canvas.stops.append((x + lobby / 2, middle - 1.0))
        furnish(
            canvas,
            rng,
            (x + 0.25, middle - lobby / 2 - 0.5, x + lobby - 0.25, middle + lobby / 2 + 0.5),
            "living",
        )
    pitch = uniform(rng, 3.4, 4.2)
    first, last = left + lobby + 0.8, right - lobby - 0.8 - DOOR
    for x in evenly(first, last, pitch):
        twin_x = left + right - x - DOOR
        for at, up in ((x, 1), (twin_x, -1)):
            wall = high if up > 0 else low
            if chance(rng, 0.1):
                continue
            bottom, top = sorted((wall, wall + up * 0.15))
            canvas.box(at, bottom, at + DOOR, top, AIR)  # a closed door in its recess
    for x in evenly(first + 1.4, last - 4, 9.0):
        if chance(rng, 0.75):
            _side_room(canvas, rng, x, high + OUTER / 2, 1)
        if chance(rng, 0.75):
            _side_room(canvas, rng, left + right - x - 4.4, low - OUTER / 2, -1)
    inside = (left + lobby, low, right - lobby, high)
    for _ in range(int(length / 8)):
        plant(canvas, rng, inside)
        if chance(rng, 0.25):
            boxes(canvas, rng, inside)
    canvas.stops += [(x, middle) for x in evenly(left + lobby + 1, right - lobby, 3.2)]
    return canvas.finish("corridor")
