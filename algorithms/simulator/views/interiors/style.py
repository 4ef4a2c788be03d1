"""The taste in which a building is furnished: its floor, walls, doors and woods."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from algorithms.simulator.portable_random import chance, pick, uniform, whole
from algorithms.simulator.views.surfaces.materials import Colour, Material

ROOM, HALL = 2.5, 4.5  # metres to the ceiling

OAK, BEECH, WALNUT, PINE = (0.66, 0.50, 0.33), (0.76, 0.60, 0.42), (0.36, 0.25, 0.17), (0.80, 0.66, 0.46)
WHITE, GREY, BLACK = (0.88, 0.88, 0.86), (0.55, 0.56, 0.57), (0.12, 0.12, 0.13)
WOODS = (OAK, BEECH, WALNUT, PINE, WHITE, WHITE, GREY)
CLOTHS = ((0.32, 0.36, 0.42), (0.55, 0.50, 0.44), (0.24, 0.33, 0.30), (0.50, 0.24, 0.22), (0.70, 0.66, 0.60))
PAINTS = (
    (0.90, 0.89, 0.86), (0.86, 0.85, 0.80), (0.82, 0.85, 0.86), (0.88, 0.84, 0.75), (0.78, 0.82, 0.76),
    (0.75, 0.78, 0.82), (0.93, 0.92, 0.90),
)  # fmt: skip
DADOS = ((0.45, 0.55, 0.52), (0.60, 0.62, 0.66), (0.62, 0.52, 0.42), (0.40, 0.48, 0.60))


@dataclass(frozen=True, eq=False)
class Style:
    """Materials that all rooms of a building share.

    height : to the ceiling; metres
    plaster : the wall's colour alone, for what hangs above a door
    frame  : of doors, in the colour of the skirting
    wood, other_wood, metal, cloth : what furniture is made of
    """

    height: float
    floor: Material
    ceiling: Material
    wall: Material
    plaster: Material
    window: Material
    glass: Material
    door: Material
    frame: Material
    wood: Colour
    other_wood: Colour
    metal: Colour
    cloth: Colour


def draw_style(rng: np.random.Generator, building: str) -> Style:
    """The taste of a building by its name, as "office"; drawn."""
    hall, home = building == "warehouse", building in ("apartment", "home")
    frame = pick(rng, (WHITE, WHITE, GREY, OAK))
    wall = _wall(rng, frame, hall, home)
    leaf = pick(rng, (WHITE, BEECH, OAK, (0.62, 0.68, 0.74), (0.45, 0.5, 0.52)))
    veined = 1.0 if leaf in (BEECH, OAK) else 0.15
    sky = pick(rng, ((0.80, 0.88, 0.97), (0.86, 0.88, 0.90), (0.72, 0.84, 0.98)))
    lamp = (1.5, 1.5, 1.45)
    seed = whole(rng, 0, 199)
    if hall:
        ceiling = Material("beams", (0.55, 0.57, 0.6), lamp, (3.6, 5.4), seed)
    elif home:
        ceiling = Material("plain", (0.92, 0.92, 0.90), seed=seed)
    else:
        ceiling = Material("ceiling", (0.88, 0.88, 0.86), lamp, (0.6, 0.6), seed)
    return Style(
        height=HALL if hall else ROOM,
        floor=_floor(rng, hall, home),
        ceiling=ceiling,
        wall=wall,
        plaster=Material("plain", wall.colour),
        window=Material("window", sky, (0.62, 0.56, 0.52), seed=seed, glow=1.0),
        glass=Material("glass", (0.66, 0.72, 0.72), (0.3, 0.31, 0.33), seed=seed),
        door=Material("door", leaf, (0.22, 0.22, 0.23), (veined, float(chance(rng, 0.5))), seed),
        frame=Material("plain", frame),
        wood=pick(rng, WOODS),
        other_wood=pick(rng, WOODS),
        metal=pick(rng, ((0.62, 0.63, 0.64), (0.2, 0.2, 0.21), (0.8, 0.8, 0.8))),
        cloth=pick(rng, CLOTHS),
    )


def _wall(rng: np.random.Generator, frame: Colour, hall: bool, home: bool) -> Material:
    seed, paint = whole(rng, 0, 199), pick(rng, PAINTS)
    if hall or chance(rng, 0.06):
        return Material("bricks", (0.74, 0.73, 0.70), (0.6, 0.59, 0.57), (0.4, 0.2), seed)
    if not home and chance(rng, 0.25):
        return Material("two tone", paint, pick(rng, DADOS), (1.0, uniform(rng, 0.9, 1.3)), seed)
    return Material("wall", paint, frame, seed=seed)


def _floor(rng: np.random.Generator, hall: bool, home: bool) -> Material:
    seed, gloss = whole(rng, 0, 199), uniform(rng, 0.1, 0.4)
    if hall:
        return Material("concrete", (0.52, 0.52, 0.50), size=(4.2, 4.2), seed=seed, gloss=gloss / 2)
    wood = pick(rng, (OAK, BEECH, WALNUT, PINE))
    kinds = ("boards", "boards", "tiles", "herringbone") if home else ("carpet", "tiles", "boards", "lino")
    kind = pick(rng, kinds)
    if kind == "boards":
        size = uniform(rng, 0.9, 1.8), uniform(rng, 0.09, 0.19)
        return Material("boards", wood, size=size, seed=seed, gloss=gloss)
    if kind == "herringbone":
        return Material("herringbone", wood, size=(uniform(rng, 0.35, 0.5), 0.0), seed=seed, gloss=gloss)
    if kind == "tiles":
        side = uniform(rng, 0.3, 0.6)
        colour = pick(rng, ((0.72, 0.69, 0.64), (0.60, 0.60, 0.60), (0.80, 0.79, 0.76), (0.55, 0.42, 0.34)))
        return Material("tiles", colour, (0.42, 0.41, 0.40), (side, side), seed, gloss=gloss)
    if kind == "carpet":
        colour = pick(rng, ((0.36, 0.38, 0.42), (0.45, 0.42, 0.38), (0.30, 0.36, 0.44), (0.42, 0.30, 0.30)))
        return Material("carpet", colour, size=(0.5, 0.5), seed=seed)
    colour = pick(rng, ((0.62, 0.60, 0.55), (0.52, 0.56, 0.58), (0.66, 0.58, 0.48)))
    return Material("concrete", colour, size=(2.0, 100.0), seed=seed, gloss=gloss)
