"""Upright faces: walls, windows, doors, and what stands before them. u to the right, v up; metres."""

from __future__ import annotations

import numpy as np

from algorithms.simulator.views.surfaces.floor_patterns import from_edge, line
from algorithms.simulator.views.surfaces.materials import FacePoints, Material, mixed, painted
from algorithms.simulator.views.surfaces.noise import Tones, lattice, rough, smooth, whole_part

SKIRTING = 0.08  # metres
SILL, LINTEL = 0.1, 2.15  # metres; the frame of a window


def plain(material: Material, at: FacePoints) -> Tones:
    """Paint or plastic, hardly uneven."""
    return painted(material.colour, 0.97 + 0.06 * smooth(at.u * 5, at.v * 5, material.seed))


def picture(material: Material, at: FacePoints) -> Tones:
    """A picture that covers the face."""
    assert material.picture is not None
    rows, cols = material.picture.shape[:2]
    col = np.clip((at.u / at.width * cols).astype(np.int64), 0, cols - 1)
    row = np.clip(((1 - at.v / at.height) * rows).astype(np.int64), 0, rows - 1)
    return np.asarray(material.picture[row, col] * np.float32(1 / 255), dtype=np.float32)


def wall(material: Material, at: FacePoints) -> Tones:
    """Plaster with a skirting board in the accent's colour."""
    uneven = rough(at.u * 1.1, at.v * 1.1, material.seed) - 0.5
    grainy = lattice(whole_part(at.u * 150), whole_part(at.v * 150), material.seed) - 0.5
    scuffs = smooth(at.u * 2, at.v * 18, material.seed) * np.maximum(0.0, 0.5 - at.v)
    tone = 0.98 + 0.09 * uneven + 0.05 * grainy * at.sharpness(0.006) - 0.12 * scuffs
    board = np.asarray(at.v < SKIRTING, dtype=np.float32)
    edge = line(np.abs(at.v - SKIRTING), 0.004, at.grain)
    return mixed(painted(material.colour, tone), material.accent, board) * (1 - 0.35 * edge[:, None])


def two_tone(material: Material, at: FacePoints) -> Tones:
    """A wall that is painted in the accent's colour up to the height of a chair's back."""
    low = np.asarray(at.v < material.size[1], dtype=np.float32)
    upper = wall(Material("wall", material.colour, material.accent, seed=material.seed), at)
    lower = painted(material.accent, 0.95 + 0.1 * rough(at.u, at.v, material.seed))
    strip = line(np.abs(at.v - material.size[1]), 0.012, at.grain)
    return mixed(upper, lower, low) * (1 - 0.3 * strip[:, None])


def bricks(material: Material, at: FacePoints) -> Tones:
    """Blocks with joints in the accent's colour."""
    width, height = material.size
    row = whole_part(at.v / height)
    along = at.u + (row % 2) * (width / 2)
    own = lattice(whole_part(along / width), row, material.seed)
    uneven = rough(at.u * 9, at.v * 9, material.seed) - 0.5
    along = along.astype(np.float32)
    joints = np.maximum(
        line(from_edge(along, width), 0.005, at.grain), line(from_edge(at.v, height), 0.005, at.grain)
    )
    return mixed(painted(material.colour, 0.9 + 0.14 * own + 0.16 * uneven), material.accent, joints)


def window(material: Material, at: FacePoints) -> Tones:
    """A window down to the floor: frame, sky, and what stands outside in the accent's colour."""
    houses = 0.75 + 0.9 * lattice(whole_part(at.u * 1.4), 5, material.seed)
    bushes = 0.35 + 0.5 * rough(at.u * 2.2, at.u * 0.3, material.seed)
    sky = painted(material.colour, 0.9 + 0.1 * np.minimum(at.v, 2.5) / 2.5)
    outside = mixed(
        sky, painted(material.accent, 1.1 - 0.2 * lattice(whole_part(at.u * 1.4), 9)), (at.v < houses) * 1.0
    )
    green = rough(at.u * 12, at.v * 12, material.seed)
    leaves = np.stack([0.25 + 0.2 * green, 0.33 + 0.25 * green, 0.2 + 0.15 * green], axis=1)
    outside = mixed(outside, leaves, (at.v < bushes) * 1.0)
    side = np.minimum(at.u, at.width - at.u)
    frame = (
        (side < 0.05) | (at.v < SILL) | (np.abs(at.u - at.width / 2) < 0.02) | (np.abs(at.v - LINTEL) < 0.03)
    )
    above = at.v > LINTEL + 0.03
    white = painted((0.86, 0.86, 0.84), 0.95 + 0.05 * smooth(at.u * 3, at.v * 3))
    return np.where((frame | above)[:, None], white, outside)


