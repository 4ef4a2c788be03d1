"""The picture that a robot's camera takes of a scene."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from algorithms.common.pose import FloatArray, Pose2
from algorithms.sensors.camera import Camera
from algorithms.simulator.portable_random import METRE_GRID
from algorithms.simulator.views.interiors.wall_outlines import WallFaces
from algorithms.simulator.views.rendering.lens import developed
from algorithms.simulator.views.rendering.ray_casting import Hits, Index, RayCaster, Viewpoint
from algorithms.simulator.views.rendering.seen_points import seen_points
from algorithms.simulator.views.rendering.shading import Shading
from algorithms.simulator.views.solids import FRONT, NOBODY, ticks_of
from algorithms.simulator.views.surfaces.materials import Picture
from algorithms.simulator.views.surfaces.noise import Tones
from algorithms.simulator.views.view_scene import ViewScene

KNOT = 8  # pixels between the rays that the camera is asked for; those between lie on straight lines
REFLECTED = 0.92  # of the light that falls on a mirror
DIRECT = -1  # no mirror


@dataclass(frozen=True, eq=False)
class CameraRays:
    """(H, W) where the pixels of a camera look: to the right and down on the plane one metre ahead."""

    right: FloatArray
    down: FloatArray


@lru_cache(maxsize=8)
def camera_rays(camera: Camera) -> CameraRays:
    """The rays of a calibrated camera's pixels."""
    u = np.arange(-KNOT, camera.width + 2 * KNOT, KNOT, dtype=np.float64)
    v = np.arange(-KNOT, camera.height + 2 * KNOT, KNOT, dtype=np.float64)
    knots = camera.rays(np.stack(np.meshgrid(u, v), axis=-1).reshape(-1, 2)).reshape(len(v), len(u), 2)
    between = _between(_between(knots, camera.height).swapaxes(0, 1), camera.width).swapaxes(0, 1)
    return CameraRays(np.ascontiguousarray(between[..., 0]), np.ascontiguousarray(between[..., 1]))


def _between(knots: FloatArray, count: int) -> FloatArray:
    """Values at so many pixels from those at every KNOT-th, the first of which is pixel −KNOT; first axis.

    A parabola through the neighbours is added to the straight line: lenses bend lines evenly.
    """
    at = np.arange(count)
    n, share = at // KNOT + 1, ((at % KNOT) / KNOT)[:, None, None]
    low, high = knots[n], knots[n + 1]
    bend = (knots[n - 1] - low - high + knots[np.minimum(n + 2, len(knots) - 1)]) / 4
    return np.asarray(low + share * (high - low) - share * (1 - share) * bend)


@dataclass(frozen=True, eq=False)
class Traced:
    """What (n,) rays end at, mirrors seen through.

    mirror : number of the mirror they went by, or DIRECT
    """

    hits: Hits
    mirror: Index


@dataclass(frozen=True, eq=False)
class CameraImage:
    """A picture, and what it shows.

    image : (H, W, 3) uint8, red, green, blue
    robot : (H, W) number of the robot that a pixel shows, NOBODY where none; not in mirrors
    mirrored_robot : (H, W) the same for robots in mirrors
    """

    image: Picture
    robot: Index
    mirrored_robot: Index


def viewpoint(pose: Pose2, camera: Camera, height: float) -> Viewpoint:
    """The camera's, from the pose of its robot, T_world_robot."""
    T_world_camera = pose @ camera.mounting
    x, y = (round(at * METRE_GRID) / METRE_GRID for at in (T_world_camera.x, T_world_camera.y))
    return Viewpoint.looking(x, y, height, ticks_of(T_world_camera.theta))


class Eye:
    """Looks into a scene from one place.

    scene  : what there is
    view   : from where
    slopes : least and greatest a of all rays
    focal  : pixels per metre one metre ahead
    """

    def __init__(self, scene: ViewScene, view: Viewpoint, slopes: tuple[float, float], focal: float) -> None:
        self._scene, self._view, self._slopes, self._focal = scene, view, slopes, focal
        self._walls, self._solids = scene.interior.walls, scene.solids
        self._ceiling = scene.interior.style.height
        self._first_mirror = len(self._walls) + len(scene.interior.solids)
        self.shading = Shading(scene)
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
        for mirror in np.unique(traced.mirror).tolist():
            at = np.flatnonzero(traced.mirror == mirror)
            hits = traced.hits
            hits = Hits(hits.depth[at], hits.surface[at], hits.face[at])
            points = seen_points(
                self._views[mirror], self._walls, self._solids, self._ceiling, a[at], b[at], hits, self._focal
            )
            light = self.shading.light(points, hits, self.shading.material_of(hits))
            found[at] = light if mirror == DIRECT else light * np.float32(REFLECTED)
        return found

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


