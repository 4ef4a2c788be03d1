"""Looking into a scene from one place: what rays end at, by way of mirrors too, and the light along them."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from algorithms.common.pose import FloatArray
from algorithms.simulator.views.interiors.wall_outlines import WallFaces
from algorithms.simulator.views.rendering.ray_casting import Hits, Index, RayCaster, Viewpoint
from algorithms.simulator.views.rendering.seen_points import seen_points
from algorithms.simulator.views.rendering.shading import SceneShading
from algorithms.simulator.views.solids import FRONT, NOBODY
from algorithms.simulator.views.surfaces.noise import Tones
from algorithms.simulator.views.view_scene import ViewScene

REFLECTED = 0.92  # of the light that falls on a mirror
DIRECT = -1  # no mirror


@dataclass(frozen=True, eq=False)
class Traced:
    """What (n,) rays end at, mirrors seen through.

    mirror : number of the mirror they went by, or DIRECT
    """

    hits: Hits
    mirror: Index


class Eye:
    """Looks into a scene from one place.

    scene  : what there is
    view   : from where
    slopes : least and greatest a of all rays
    focal  : pixels per metre one metre ahead
    """

    def __init__(self, scene: ViewScene, view: Viewpoint, slopes: tuple[float, float], focal: float) -> None:
        self._scene, self._view, self._slopes, self.focal = scene, view, slopes, focal
        self._walls, self._solids = scene.interior.walls, scene.solids
        self._ceiling = scene.interior.style.height
        self._first_mirror = len(self._walls) + len(scene.interior.solids)
        self.shading = SceneShading(scene)
        self.floor = scene.interior.style.floor
        self._casters = {DIRECT: RayCaster(view, self._walls, self._solids, self._ceiling, slopes)}
        self._views = {DIRECT: view}

    def trace(self, a: FloatArray, b: FloatArray) -> Traced:
        """Follow rays, by way of one mirror at most."""
        hits = self._casters[DIRECT].cast(a, b)
        mirror = np.full(len(a), DIRECT, dtype=np.int32)
        for n in range(len(self._scene.mirrors)):
            at = np.flatnonzero((hits.surface == self._first_mirror + n) & (hits.face == FRONT))
            if not len(at):
                continue
            self._look_into(n)
            behind = self._casters[n].cast(a[at], b[at], hits.depth[at] + 1e-6)
            hits.depth[at], hits.surface[at], hits.face[at] = behind.depth, behind.surface, behind.face
            mirror[at] = n
        return Traced(hits, mirror)

    def _look_into(self, n: int) -> None:
        if n not in self._casters:
            mirror = self._scene.mirrors[n]
            face = mirror.face()
            self._views[n] = self._view.reflected(float(face[0]), float(face[1]), mirror.normal())
            self._casters[n] = RayCaster(
                self._views[n], self._walls, self._solids, self._ceiling, self._slopes, face
            )

    def light(self, a: FloatArray, b: FloatArray, traced: Traced) -> Tones:
        """(n, 3) light that comes along rays."""
        found = np.empty((len(a), 3), dtype=np.float32)
        for mirror in self._views:
            at = np.flatnonzero(traced.mirror == mirror)
            if not len(at):
                continue
            hits = traced.hits
            hits = Hits(hits.depth[at], hits.surface[at], hits.face[at])
            points = seen_points(
                self._views[mirror], self._walls, self._solids, self._ceiling, a[at], b[at], hits, self.focal
            )
            light = self.shading.light(points, hits, self.shading.material_of(hits))
            found[at] = light if mirror == DIRECT else light * np.float32(REFLECTED)
        return found

    def on_floor(self, a: FloatArray, b: FloatArray) -> Tones:
        """(n, 3) light of what rays that meet the floor would show if the floor were a mirror."""
        below = replace(self._view, height=-self._view.height)
        caster = RayCaster(below, self._walls, self._solids, self._ceiling, self._slopes)
        hits = caster.cast(a, -b, self._view.height / b)
        points = seen_points(below, self._walls, self._solids, self._ceiling, a, -b, hits, self.focal)
        return self.shading.light(points, hits, self.shading.material_of(hits))

    def silhouette(self, robot: int, a: FloatArray, b: FloatArray) -> NDArray[np.bool_]:
        """(n,) which rays would end at a robot if nothing else were there."""
        nothing = WallFaces(np.zeros((0, 4)), np.zeros(0, dtype=np.uint8))
        own = self._solids.only(self._solids.robot == robot)
        caster = RayCaster(self._view, nothing, own, self._ceiling, self._slopes)
        return caster.cast(a, b).surface >= 0

    def robots(self, traced: Traced) -> Index:
        """(n,) which robot rays end at."""
        surface = traced.hits.surface
        on_solid = surface >= len(self._walls)
        found = np.full(len(surface), NOBODY, dtype=np.int32)
        found[on_solid] = self._solids.robot[surface[on_solid] - len(self._walls)]
        return found