def glass(material: Material, at: FacePoints) -> Tones:
    """Glass between rooms: milky, with streaks of what it reflects and a band so that nobody runs into it."""
    streaks = smooth((at.u + at.v * 0.4) * 1.1, at.v * 0.2, material.seed)
    ground = painted(material.colour, 0.7 + 0.45 * streaks)
    dots = (from_edge(at.u, 0.06) < 0.022) & (np.abs(at.v - 1.3) < 0.035)
    side = np.minimum(at.u, at.width - at.u)
    frame = (side < 0.03) | (at.v < 0.06) | (np.abs(at.v - 2.2) < 0.03)
    ground = mixed(ground, (0.95, 0.96, 0.96), dots * 0.7)
    return mixed(ground, material.accent, frame * 1.0)


def door(material: Material, at: FacePoints) -> Tones:
    """The leaf of a door: panels if its size says so, a handle, a plate against kicks."""
    veins = smooth(at.u * 45, at.v * 1.6, material.seed) - 0.5
    ground = painted(material.colour, 0.96 + material.size[0] * 0.22 * veins)
    if material.size[1] > 0:
        inset = np.minimum(np.minimum(at.u, at.width - at.u) - 0.13, from_edge(at.v + 0.35, 0.95) - 0.08)
        ground = ground * (1 - 0.3 * line(np.abs(inset), 0.008, at.grain))[:, None]
    handle = (np.abs(at.u - 0.09) < 0.02) & (np.abs(at.v - 1.05) < 0.1)
    handle |= (np.abs(at.u - 0.14) < 0.07) & (np.abs(at.v - 1.08) < 0.013)
    rim = line(np.minimum(at.u, at.width - at.u), 0.004, at.grain)
    return mixed(ground, material.accent, handle * 1.0) * (1 - 0.4 * rim[:, None])


def drawers(material: Material, at: FacePoints) -> Tones:
    """Fronts of drawers with a handle each."""
    rows = np.maximum(1, np.rint(at.height / material.size[1]))
    step = at.height / rows
    within = at.v - whole_part(at.v / step) * step
    gap = line(np.minimum(within, step - within), 0.003, at.grain)
    handle = (np.abs(within - step * 0.75) < 0.012) & (np.abs(at.u - at.width / 2) < at.width * 0.16)
    ground = painted(material.colour, 0.96 + 0.08 * smooth(at.u * 4, at.v * 4, material.seed))
    return mixed(ground, material.accent, handle * 1.0) * (1 - 0.55 * gap[:, None])


def cupboard(material: Material, at: FacePoints) -> Tones:
    """Doors beside one another, with handles at their meeting edges."""
    doors = np.maximum(1, np.rint(at.width / material.size[0]))
    step = at.width / doors
    leaf = whole_part(at.u / step)
    within = at.u - leaf * step
    gap = line(np.minimum(within, step - within), 0.003, at.grain)
    at_edge = np.where(leaf % 2 == 0, step - within, within)
    handle = (np.abs(at_edge - 0.045) < 0.009) & (np.abs(at.v - at.height * 0.55) < 0.08)
    veins = smooth(at.u * 30, at.v * 1.5, material.seed) - 0.5
    ground = painted(material.colour, 0.97 + 0.1 * veins)
    plinth = np.asarray(at.v < 0.07, dtype=np.float32)
    return mixed(ground, material.accent, handle * 1.0) * (1 - 0.55 * gap - 0.45 * plinth)[:, None]


