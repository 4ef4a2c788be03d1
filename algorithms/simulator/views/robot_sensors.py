"""Cameras and lasers as robots carry them, drawn."""

from __future__ import annotations

import numpy as np

from algorithms.common.pose import Pose2
from algorithms.sensors.camera import Camera
from algorithms.simulator.lidar import Lidar
from algorithms.simulator.portable_random import pick, radians, ticks_of_degrees, uniform

WIDTH, HEIGHT = 640, 480  # pixels


def draw_camera(rng: np.random.Generator, focal_lengths: tuple[float, float] = (450.0, 620.0)) -> Camera:
    """A calibrated camera at a robot's front; focal lengths from … to in pixels."""
    focal, stretch = uniform(rng, *focal_lengths), uniform(rng, 0.995, 1.005)
    centre = WIDTH / 2 - 0.5 + uniform(rng, -8.0, 8.0), HEIGHT / 2 - 0.5 + uniform(rng, -8.0, 8.0)
    k_1 = uniform(rng, -0.25, 0.05)
    k_2 = k_1 * k_1 * uniform(rng, 0.5, 0.8)  # from 0.45 on no distortion folds back
    x, y = uniform(rng, 0.0, 0.15), uniform(rng, -0.05, 0.05)
    yaw = radians(ticks_of_degrees(uniform(rng, -5.0, 5.0)))
    distortion = (round(k_1, 5), round(k_2, 5), 0.0, 0.0)
    return Camera(
        WIDTH, HEIGHT, (round(focal, 3), round(focal * stretch, 3)),
        (round(centre[0], 3), round(centre[1], 3)), distortion,
        mounting=Pose2(round(x, 4), round(y, 4), round(yaw, 6)),
    )  # fmt: skip


def draw_lidar(rng: np.random.Generator) -> Lidar:
    beams, field = pick(rng, ((540, 270.0), (540, 270.0), (720, 360.0), (360, 360.0)))
    return Lidar(beams=beams, field=field, reach=uniform(rng, 6.0, 9.0), noise=uniform(rng, 0.012, 0.03))


def draw_mounting(rng: np.random.Generator) -> Pose2:
    """Of a laser, T_robot_laser."""
    return Pose2(round(uniform(rng, -0.1, 0.1), 4), 0.0, 0.0)


def draw_camera_height(rng: np.random.Generator) -> float:
    """Metres above the floor."""
    return uniform(rng, 0.25, 0.45)
