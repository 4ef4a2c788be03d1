"""Floors and ceilings: boards, tiles, carpet, concrete, lamps. u and v are world x and y; metres."""

from __future__ import annotations

import numpy as np

from algorithms.simulator.views.surfaces.materials import FacePoints, Material, mixed, painted
from algorithms.simulator.views.surfaces.noise import Tones, lattice, rough, smooth, whole_part


def line(distance: Tones, half_width: float, grain: Tones) -> Tones:
    """How much of a pixel a line covers whose middle is so far away, in [0, 1]; metres."""
    fine = np.maximum(grain, 1e-4)
    near = np.clip((half_width - distance) / fine + 0.5, 0.0, 1.0)
    return np.asarray(near * np.minimum(1.0, 2 * half_width / fine), dtype=np.float32)


def from_edge(x: Tones, size: float) -> Tones:
    """Distance to the nearest whole multiple of a size."""
    share = x / size - np.floor(x / size)
    return np.asarray(np.minimum(share, 1 - share) * size, dtype=np.float32)


def boards(material: Material, at: FacePoints) -> Tones:
    """Wooden boards, each of its own tone."""
    long, wide = (at.u, at.v) if material.seed % 2 else (at.v, at.u)
    length, width = material.size
    row = whole_part(wide / width)
    along = long + lattice(row, 3, material.seed) * length
    own = lattice(whole_part(along / length), row, material.seed)
    veins = smooth(along * 2.5 + own * 40, wide * 55, material.seed) - 0.5
    tone = 0.84 + 0.26 * own + 0.16 * veins * at.sharpness(0.015)
    gaps = np.maximum(
        line(from_edge(wide, width), 0.002, at.grain), line(from_edge(along, length), 0.002, at.grain)
    )
    return painted(material.colour, tone * (1 - 0.55 * gaps))


def herringbone(material: Material, at: FacePoints) -> Tones:
    """Short boards laid in squares, turned from square to square."""
    side = material.size[0]
    i, j = whole_part(at.u / side), whole_part(at.v / side)
    turned = (i + j) % 2 == 0
    long, wide = np.where(turned, at.u, at.v), np.where(turned, at.v, at.u)
    strip = whole_part(wide / (side / 5))
    own = lattice(strip + 7 * i, j + 13 * i, material.seed)
    veins = smooth(long * 3 + own * 40, wide * 60, material.seed) - 0.5
    tone = 0.84 + 0.24 * own + 0.14 * veins * at.sharpness(0.015) + np.where(turned, 0.03, -0.03)
    gaps = np.maximum(
        line(from_edge(wide, side / 5), 0.0015, at.grain), line(from_edge(long, side), 0.0015, at.grain)
    )
    return painted(material.colour, tone * (1 - 0.5 * gaps))


def tiles(material: Material, at: FacePoints) -> Tones:
    """Tiles with joints in the accent's colour."""
    width, height = material.size
    own = lattice(whole_part(at.u / width), whole_part(at.v / height), material.seed)
    marbled = rough(at.u * 4 + own * 50, at.v * 4, material.seed) - 0.5
    tone = 0.95 + 0.07 * own + 0.12 * marbled * at.sharpness(0.1)
    joints = np.maximum(
        line(from_edge(at.u, width), 0.003, at.grain), line(from_edge(at.v, height), 0.003, at.grain)
    )
    return mixed(painted(material.colour, tone), material.accent, joints)


def carpet(material: Material, at: FacePoints) -> Tones:
    """Carpet, in squares where its size is small."""
    width, height = material.size
    square = lattice(whole_part(at.u / width), whole_part(at.v / height), material.seed)
    pile = lattice(whole_part(at.u * 130), whole_part(at.v * 130), material.seed) - 0.5
    worn = rough(at.u * 0.8, at.v * 0.8, material.seed) - 0.5
    tone = 0.95 + 0.1 * (square - 0.5) + 0.16 * worn + 0.5 * pile * at.sharpness(0.008)
    return painted(material.colour, tone)


def concrete(material: Material, at: FacePoints) -> Tones:
    """Poured floor with blotches, scratches, and joints far apart."""
    blotches = rough(at.u * 0.6, at.v * 0.6, material.seed) - 0.5
    spots = lattice(whole_part(at.u * 60), whole_part(at.v * 60), material.seed) - 0.5
    scratches = smooth(at.u * 1.3 + at.v * 9, at.v * 1.3 - at.u * 0.4, material.seed) - 0.5
    tone = 0.97 + 0.3 * blotches + 0.1 * spots * at.sharpness(0.02) + 0.07 * scratches
    width, height = material.size
    joints = np.maximum(
        line(from_edge(at.u, width), 0.004, at.grain), line(from_edge(at.v, height), 0.004, at.grain)
    )
    return painted(material.colour, tone * (1 - 0.5 * joints))


def ceiling(material: Material, at: FacePoints) -> Tones:
    """Panels, and between them square lamps in the accent's colour, every fourth and third panel."""
    side = material.size[0]
    i, j = whole_part(at.u / side), whole_part(at.v / side)
    holes = lattice(whole_part(at.u * 90), whole_part(at.v * 90), material.seed) > 0.85
    tone = 0.97 + 0.04 * lattice(i, j, material.seed) - 0.12 * holes * at.sharpness(0.012)
    joints = np.maximum(
        line(from_edge(at.u, side), 0.008, at.grain), line(from_edge(at.v, side), 0.008, at.grain)
    )
    lamps = ((i + material.seed) % 4 == 1) & ((j + material.seed) % 3 == 1) & (joints < 0.5)
    panels = painted(material.colour, tone * (1 - 0.22 * joints))
    return np.where(lamps[:, None], np.array(material.accent, dtype=np.float32), panels)


def beams(material: Material, at: FacePoints) -> Tones:
    """A hall's roof: ribbed sheet, girders, and long lamps in the accent's colour."""
    ribs = 0.9 + 0.1 * (from_edge(at.u, 0.25) > 0.06)
    girder = line(from_edge(at.v, material.size[1]), 0.12, at.grain)
    lamps = (from_edge(at.u, material.size[0]) < 0.08) & (from_edge(at.v + 1.0, 2.4) > 0.35)
    roof = painted(material.colour, ribs.astype(np.float32) * (1 - 0.4 * girder))
    return np.where(lamps[:, None], np.array(material.accent, dtype=np.float32), roof)