def _edges(key: NDArray[np.int64]) -> NDArray[np.bool_]:
    """(H, W) pixels that differ from a neighbour."""
    edge = np.zeros(key.shape, dtype=bool)
    across, up = key[:, 1:] != key[:, :-1], key[1:] != key[:-1]
    edge[:, 1:] |= across
    edge[:, :-1] |= across
    edge[1:] |= up
    edge[:-1] |= up
    return edge


def eye_of(scene: ViewScene, pose: Pose2, camera: Camera, camera_height: float) -> Eye:
    """Looks into a scene through a camera of the robot at a pose."""
    rays, (focal_x, focal_y) = camera_rays(camera), camera.focal or (1.0, 1.0)
    slopes = float(rays.right.min()) - 0.01, float(rays.right.max()) + 0.01
    return Eye(scene, viewpoint(pose, camera, camera_height), slopes, (focal_x + focal_y) / 2)


def take_picture(
    scene: ViewScene, pose: Pose2, camera: Camera, camera_height: float, rng: np.random.Generator
) -> CameraImage:
    """``render``, with what the pixels show."""
    rays, shape = camera_rays(camera), (camera.height, camera.width)
    eye = eye_of(scene, pose, camera, camera_height)
    a, b = rays.right.ravel(), rays.down.ravel()
    traced = eye.trace(a, b)
    material = eye.shading.material_of(traced.hits)
    key = (traced.hits.surface.astype(np.int64) * 8 + traced.hits.face) * 16 + traced.mirror
    fine = np.array([one.fine for one in eye.shading.materials])[material]
    several = np.flatnonzero(_edges(key.reshape(shape)).ravel() | fine)
    once = np.ones(len(a), dtype=bool)
    once[several] = False
    at = np.flatnonzero(once)
    light = np.empty((len(a), 3), dtype=np.float32)
    hits = Hits(traced.hits.depth[at], traced.hits.surface[at], traced.hits.face[at])
    light[at] = eye.light(a[at], b[at], Traced(hits, traced.mirror[at]))
    light[several] = _looked_at_in_four_places(eye, rays, several)
    robot = eye.robots(traced)
    direct = traced.mirror == DIRECT
    return CameraImage(
        developed(light.reshape(*shape, 3), scene.light, rng),
        np.where(direct, robot, NOBODY).reshape(shape),
        np.where(direct, NOBODY, robot).reshape(shape),
    )


def _looked_at_in_four_places(eye: Eye, rays: CameraRays, pixels: NDArray[np.int64]) -> Tones:
    """(n, 3) mean light of the four quarters of pixels."""
    (a_x, a_y), (b_x, b_y) = (
        (np.gradient(plane, axis=1).ravel()[pixels], np.gradient(plane, axis=0).ravel()[pixels])
        for plane in (rays.right, rays.down)
    )
    a, b = rays.right.ravel()[pixels], rays.down.ravel()[pixels]
    shifts = [(x, y) for y in (-0.25, 0.25) for x in (-0.25, 0.25)]
    a = np.concatenate([a + x * a_x + y * a_y for x, y in shifts])
    b = np.concatenate([b + x * b_x + y * b_y for x, y in shifts])
    light = eye.light(a, b, eye.trace(a, b)).reshape(4, len(pixels), 3)
    return np.asarray(np.minimum(light, 1.5).mean(axis=0), dtype=np.float32)


def render(
    scene: ViewScene, pose: Pose2, camera: Camera, camera_height: float, rng: np.random.Generator
) -> Picture:
    """What a camera sees.

    pose          : of the robot that it looks from, T_world_robot
    camera        : calibrated
    camera_height : metres above the floor
    rng           : draws the noise
    returns       : (H, W, 3) uint8; red, green, blue. The same bits on every machine
    """
    return take_picture(scene, pose, camera, camera_height, rng).image
