"""Robots in mirrors: where they seem to stand, and how much of them is seen."""

from __future__ import annotations

import numpy as np

from algorithms.common.pose import Pose2, wrap_angle
from algorithms.sensors.camera import Camera
from algorithms.simulator.views.camera_image import camera_rays, eye_of, viewpoint
from algorithms.simulator.views.projection import MOST_RAYS, box_of, clipped
from algorithms.simulator.views.view_scene import Mirror, ViewScene


def reflected_pose(mirror: Mirror, pose: Pose2) -> Pose2:
    """Where a robot seems to stand that is seen in a mirror; the robot is its own mirror image."""
    nx, ny = mirror.normal().tolist()
    x, y = mirror.face()[:2].tolist()
    off = 2 * ((pose.x - x) * nx + (pose.y - y) * ny)
    along = float(np.arctan2(-nx, ny))
    return Pose2(pose.x - off * nx, pose.y - off * ny, wrap_angle(2 * along - pose.theta))


def reflection_seen(
    scene: ViewScene, mirror: int, robot: int, pose: Pose2, camera: Camera, camera_height: float
) -> tuple[Pose2, float]:
    """Where a robot in a mirror seems to stand, and roughly which share of it the image shows.

    mirror, robot : their numbers in the scene
    pose          : of the robot that looks, T_world_robot
    """
    stands, body = scene.robots[robot]
    image = reflected_pose(scene.mirrors[mirror], stands)
    view = viewpoint(pose, camera, camera_height)
    box = box_of(view, camera, body, image)
    if box is None:
        return image, 0.0
    u0, v0, u1, v1 = clipped(box, camera)
    if u1 - u0 < 1 or v1 - v0 < 1:
        return image, 0.0
    step = max(1, int(np.sqrt((u1 - u0) * (v1 - v0) / MOST_RAYS)))
    part = np.s_[int(v0) : int(v1) + 1 : step, int(u0) : int(u1) + 1 : step]
    rays = camera_rays(camera)
    eye = eye_of(scene, pose, camera, camera_height)
    traced = eye.trace(rays.right[part].ravel(), rays.down[part].ravel())
    seen = (eye.robots(traced) == robot) & (traced.mirror == mirror)
    filled = 0.85  # of the box around a robot, as a rule
    return image, min(1.0, float(seen.mean()) / filled)
