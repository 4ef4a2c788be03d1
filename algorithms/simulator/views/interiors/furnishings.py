"""What stands on a floor plan, as solids: to a laser a desk is its legs, to a camera its top as well."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from algorithms.simulator.buildings.floor_plan import Piece
from algorithms.simulator.portable_random import TURN, chance, pick, uniform, whole
from algorithms.simulator.views.interiors.style import BLACK, WHITE, Style
from algorithms.simulator.views.solids import DRUM, EGG, Solid
from algorithms.simulator.views.surfaces.materials import Colour, Material

LEG = 0.06  # metres, as the floor plans have it
LEAF_HEIGHT = 2.03  # metres
BROWNS = ((0.66, 0.52, 0.36), (0.60, 0.47, 0.33), (0.72, 0.60, 0.44))

Parts = list[Solid]  # in the frame of the piece: x to its front


def _plain(colour: Colour) -> tuple[Material, ...]:
    return (Material("plain", colour),)


def _wood(colour: Colour, rng: np.random.Generator) -> Material:
    return Material("cupboard", colour, colour, (9.0, 1.0), whole(rng, 0, 199))


def _legs(piece: Piece, top: float, colour: Colour) -> Parts:
    a, b = (piece.depth - LEG) / 2, (piece.width - LEG) / 2
    return [Solid(x, y, LEG, LEG, 0.0, top, _plain(colour)) for x in (-a, a) for y in (-b, b)]


def desk(piece: Piece, style: Style, rng: np.random.Generator) -> Parts:
    """A top on legs, a panel behind, sometimes a screen on it."""
    top = uniform(rng, 0.68, 0.74)
    parts = _legs(piece, top, style.metal)
    parts.append(Solid(0, 0, piece.depth, piece.width, top, top + 0.03, (Material("plain", style.wood),)))
    if chance(rng, 0.3):
        parts.append(
            Solid(-piece.depth / 2 + 0.04, 0, 0.02, piece.width - 0.1, 0.35, top, _plain(style.wood))
        )
    if chance(rng, 0.7):
        y = uniform(rng, -0.25, 0.25)
        screen = Material("plain", (0.1, 0.13, 0.18))
        dark = Material("plain", BLACK)
        parts.append(Solid(-0.16, y, 0.2, 0.22, top + 0.03, top + 0.04, (dark,)))
        parts.append(Solid(-0.2, y, 0.03, 0.05, top + 0.04, top + 0.2, (dark,)))
        parts.append(
            Solid(-0.18, y, 0.03, 0.54, top + 0.13, top + 0.46, (screen, dark, dark, dark, dark, dark))
        )
    return parts


def drawers(piece: Piece, style: Style, rng: np.random.Generator) -> Parts:
    front = Material("drawers", style.other_wood, style.metal, (1.0, 0.16), whole(rng, 0, 199))
    side = Material("plain", style.other_wood)
    return [Solid(0, 0, piece.depth, piece.width, 0.02, 0.6, (front, front, side, side, side, side))]


def chair(piece: Piece, style: Style, rng: np.random.Generator) -> Parts:
    """Four legs, a seat, a back rest behind."""
    colour = pick(rng, (style.wood, style.other_wood, style.cloth, BLACK))
    seat = uniform(rng, 0.42, 0.47)
    parts = _legs(piece, seat, style.wood)
    parts.append(Solid(0, 0, piece.depth, piece.width, seat, seat + 0.03, _plain(colour)))
    back = -piece.depth / 2 + 0.02
    for y in (-piece.width / 2 + 0.025, piece.width / 2 - 0.025):
        parts.append(Solid(back, y, 0.04, 0.04, seat, seat + 0.45, _plain(style.wood)))
    parts.append(Solid(back, 0, 0.025, piece.width - 0.04, seat + 0.2, seat + 0.44, _plain(colour)))
    return parts


def office_chair(piece: Piece, style: Style, rng: np.random.Generator) -> Parts:
    """A star foot, a column, a padded seat and back."""
    cloth = (Material("fabric", style.cloth, size=(0.5, 1.0), seed=whole(rng, 0, 199)),)
    dark, foot = _plain(BLACK), piece.width + 0.2
    return [
        Solid(0, 0, foot, 0.05, 0.05, 0.09, dark, whole(rng, 0, TURN)),
        Solid(0, 0, foot, 0.05, 0.05, 0.09, dark, whole(rng, 0, TURN)),
        Solid(0, 0, piece.depth, piece.width, 0.06, 0.33, dark, shape=DRUM),
        Solid(0, 0, 0.06, 0.06, 0.09, 0.42, dark, shape=DRUM),
        Solid(0.02, 0, 0.46, 0.47, 0.42, 0.5, cloth),
        Solid(-0.22, 0, 0.05, 0.05, 0.45, 0.62, dark),
        Solid(-0.21, 0, 0.06, 0.43, 0.58, uniform(rng, 0.95, 1.15), cloth),
    ]


def cabinet(piece: Piece, style: Style, rng: np.random.Generator) -> Parts:
    """A cupboard, drawers or a shelf of books, low or high."""
    height = pick(rng, (0.75, 0.8, 1.2, 1.85, 2.0, 2.1))
    seed, wood = whole(rng, 0, 199), pick(rng, (style.wood, style.other_wood, WHITE))
    kind = pick(rng, ("books", "books", "cupboard", "cupboard", "drawers"))
    size = {"books": (uniform(rng, 0.028, 0.05), 0.34), "cupboard": (0.45, 1.0), "drawers": (1.0, 0.25)}[kind]
    front = Material(kind, wood, style.metal, size, seed)
    side = _wood(wood, rng)
    faces = (front, side, side, side, side, side)
    parts = [Solid(0, 0, piece.depth, piece.width, 0.0, height, faces)]
    if height < 1.3 and chance(rng, 0.5):
        parts += _on_top(piece, height, style, rng)
    return parts


def _on_top(piece: Piece, height: float, style: Style, rng: np.random.Generator) -> Parts:
    """Something that stands on a low cupboard."""
    y = uniform(rng, -0.3, 0.3) * piece.width
    if chance(rng, 0.4):
        return [
            Solid(0, y, 0.18, 0.18, height, height + 0.16, _plain((0.75, 0.45, 0.32)), shape=DRUM),
            *_foliage(0.0, y, height + 0.3, 0.16, rng),
        ]
    if chance(rng, 0.5):
        case = _plain(pick(rng, (BLACK, WHITE, (0.4, 0.42, 0.45))))
        return [Solid(0, y, min(0.34, piece.depth), 0.42, height, height + 0.28, case)]
    box = Material("carton", pick(rng, BROWNS), (0.8, 0.75, 0.62), seed=whole(rng, 0, 199))
    return [Solid(0, y, min(0.3, piece.depth), 0.36, height, height + uniform(rng, 0.2, 0.35), (box,))]


def sofa(piece: Piece, style: Style, rng: np.random.Generator) -> Parts:
    cloth = (Material("fabric", style.cloth, size=(0.75, 1.0), seed=whole(rng, 0, 199)),)
    arm, back = 0.16, uniform(rng, 0.72, 0.88)
    parts = [
        Solid(0, 0, piece.depth, piece.width, 0.04, 0.42, cloth),
        Solid(-piece.depth / 2 + 0.1, 0, 0.2, piece.width, 0.42, back, cloth),
    ]
    for y in (-(piece.width - arm) / 2, (piece.width - arm) / 2):
        parts.append(Solid(0, y, piece.depth, arm, 0.42, 0.6, cloth))
    return parts


def bed(piece: Piece, style: Style, rng: np.random.Generator) -> Parts:
    cover = (Material("fabric", pick(rng, (style.cloth, WHITE, (0.6, 0.66, 0.74))), size=(3.0, 1.0)),)
    long = piece.width > piece.depth
    head = Solid(0, -piece.width / 2 + 0.03, piece.depth, 0.06, 0, 0.95, _plain(style.wood)) if long else None
    head = head or Solid(-piece.depth / 2 + 0.03, 0, 0.06, piece.width, 0, 0.95, _plain(style.wood))
    return [
        Solid(0, 0, piece.depth, piece.width, 0.06, 0.3, _plain(style.wood)),
        Solid(0, 0, piece.depth - 0.04, piece.width - 0.04, 0.3, 0.52, cover),
        head,
    ]


def table(piece: Piece, style: Style, rng: np.random.Generator) -> Parts:
    top = uniform(rng, 0.7, 0.75)
    board = Solid(0, 0, piece.depth + 0.04, piece.width + 0.04, top, top + 0.035, _plain(style.other_wood))
    return [*_legs(piece, top, style.other_wood), board]


def carton(piece: Piece, style: Style, rng: np.random.Generator) -> Parts:
    seed, height = whole(rng, 0, 199), uniform(rng, 0.3, 0.65)
    face = Material("carton", pick(rng, (*BROWNS, WHITE)), (0.80, 0.74, 0.60), seed=seed)
    return [Solid(0, 0, piece.depth, piece.width, 0.0, height, (face,))]


def plant(piece: Piece, style: Style, rng: np.random.Generator) -> Parts:
    """A plant in a pot, or a bin."""
    if chance(rng, 0.4):
        colour = pick(rng, ((0.3, 0.31, 0.33), (0.62, 0.63, 0.64), (0.2, 0.32, 0.45), BLACK))
        height = uniform(rng, 0.45, 0.75)
        return [
            Solid(0, 0, piece.depth, piece.width, 0.0, height, _plain(colour), shape=DRUM),
            Solid(
                0, 0, piece.depth * 0.8, piece.width * 0.8, height, height + 0.01, _plain(BLACK), shape=DRUM
            ),
        ]
    colour = pick(rng, ((0.62, 0.38, 0.27), WHITE, (0.25, 0.26, 0.28), (0.5, 0.46, 0.4)))
    rim = uniform(rng, 0.36, 0.46)
    return [
        Solid(0, 0, piece.depth, piece.width, 0.0, rim, _plain(colour), shape=DRUM),
        Solid(0, 0, 0.04, 0.04, rim, rim + 0.4, _plain((0.36, 0.27, 0.18)), shape=DRUM),
        *_foliage(0.0, 0.0, rim + uniform(rng, 0.35, 0.6), uniform(rng, 0.26, 0.36), rng),
    ]


def _foliage(x: float, y: float, height: float, radius: float, rng: np.random.Generator) -> Parts:
    """Leaves around a middle."""
    greens = [Material("leaf", (0.14 + 0.1 * k, 0.32 + 0.08 * k, 0.12 + 0.05 * k), seed=k) for k in range(3)]
    leaves = []
    for _ in range(26):
        up, out = uniform(rng, -1.0, 1.0), uniform(rng, 0.3, 1.0)
        size = radius * uniform(rng, 0.35, 0.6)
        leaf = Solid(
            radius * 0.7 * out, 0, size, size * 0.45, height + up * radius - size * 0.2,
            height + up * radius + size * 0.25, (pick(rng, greens),), shape=EGG,
        )  # fmt: skip
        leaves.append(leaf.moved(x, y, whole(rng, 0, TURN - 1)))
    return leaves


def door_leaf(piece: Piece, style: Style, rng: np.random.Generator) -> Parts:
    rim = style.frame
    faces = (style.door, style.door, rim, rim, rim, rim)
    return [Solid(0, 0, piece.depth, piece.width, 0.01, LEAF_HEIGHT, faces)]


def recess(piece: Piece, style: Style, rng: np.random.Generator) -> Parts:
    """A closed door at the back of its recess, and the wall above it."""
    leaf = Solid(-piece.depth / 2, 0, 0.02, piece.width, 0.0, LEAF_HEIGHT, (style.door,))
    above = Solid(-0.004, 0, piece.depth, piece.width, LEAF_HEIGHT, style.height, (style.plaster,))
    sides = [
        Solid(-0.01, y, piece.depth, 0.05, 0.0, LEAF_HEIGHT, (style.frame,))
        for y in (-piece.width / 2 - 0.01, piece.width / 2 + 0.01)
    ]
    return [leaf, above, *sides]


def pillar(piece: Piece, style: Style, rng: np.random.Generator) -> Parts:
    return [Solid(0, 0, piece.depth, piece.width, 0.0, style.height, (style.wall,), shape=DRUM)]


def square_pillar(piece: Piece, style: Style, rng: np.random.Generator) -> Parts:
    grey = Material("plain", (0.6, 0.6, 0.58))
    bands = Material("stripes", (0.9, 0.75, 0.1), BLACK, (0.3, 1.0))
    return [
        Solid(0, 0, piece.depth, piece.width, 0.0, style.height, (grey,)),
        Solid(0, 0, piece.depth + 0.01, piece.width + 0.01, 0.0, 1.0, (bands,)),
    ]


def guard(piece: Piece, style: Style, rng: np.random.Generator) -> Parts:
    bands = Material("stripes", (0.92, 0.78, 0.1), BLACK, (0.25, 1.0))
    return [Solid(0, 0, piece.depth, piece.width, 0.0, uniform(rng, 0.6, 1.1), (bands,), shape=DRUM)]


def pallet(piece: Piece, style: Style, rng: np.random.Generator) -> Parts:
    """Goods on a pallet, and more in the storey above."""
    wood, parts = Material("plain", (0.62, 0.48, 0.32)), []
    for floor in (0.0, 1.75, 3.2):
        if floor and chance(rng, 0.25):
            continue
        kind = pick(rng, ("carton", "carton", "drawers"))
        colour = pick(rng, (*BROWNS, (0.78, 0.80, 0.80), (0.32, 0.40, 0.52)))
        goods = Material(kind, colour, (0.80, 0.74, 0.60), (1.0, uniform(rng, 0.2, 0.4)), whole(rng, 0, 199))
        top = floor + uniform(rng, 0.7, 1.35)
        parts.append(Solid(0, 0, piece.depth, piece.width, floor, floor + 0.13, (wood,)))
        parts.append(Solid(0, 0, piece.depth - 0.03, piece.width - 0.03, floor + 0.13, top, (goods,)))
    return parts


def rack(piece: Piece, style: Style, rng: np.random.Generator) -> Parts:
    """Posts and beams; what lies on them are pallets of their own. Its bays follow one another along y."""
    bay, post = 2.7, 0.1
    blue, orange = _plain((0.15, 0.27, 0.48)), _plain((0.85, 0.42, 0.12))
    parts, first = [], -piece.width / 2
    for x in (-(piece.depth - post) / 2, (piece.depth - post) / 2):
        for n in range(round((piece.width - post) / bay) + 1):
            parts.append(Solid(x, first + n * bay + post / 2, post, post, 0.0, 4.2, blue))
        for level in (1.63, 3.08):
            parts.append(Solid(x, 0, 0.05, piece.width, level, level + 0.12, orange))
    return parts


SOLIDS: dict[str, Callable[[Piece, Style, np.random.Generator], Parts]] = {
    "desk": desk,
    "drawers": drawers,
    "chair": chair,
    "office chair": office_chair,
    "cabinet": cabinet,
    "sofa": sofa,
    "bed": bed,
    "table": table,
    "carton": carton,
    "plant": plant,
    "door leaf": door_leaf,
    "recess": recess,
    "pillar": pillar,
    "square pillar": square_pillar,
    "guard": guard,
    "pallet": pallet,
    "rack": rack,
}
"""What the pieces of floor plans look like, by their kind."""


def stands(piece: Piece, style: Style, rng: np.random.Generator) -> Parts:
    """The solids of a piece where it stands in the world; none of a kind that has no looks."""
    if piece.kind not in SOLIDS:
        return []
    return [part.moved(piece.x, piece.y, piece.ticks) for part in SOLIDS[piece.kind](piece, style, rng)]
