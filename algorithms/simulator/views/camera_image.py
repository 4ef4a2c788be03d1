"""The picture that a robot's camera takes of a scene."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from algorithms.common.pose import FloatArray, Pose2
from algorithms.sensors.camera import Camera
from algorithms.simulator.portable_random import METRE_GRID
from algorithms.simulator.views.rendering.eye import DIRECT, Eye, Traced
from algorithms.simulator.views.rendering.gloss import with_gloss
from algorithms.simulator.views.rendering.lens import developed
from algorithms.simulator.views.rendering.ray_casting import Hits, Index, Viewpoint
from algorithms.simulator.views.solids import NOBODY, ticks_of
from algorithms.simulator.views.surfaces.materials import Picture
from algorithms.simulator.views.surfaces.noise import Tones
from algorithms.simulator.views.view_scene import ViewScene

FINEST = 0.002  # metres; of what is printed on boards and pictures, nothing is finer
KNOT = 8  # pixels between the rays that the camera is asked for; those between lie on straight lines


@dataclass(frozen=True, eq=False)
class CameraRays:
    """(H, W) where the pixels of a camera look: to the right and down on the plane one metre ahead."""

    right: FloatArray
    down: FloatArray


@lru_cache(maxsize=8)
def camera_rays(camera: Camera) -> CameraRays:
    """The rays of a calibrated camera's pixels."""
    u, v = (np.arange(0.0, size + KNOT - 1, KNOT) for size in (camera.width, camera.height))
    knots = camera.rays(np.stack(np.meshgrid(u, v), axis=-1).reshape(-1, 2)).reshape(len(v), len(u), 2)
    between = _between(_between(knots, camera.height).swapaxes(0, 1), camera.width).swapaxes(0, 1)
    return CameraRays(np.ascontiguousarray(between[..., 0]), np.ascontiguousarray(between[..., 1]))


def _between(knots: FloatArray, count: int) -> FloatArray:
    """Values at so many pixels from those at every KNOT-th; first axis.

    A parabola through the neighbours is added to the straight line: lenses bend lines evenly.
    """
    before, after = (3 * k[0] - 3 * k[1] + k[2] for k in (knots, knots[::-1]))
    knots = np.concatenate([before[None], knots, after[None]])
    at = np.arange(count)
    n, share = at // KNOT + 1, ((at % KNOT) / KNOT)[:, None, None]
    low, high = knots[n], knots[n + 1]
    bend = (knots[n - 1] - low - high + knots[np.minimum(n + 2, len(knots) - 1)]) / 4
    return np.asarray(low + share * (high - low) - share * (1 - share) * bend)


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
    fine &= traced.hits.depth > FINEST * eye.focal
    several = np.flatnonzero(_edges(key.reshape(shape)).ravel() | fine)
    once = np.ones(len(a), dtype=bool)
    once[several] = False
    at = np.flatnonzero(once)
    light = np.empty((len(a), 3), dtype=np.float32)
    hits = Hits(traced.hits.depth[at], traced.hits.surface[at], traced.hits.face[at])
    light[at] = eye.light(a[at], b[at], Traced(hits, traced.mirror[at]))
    light[several] = _looked_at_in_four_places(eye, rays, several)
    light = with_gloss(eye, rays.right, rays.down, traced, light.reshape(*shape, 3))
    robot = eye.robots(traced)
    direct = traced.mirror == DIRECT
    return CameraImage(
        developed(light, scene.light, rng),
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
