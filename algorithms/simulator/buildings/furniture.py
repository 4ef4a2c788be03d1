"""What stands in rooms, as a lidar at shin height sees it, and the doors between them."""

from __future__ import annotations

import numpy as np

from algorithms.simulator.buildings.floor_plan import WALL, FloorPlan, Piece, Rectangle
from algorithms.simulator.portable_random import (
    TURN,
    chance,
    cosine,
    pick,
    sine,
    ticks_of_degrees,
    uniform,
    whole,
)

LEG = 0.06  # metres; thinner legs would slip between the beams of most lidars
DOOR = 0.95  # metres of clear opening
LEAF = 0.05  # metres; thickness of a door's leaf


def door(
    plan: FloorPlan,
    rng: np.random.Generator,
    x: float,
    y: float,
    along: tuple[int, int],
    into: tuple[int, int],
    leafless: float = 0.2,
    shut: float = 0.08,
) -> bool:
    """Cut a door into a wall and hang its leaf.

    x, y     : one jamb, on the middle line of the wall; metres
    along    : unit vector from that jamb to the other
    into     : unit vector into the room the leaf opens to
    leafless : how likely it is a mere opening
    shut     : how likely it is closed or stands ajar, so that nobody gets through
    returns  : whether a robot gets through
    """
    far_x, far_y = x + DOOR * along[0], y + DOOR * along[1]
    deep_x, deep_y = 0.22 * abs(into[0]), 0.22 * abs(into[1])
    x0, y0 = min(x, far_x) - deep_x, min(y, far_y) - deep_y
    x1, y1 = max(x, far_x) + deep_x, max(y, far_y) + deep_y
    plan.box(x0, y0, x1, y1, what=0)
    plan.doors.append((x, y, far_x, far_y))
    way_x, way_y = 0.7 * abs(into[0]), 0.7 * abs(into[1])
    plan.keep_clear(x0 - way_x, y0 - way_y, x1 + way_x, y1 + way_y)
    if chance(rng, leafless):
        return True
    closed = chance(rng, shut)
    degrees = pick(rng, (0.0, 15.0, 30.0, 40.0)) if closed else uniform(rng, 80, 115)
    angle = ticks_of_degrees(degrees)
    c, s = 0.97 * DOOR * float(cosine(angle)), 0.97 * DOOR * float(sine(angle))
    leaf_x, leaf_y = c * along[0] + s * into[0], c * along[1] + s * into[1]
    plan.line(x, y, x + leaf_x, y + leaf_y, LEAF)
    side = along[0] * into[1] - along[1] * into[0]  # 1: the room is to the left
    front = side * angle + (TURN // 4 if along[1] else 0) - TURN // 4
    middle = x + leaf_x / 2, y + leaf_y / 2
    plan.pieces.append(Piece("door leaf", *middle, LEAF, 0.97 * DOOR, front % TURN))
    return not closed


def _along_a_wall(
    plan: FloorPlan, rng: np.random.Generator, room: Rectangle, length: float, depth: float
) -> Rectangle | None:
    """An empty place against one of the four walls of a room, or None after a few tries."""
    x0, y0, x1, y1 = room
    gap = 0.04
    for _ in range(8):
        side = whole(rng, 0, 3)
        wide, deep = (length, depth) if side < 2 else (depth, length)
        if x1 - x0 - wide < 2 * gap or y1 - y0 - deep < 2 * gap:
            continue
        x = uniform(rng, x0 + gap, x1 - gap - wide)
        y = uniform(rng, y0 + gap, y1 - gap - deep)
        if side < 2:
            y = (y0 + gap, y1 - gap - deep)[side]
        else:
            x = (x0 + gap, x1 - gap - wide)[side - 2]
        if plan.is_clear(x + 0.02, y + 0.02, x + wide - 0.02, y + deep - 0.02):
            return x, y, x + wide, y + deep
    return None


def _in_the_room(
    plan: FloorPlan, rng: np.random.Generator, room: Rectangle, wide: float, deep: float, aisle: float
) -> Rectangle | None:
    """An empty place with room to pass on all sides, or None after a few tries."""
    x0, y0, x1, y1 = room
    if x1 - x0 < wide + 2 * aisle or y1 - y0 < deep + 2 * aisle:
        return None
    for _ in range(6):
        x, y = uniform(rng, x0 + aisle, x1 - aisle - wide), uniform(rng, y0 + aisle, y1 - aisle - deep)
        if plan.is_clear(x - aisle / 2, y - aisle / 2, x + wide + aisle / 2, y + deep + aisle / 2):
            return x, y, x + wide, y + deep
    return None


def _front(place: Rectangle, room: Rectangle) -> int:
    """Quarter turns from x to where a piece against a wall looks: away from that wall."""
    x0, y0, x1, y1 = place
    if x1 - x0 >= y1 - y0:
        return 1 if y0 - room[1] < room[3] - y1 else 3
    return 0 if x0 - room[0] < room[2] - x1 else 2


def _legs(plan: FloorPlan, place: Rectangle) -> None:
    x0, y0, x1, y1 = place
    for x in (x0, x1 - LEG):
        for y in (y0, y1 - LEG):
            plan.box(x, y, x + LEG, y + LEG)


def _chair(plan: FloorPlan, rng: np.random.Generator, x: float, y: float, quarter: int) -> None:
    """Four legs, or the star foot of an office chair; ``quarter`` as in ``FloorPlan.note``."""
    place = (x - 0.22, y - 0.22, x + 0.22, y + 0.22)
    alone = plan.is_empty(*place)
    if chance(rng, 0.5):
        foot = uniform(rng, 0.12, 0.2)
        if alone:
            plan.note("office chair", (x - foot, y - foot, x + foot, y + foot), quarter)
        plan.ring(x, y, 0.0, foot)
    else:
        if alone:
            plan.note("chair", place, quarter)
        _legs(plan, place)


def desk(plan: FloorPlan, rng: np.random.Generator, room: Rectangle) -> None:
    """A desk on legs with a drawer unit, and its chair."""
    place = _along_a_wall(plan, rng, room, uniform(rng, 1.3, 1.8), uniform(rng, 0.7, 0.8))
    if place is None:
        return
    x0, y0, x1, y1 = place
    front = _front(place, room)
    plan.note("desk", place, front)
    _legs(plan, place)
    if chance(rng, 0.7):
        drawers = (x0 + 0.08, y0 + 0.08, x0 + 0.5, y0 + 0.6)
        plan.note("drawers", drawers, front)
        plan.box(*drawers)
    middle_x, middle_y = (room[0] + room[2]) / 2, (room[1] + room[3]) / 2
    x, y = (x0 + x1) / 2, (y0 + y1) / 2
    if x1 - x0 > y1 - y0:
        _chair(plan, rng, x + 0.2, y + (0.6 if middle_y > y else -0.6), 3 if middle_y > y else 1)
    else:
        _chair(plan, rng, x + (0.6 if middle_x > x else -0.6), y, 2 if middle_x > x else 0)


def cabinet(plan: FloorPlan, rng: np.random.Generator, room: Rectangle) -> None:
    """A solid cupboard or bookshelf against a wall."""
    place = _along_a_wall(plan, rng, room, uniform(rng, 0.8, 2.2), uniform(rng, 0.35, 0.6))
    if place is not None:
        plan.note("cabinet", place, _front(place, room))
        plan.box(*place)


def sofa(plan: FloorPlan, rng: np.random.Generator, room: Rectangle) -> None:
    """A sofa or a bed: large, solid, against a wall."""
    size = pick(rng, ((1.7, 0.85), (2.1, 0.9), (2.0, 1.5)))
    place = _along_a_wall(plan, rng, room, *size)
    if place is not None:
        plan.note("bed" if size[1] > 1.0 else "sofa", place, _front(place, room))
        plan.box(*place)


def table(plan: FloorPlan, rng: np.random.Generator, room: Rectangle) -> None:
    """A table on four legs with chairs around it, in the middle of the room."""
    place = _in_the_room(plan, rng, room, uniform(rng, 1.0, 2.2), uniform(rng, 0.8, 1.1), 0.9)
    if place is None:
        return
    plan.note("table", place)
    _legs(plan, place)
    x0, y0, x1, y1 = place
    for x in [x0 + 0.35 + k * 0.7 for k in range(max(1, int((x1 - x0) / 0.7)))]:
        for y, towards in ((y0 - 0.1, 1), (y1 + 0.1, 3)):
            if chance(rng, 0.75):
                _chair(plan, rng, x + uniform(rng, -0.08, 0.08), y + uniform(rng, -0.1, 0.1), towards)


def boxes(plan: FloorPlan, rng: np.random.Generator, room: Rectangle) -> None:
    """A carton or crate that somebody left, at some angle."""
    size = uniform(rng, 0.3, 0.7)
    place = _in_the_room(plan, rng, room, size, size, 0.5)
    if place is not None:
        x, y = (place[0] + place[2]) / 2, (place[1] + place[3]) / 2
        carton = Piece("carton", x, y, size, uniform(rng, 0.3, 0.6), whole(rng, 0, 16383))
        plan.pieces.append(carton)
        plan.turned_box(x, y, carton.depth, carton.width, carton.ticks)


def plant(plan: FloorPlan, rng: np.random.Generator, room: Rectangle) -> None:
    """A round pot, or a bin."""
    size = uniform(rng, 0.3, 0.5)
    place = _along_a_wall(plan, rng, room, size, size)
    if place is not None:
        plan.note("plant", place)
        plan.ring((place[0] + place[2]) / 2, (place[1] + place[3]) / 2, 0.0, size / 2, WALL)


PIECES = {
    "study": (desk, desk, cabinet, cabinet, plant),
    "work": (desk, desk, desk, desk, cabinet, cabinet, plant),
    "meeting": (table, cabinet, plant),
    "living": (sofa, sofa, table, cabinet, cabinet, plant),
    "sleeping": (sofa, cabinet, cabinet, desk),
    "kitchen": (cabinet, cabinet, cabinet, table),
    "store": (cabinet, cabinet, cabinet, boxes, boxes, boxes),
    "empty": (plant,),
}


def furnish(plan: FloorPlan, rng: np.random.Generator, room: Rectangle, use: str) -> None:
    """Put into a room what its use asks for; pieces that find no place are left out.

    room : the inside of the walls; metres, world frame
    use  : a key of PIECES
    """
    for piece in PIECES[use]:
        if chance(rng, 0.85):
            piece(plan, rng, room)