def books(material: Material, at: FacePoints) -> Tones:
    """An open shelf: boards, books and binders of many colours, dark gaps."""
    step = material.size[1]
    row = whole_part(at.v / step)
    within = at.v - row * step
    shift = at.u + 0.013 * smooth(at.u * 9, row.astype(np.float32), material.seed)
    book = whole_part(shift / material.size[0])
    own, hue = lattice(book, row, material.seed), lattice(book, row, material.seed + 5)
    tall = step * (0.55 + 0.35 * own)
    stands = (within < tall) & (lattice(book // 7, row, material.seed + 3) > 0.18)
    bright = 0.25 + 0.5 * lattice(book, row, material.seed + 6)
    strong = 0.35 * lattice(book, row, material.seed + 7)
    tints = (hue - 0.4, 0.25 - np.abs(hue - 0.5), 0.4 - hue)
    palette = np.clip(np.stack([bright + strong * 2 * tint for tint in tints], axis=1), 0.05, 0.95)
    label = (np.abs(within - tall * 0.6) < 0.025) & (hue > 0.5)
    spine = np.where(label[:, None], np.float32(0.85), palette)
    edge = line(from_edge(shift.astype(np.float32), material.size[0]), 0.002, at.grain)
    spine = spine * (1 - 0.5 * edge[:, None])
    dark = painted(material.colour, np.full(len(at.u), 0.3, dtype=np.float32))
    inside = np.where(stands[:, None], spine, dark)
    side = np.minimum(at.u, at.width - at.u)
    board = (within < 0.022) | (side < 0.022) | (at.height - at.v < 0.022)
    return np.asarray(
        np.where(board[:, None], np.array(material.colour, dtype=np.float32), inside), dtype=np.float32
    )


def carton(material: Material, at: FacePoints) -> Tones:
    """Cardboard: tape down the middle, a label, something printed."""
    uneven = rough(at.u * 5, at.v * 5, material.seed) - 0.5
    ground = painted(material.colour, 0.95 + 0.14 * uneven)
    tape = np.abs(at.u - at.width / 2) < 0.025
    ground = mixed(ground, material.accent, tape * 0.45)
    label_u, label_v = at.u - at.width * 0.62, at.v - at.height * 0.55
    label = (label_u > 0) & (label_u < 0.12) & (label_v > 0) & (label_v < 0.08)
    text = (from_edge(label_v, 0.016) < 0.004) & (
        lattice(whole_part(label_u * 150), whole_part(label_v * 60)) > 0.3
    )
    ground = mixed(ground, (0.92, 0.92, 0.9), label * 1.0)
    ground = mixed(ground, (0.15, 0.15, 0.15), (label & text & (label_u > 0.01) & (label_u < 0.11)) * 0.9)
    print_u, print_v = at.u - at.width * 0.2, at.v - at.height * 0.3
    square = np.maximum(np.abs(print_u), np.abs(print_v))
    printed = ((square > 0.028) & (square < 0.036)) | ((np.abs(print_u) < 0.006) & (np.abs(print_v) < 0.02))
    ground = mixed(ground, (0.2, 0.16, 0.12), printed * 0.8)
    rim = np.minimum(np.minimum(at.u, at.width - at.u), np.minimum(at.v, at.height - at.v))
    return ground * (1 - 0.3 * line(rim, 0.004, at.grain))[:, None]


def fabric(material: Material, at: FacePoints) -> Tones:
    """Woven cloth with the seams of cushions."""
    thread = lattice(whole_part(at.u * 220), whole_part(at.v * 220), material.seed) - 0.5
    folds = rough(at.u * 3, at.v * 3, material.seed) - 0.5
    cushions = np.maximum(1, np.rint(at.width / material.size[0]))
    seam = line(from_edge(at.u / at.width * cushions, 1.0) * material.size[0], 0.008, at.grain)
    tone = 0.97 + 0.2 * folds + 0.14 * thread * at.sharpness(0.003)
    return painted(material.colour, tone * (1 - 0.35 * seam))


def leaf(material: Material, at: FacePoints) -> Tones:
    """Green with a vein."""
    return painted(material.colour, 0.75 + 0.5 * smooth(at.u * 40, at.v * 40, material.seed))


def stripes(material: Material, at: FacePoints) -> Tones:
    """Warning stripes."""
    dark = from_edge(at.u + at.v, material.size[0]) < material.size[0] / 4
    ground = painted(material.colour, 0.96 + 0.06 * smooth(at.u * 9, at.v * 9))
    return mixed(ground, material.accent, dark * 1.0)
