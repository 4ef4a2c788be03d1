"""Where in a camera's image points of the world appear, and how much of a robot is seen."""

from __future__ import annotations

import cv2
import numpy as np

from algorithms.common.pose import FloatArray, Pose2
from algorithms.sensors.camera import Camera
from algorithms.simulator.views.camera_image import camera_rays, eye_of, viewpoint
from algorithms.simulator.views.rendering.ray_casting import Viewpoint
from algorithms.simulator.views.robot_body import FRONT_BACK, SIDE, RobotBody
from algorithms.simulator.views.view_scene import ViewScene

NEAR = 0.1  # metres before the camera
MOST_RAYS = 6000  # that tell how much of a robot is seen

Box = tuple[float, float, float, float]  # u0, v0, u1, v1; pixels


def projected(view: Viewpoint, camera: Camera, points: FloatArray) -> FloatArray:
    """(N, 2) pixels (column, row) of (N, 3) points of the world in a calibrated camera; NaN behind it."""
    depth, right = view.seen_from(points[:, :2])
    before = depth > NEAR
    safe = np.where(before, depth, 1.0)
    plane = np.stack([right / safe, (view.height - points[:, 2]) / safe, np.ones(len(points))], axis=1)
    coefficients = np.array(camera.distortion) if camera.distortion else None
    seen, _ = cv2.projectPoints(plane, np.zeros(3), np.zeros(3), camera.matrix(), coefficients)
    return np.where(before[:, None], np.asarray(seen[:, 0], dtype=np.float64), np.nan)


def box_of(view: Viewpoint, camera: Camera, body: RobotBody, pose: Pose2) -> Box | None:
    """The box around a robot's projected corners, wherever it lies; None of what is not before the camera."""
    seen = projected(view, camera, body.corners(pose))
    if not np.isfinite(seen).all():
        return None
    (u0, v0), (u1, v1) = seen.min(axis=0).tolist(), seen.max(axis=0).tolist()
    return u0, v0, u1, v1


def clipped(box: Box, camera: Camera) -> Box:
    """The part of a box in the image; its sides may have met."""
    u0, v0, u1, v1 = box
    right, bottom = camera.width - 1.0, camera.height - 1.0
    return (
        min(max(u0, 0.0), right), min(max(v0, 0.0), bottom),
        min(max(u1, 0.0), right), min(max(v1, 0.0), bottom),
    )  # fmt: skip


def face_seen(view: Viewpoint, camera: Camera, body: RobotBody, pose: Pose2) -> str:
    """Which kind of board looks larger: FRONT_BACK or SIDE."""
    corners = body.footprint(pose)
    levels = [np.column_stack([corners, np.full(4, height)]) for height in (body.low, body.high)]
    low, high = (projected(view, camera, level) for level in levels)
    at = np.array([view.x, view.y])
    areas = {FRONT_BACK: 0.0, SIDE: 0.0}
    for n, kind in enumerate((SIDE, FRONT_BACK, SIDE, FRONT_BACK)):  # left, back, right, front
        a, b = corners[n], corners[(n + 1) % 4]
        if (b[0] - a[0]) * (at[1] - a[1]) - (b[1] - a[1]) * (at[0] - a[0]) >= 0:
            continue  # it looks away
        x, y = np.array([low[n], low[(n + 1) % 4], high[(n + 1) % 4], high[n]]).T
        area = abs(float((x * np.roll(y, -1) - y * np.roll(x, -1)).sum())) / 2
        areas[kind] += area if np.isfinite(area) else 0.0
    return max(areas, key=lambda kind: areas[kind])


def seen_share(
    scene: ViewScene, robot: int, pose: Pose2, camera: Camera, camera_height: float
) -> tuple[float, int]:
    """Of a robot's pixels in the image, the share that nothing hides; and about how many those are.

    robot : its number in the scene
    pose  : of the robot that looks, T_world_robot
    """
    stands, body = scene.robots[robot]
    view = viewpoint(pose, camera, camera_height)
    box = box_of(view, camera, body, stands)
    if box is None:
        return 0.0, 0
    u0, v0, u1, v1 = clipped(box, camera)
    if u1 - u0 < 1 or v1 - v0 < 1:
        return 0.0, 0
    step = max(1, int(np.sqrt((u1 - u0) * (v1 - v0) / MOST_RAYS)))
    part = np.s_[int(v0) : int(v1) + 1 : step, int(u0) : int(u1) + 1 : step]
    rays = camera_rays(camera)
    a, b = rays.right[part].ravel(), rays.down[part].ravel()
    eye = eye_of(scene, pose, camera, camera_height)
    alone = eye.silhouette(robot, a, b)
    if not alone.any():
        return 0.0, 0
    traced = eye.trace(a[alone], b[alone])
    seen = (eye.robots(traced) == robot) & (traced.mirror < 0)
    return float(seen.mean()), int(seen.sum()) * step * step
