"""The table of patterns: what a material's name means."""

from __future__ import annotations

from collections.abc import Callable

from algorithms.simulator.views.surfaces import face_patterns, floor_patterns
from algorithms.simulator.views.surfaces.materials import FacePoints, Material
from algorithms.simulator.views.surfaces.noise import Tones

PATTERNS: dict[str, Callable[[Material, FacePoints], Tones]] = {
    "plain": face_patterns.plain,
    "picture": face_patterns.picture,
    "wall": face_patterns.wall,
    "two tone": face_patterns.two_tone,
    "bricks": face_patterns.bricks,
    "window": face_patterns.window,
    "glass": face_patterns.glass,
    "door": face_patterns.door,
    "drawers": face_patterns.drawers,
    "cupboard": face_patterns.cupboard,
    "books": face_patterns.books,
    "carton": face_patterns.carton,
    "fabric": face_patterns.fabric,
    "leaf": face_patterns.leaf,
    "stripes": face_patterns.stripes,
    "boards": floor_patterns.boards,
    "herringbone": floor_patterns.herringbone,
    "tiles": floor_patterns.tiles,
    "carpet": floor_patterns.carpet,
    "concrete": floor_patterns.concrete,
    "ceiling": floor_patterns.ceiling,
    "beams": floor_patterns.beams,
    "mirror": face_patterns.plain,  # of a mirror in a mirror, which nobody follows further
}
"""Each makes (n, 3) colours, 0 … 1 and beyond where it shines, of the points of faces."""
