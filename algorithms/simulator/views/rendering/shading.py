"""The colours of seen points: their materials' patterns in the light of the scene."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from algorithms.simulator.portable_random import cosine, sine
from algorithms.simulator.views.rendering.ray_casting import CEILING, FLOOR, Hits, Index
from algorithms.simulator.views.rendering.seen_points import SeenPoints
from algorithms.simulator.views.solids import Solid
from algorithms.simulator.views.surfaces.materials import FacePoints, Material
from algorithms.simulator.views.surfaces.noise import Tones, smooth
from algorithms.simulator.views.surfaces.patterns import PATTERNS
from algorithms.simulator.views.view_scene import ViewScene

LAMPS_APART = 2.4  # metres
SHADOW = 0.3  # metres; how far the shadow of a thing reaches


class SceneShading:
    """Colours of points of one scene.

    scene     : what there is
    materials : all of them, the building's first
    """

    def __init__(self, scene: ViewScene) -> None:
        interior = scene.interior
        self._scene = scene
        self._walls = len(interior.walls)
        self._first_solid = len(interior.materials)
        self.materials: tuple[Material, ...] = interior.materials + scene.solids.materials
        self._shadows = scene.shadows()

    def material_of(self, hits: Hits) -> Index:
        """(n,) rows of ``materials``."""
        solids, surface = self._scene.solids, hits.surface
        found = np.where(surface == FLOOR, 0, 1).astype(np.int32)
        wall = (surface >= 0) & (surface < self._walls)
        found[wall] = self._scene.interior.wall_material[surface[wall]]
        solid = surface >= self._walls
        found[solid] = self._first_solid + solids.faces[surface[solid] - self._walls, hits.face[solid]]
        return found

    def light(self, points: SeenPoints, hits: Hits, material: Index) -> Tones:
        """(n, 3) light that comes from points: 1 is white in good light."""
        own = np.empty((len(material), 3), dtype=np.float32)
        falling = self._falling(points, hits)
        order = np.argsort(material, kind="stable")
        cuts = np.flatnonzero(np.diff(material[order])) + 1
        for part in np.split(order, cuts):
            if len(part):
                self._one(self.materials[int(material[part[0]])], points, part, own, falling)
        return own * falling[:, None]

    def _one(
        self, material: Material, points: SeenPoints, part: NDArray[np.int64], own: Tones, falling: Tones
    ) -> None:
        """Fill in the colours of the points of one material, and the light of what shines itself."""
        at = FacePoints(
            points.u[part], points.v[part], points.width[part], points.height[part], points.grain[part]
        )
        colour = PATTERNS[material.pattern](material, at)
        own[part] = colour * colour  # colours are as a screen shows them, light adds up
        if material.glow:
            falling[part] += material.glow * (np.float32(self._scene.light.outside) - falling[part])

    def _falling(self, points: SeenPoints, hits: Hits) -> Tones:
        """(n,) light that falls on points."""
        light, interior = self._scene.light, self._scene.interior
        nx, ny, nz = points.normal
        towards = nx * np.float32(cosine(light.direction)) + ny * np.float32(sine(light.direction))
        falling = 0.8 + 0.2 * nz + np.float32(0.45 * light.side) * towards
        falling *= np.where((nz < -0.5) & (hits.surface != CEILING), np.float32(0.5), np.float32(1.0))
        lamps = smooth(points.x / LAMPS_APART, points.y / LAMPS_APART, 7)
        falling *= 1 + np.float32(light.uneven) * (2 * lamps - 1)
        shade = interior.shade_at(points.x, points.y)
        floor = hits.surface == FLOOR
        corner = 1 - 0.5 * np.maximum(0, shade - np.float32(0.5))
        foot = np.maximum(0, 1 - points.z / np.float32(0.35))
        falling *= np.where(floor, 1 - np.float32(0.8) * shade, corner * (1 - np.float32(0.3) * foot * foot))
        for caster in self._shadows:
            self._shadow(caster, points, floor, falling)
        return np.asarray(falling * np.float32(light.brightness), dtype=np.float32)

    @staticmethod
    def _shadow(caster: Solid, points: SeenPoints, floor: NDArray[np.bool_], falling: Tones) -> None:
        """Darken the floor around and under a thing."""
        reach = np.float32((caster.depth + caster.width) / 2 + SHADOW)
        near = (
            floor
            & (np.abs(points.x - np.float32(caster.x)) < reach)
            & (np.abs(points.y - np.float32(caster.y)) < reach)
        )
        at = np.flatnonzero(near)
        c, s = np.float32(cosine(caster.ticks)), np.float32(sine(caster.ticks))
        x, y = points.x[at] - np.float32(caster.x), points.y[at] - np.float32(caster.y)
        along = np.maximum(0, np.abs(c * x + s * y) - np.float32(caster.depth / 2))
        across = np.maximum(0, np.abs(c * y - s * x) - np.float32(caster.width / 2))
        share = np.maximum(0, 1 - np.sqrt(along * along + across * across) / np.float32(SHADOW))
        falling[at] *= 1 - np.float32(0.75) * share * share
