"""A bare room and a plain camera in it, for looking at robots."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from algorithms.common.pose import Pose2
from algorithms.sensors.camera import Camera
from algorithms.simulator.buildings.floor_plan import Building, FloorPlan
from algorithms.simulator.lidar import Lidar
from algorithms.simulator.portable_random import stream
from algorithms.simulator.views.camera_image import CameraImage, take_picture
from algorithms.simulator.views.light import Light
from algorithms.simulator.views.view_scene import ViewScene

HEIGHT = 0.35  # metres; of the camera
CAMERA = Camera(320, 240, (260.0, 260.0), (159.5, 119.5))
OBSERVER = Pose2(2.0, 4.0, 0.0)  # in the middle of the left half of the room, looking along x
STILL = Light(noise=0.0, blur=0.0, vignetting=0.0, uneven=0.0)
LASER = Lidar(beams=540, field=270.0, reach=9.0, noise=0.015, lost=0.0)


def bare_room(*walls: tuple[float, float, float, float]) -> Building:
    """A room from (0.6, 0.6) to (11.4, 7.4), with boxes of wall in it; metres."""
    plan = FloorPlan(12.0, 8.0, 0.025)
    plan.outline(0.5, 0.5, 11.5, 7.5, 0.2)
    for wall in walls:
        plan.box(*wall)
    return plan.finish("office")


def scene_with(*robots, building: Building | None = None, **more) -> ViewScene:
    more.setdefault("light", STILL)
    return ViewScene(building or bare_room(), tuple(robots), **more)


def seen(scene: ViewScene, observer: Pose2 = OBSERVER, camera: Camera = CAMERA, seed: int = 0) -> CameraImage:
    return take_picture(scene, observer, camera, HEIGHT, stream(seed, "sight"))


def extent(mask: np.ndarray) -> tuple[int, int, int, int]:
    """First column, first row, last column and last row of what is set."""
    rows, cols = np.flatnonzero(mask.any(axis=1)), np.flatnonzero(mask.any(axis=0))
    return int(cols[0]), int(rows[0]), int(cols[-1]), int(rows[-1])


def turned_on_the_spot(pose: Pose2, by: float) -> Pose2:
    return replace(pose, theta=pose.theta + by)
