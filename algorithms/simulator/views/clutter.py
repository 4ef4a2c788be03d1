"""Things that stand about and are in no map, some of them a little like a robot; posters on walls."""

from __future__ import annotations

import numpy as np

from algorithms.common.pose import FloatArray
from algorithms.simulator.buildings.floor_plan import WALL, Building
from algorithms.simulator.portable_random import TURN, pick, uniform, whole
from algorithms.simulator.views.interiors.free_floor import free_floor
from algorithms.simulator.views.interiors.interior import interior_of
from algorithms.simulator.views.solids import DRUM, Solid
from algorithms.simulator.views.surfaces.materials import Material, Picture
from algorithms.simulator.views.surfaces.noise import lattice
from algorithms.simulator.views.surfaces.pictures import VARIANTS, painted_picture
from algorithms.simulator.views.view_scene import Poster

AROUND = 0.75  # metres from a robot's middle that clutter keeps away
BROWN, WHITE, GREY = (0.66, 0.52, 0.36), (0.9, 0.9, 0.88), (0.5, 0.51, 0.53)


def thing_at(rng: np.random.Generator, x: float, y: float) -> list[Solid]:
    """A carton, a crate, a bin, a stool or a case."""
    turn, kind = whole(rng, 0, TURN - 1), whole(rng, 0, 5)
    seed = whole(rng, 0, 199)
    deep, wide, high = uniform(rng, 0.25, 0.55), uniform(rng, 0.3, 0.6), uniform(rng, 0.25, 0.65)
    if kind <= 1:
        face = Material("carton", pick(rng, (BROWN, WHITE)), (0.8, 0.74, 0.6), seed=seed)
        return [Solid(x, y, deep, wide, 0.0, high, (face,), turn)]
    if kind == 2:  # a white box with something dark printed on it
        printed = Material("picture", picture=_print(seed), fine=True)
        plain = Material("plain", WHITE)
        return [Solid(x, y, deep, wide, 0.0, high, (printed, printed, plain, plain, plain, plain), turn)]
    if kind == 3:
        colour = pick(rng, (GREY, (0.15, 0.15, 0.16), (0.2, 0.35, 0.55), WHITE))
        drum = Solid(x, y, deep * 0.7, deep * 0.7, 0.0, high, (Material("plain", colour),), shape=DRUM)
        return [drum]
    if kind == 4:  # a cupboard on castors
        front = Material("drawers", pick(rng, (WHITE, GREY)), (0.25, 0.25, 0.26), (1.0, 0.2), seed)
        side, dark = Material("plain", front.colour), Material("plain", (0.1, 0.1, 0.1))
        low = Solid(0, 0, deep - 0.1, wide - 0.1, 0.0, 0.05, (dark,)).moved(x, y, turn)
        return [low, Solid(x, y, deep, wide, 0.05, 0.05 + high, (front, side, side, side, side, side), turn)]
    case = Material(
        "fabric", pick(rng, ((0.2, 0.22, 0.28), (0.45, 0.12, 0.14), (0.2, 0.3, 0.25))), size=(2, 2)
    )
    handle = Solid(-0.1, 0, 0.02, 0.2, high + 0.1, high + 0.35, (Material("plain", GREY),)).moved(x, y, turn)
    return [Solid(x, y, 0.25, wide * 0.8, 0.03, high + 0.1, (case,), turn), handle]


def _print(seed: int) -> Picture:
    """White, with a square of dark blocks or bars: something a detector has to tell from a robot's board."""
    side = 60
    rows, cols = np.indices((side, side))
    if seed % 3 == 0:
        dark = lattice(cols // 6, rows // 6, seed) > 0.5
    elif seed % 3 == 1:
        dark = (cols // (3 + seed % 4)) % 2 == 0
    else:
        dark = lattice(cols // 15, rows // 15, seed) > 0.4
    sheet = np.full((100, 100, 3), 232, dtype=np.uint8)
    sheet[20:80, 20:80][dark] = 30
    return sheet


def draw_things(
    rng: np.random.Generator, building: Building, near: FloatArray, apart: FloatArray
) -> list[Solid]:
    """A few things within some metres of a place.

    near  : (2,) the place; metres, world frame
    apart : (N, 2) middles of robots, from which they keep away
    """
    floor, things = free_floor(building), []
    taken = [(x, y) for x, y in apart.tolist()]
    for _ in range(whole(rng, 0, 4)):
        for _ in range(12):
            x, y = float(near[0]) + uniform(rng, -4.5, 4.5), float(near[1]) + uniform(rng, -4.5, 4.5)
            far = min(((x - a) * (x - a) + (y - b) * (y - b) for a, b in taken), default=9.0)
            if floor.clear_of_walls(x, y) > 0.42 and far > (AROUND + 0.4) * (AROUND + 0.4):
                things += thing_at(rng, x, y)
                taken.append((x, y))
                break
    return things


def draw_posters(rng: np.random.Generator, building: Building, seed: int, near: FloatArray) -> list[Poster]:
    """Art and notices on the walls around a place, over what hangs there already."""
    posters = []
    for _ in range(whole(rng, 0, 3)):
        kind = pick(rng, ("art", "landscape", "notice", "low notice", "sign"))
        picture, width, height = painted_picture(kind, whole(rng, 0, VARIANTS - 1))
        poster = place_on_wall(rng, building, seed, near, 5.0, picture, width, height, uniform(rng, 0.1, 1.2))
        posters += [poster] if poster else []
    return posters


def wall_near(
    rng: np.random.Generator, building: Building, seed: int, near: FloatArray, reach: float, width: float
) -> tuple[FloatArray, FloatArray] | None:
    """The two ends, left and right, of a stretch of wall that faces a place; None if none is wide enough."""
    walls = interior_of(building, seed).walls
    ends, normals, lengths = walls.ends, walls.normals(), walls.lengths()
    middles = (ends[:, :2] + ends[:, 2:]) / 2
    to = near - middles
    facing = (to * normals).sum(axis=1)
    fit = (walls.kind == WALL) & (lengths > width + 0.1) & (facing > 0.5)
    fit &= (to * to).sum(axis=1) < reach * reach
    chosen = np.flatnonzero(fit)
    if not len(chosen):
        return None
    n = int(chosen[whole(rng, 0, len(chosen) - 1)])
    at, length = uniform(rng, 0.05, float(lengths[n]) - width - 0.05), float(lengths[n])
    along = (ends[n, 2:] - ends[n, :2]) / length
    return ends[n, :2] + at * along, ends[n, :2] + (at + width) * along


def place_on_wall(
    rng: np.random.Generator,
    building: Building,
    seed: int,
    near: FloatArray,
    reach: float,
    picture: Picture,
    width: float,
    height: float,
    bottom: float,
    robot: bool = False,
) -> Poster | None:
    """A picture on one of the walls that face a place."""
    found = wall_near(rng, building, seed, near, reach, width)
    if found is None:
        return None
    left, right = found
    return Poster(
        (float(left[0]), float(left[1])),
        (float(right[0]), float(right[1])),
        bottom,
        bottom + height,
        picture,
        robot,
    )
