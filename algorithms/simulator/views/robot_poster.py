"""A photograph of a robot, as large as life, to hang on a wall: who looks with a camera alone is taken in."""

from __future__ import annotations

from functools import lru_cache

from algorithms.common.pose import Pose2
from algorithms.sensors.camera import Camera
from algorithms.simulator.buildings.floor_plan import FloorPlan
from algorithms.simulator.portable_random import pick, radians, stream, uniform, whole
from algorithms.simulator.views.camera_image import render
from algorithms.simulator.views.light import Light
from algorithms.simulator.views.robot_body import TOPS, RobotBody
from algorithms.simulator.views.surfaces.materials import Picture
from algorithms.simulator.views.view_scene import ViewScene

VARIANTS = 8
DISTANCE, EYE = 2.2, 0.36  # metres; from the camera to the robot's face, and the camera's height
WIDTH, HEIGHT, FOCAL = 896, 672, 700.0  # pixels
MARGIN = 0.02  # metres of floor below the robot


@lru_cache(maxsize=VARIANTS)
def robot_picture(variant: int) -> tuple[Picture, float, float]:
    """A picture of a robot, its width and its height in metres at which the robot is as large as life."""
    rng = stream(variant, "robot poster")
    plan = FloorPlan(7.0, 5.0, 0.05)
    plan.outline(0.5, 0.5, 6.5, 4.5, 0.2)
    body = RobotBody(tags=(20, 21, 22, 23), top=pick(rng, TOPS))
    quarter = whole(rng, 0, 3)
    heading = quarter * 16384 + whole(rng, -3500, 3500)
    stands = Pose2(1.4 + DISTANCE + body.half_size, 2.5, radians(heading))
    light = Light(brightness=1.1, warmth=uniform(rng, -0.3, 0.5), blur=0.8, noise=1.0, vignetting=0.0)
    scene = ViewScene(plan.finish("office"), ((stands, body),), light=light, seed=variant)
    middle_u, middle_v = (WIDTH - 1) / 2, (HEIGHT - 1) / 2
    camera = Camera(WIDTH, HEIGHT, (FOCAL, FOCAL), (middle_u, middle_v))
    photo = render(scene, Pose2(1.4, 2.5, 0.0), camera, EYE, rng)
    scale = FOCAL / DISTANCE  # pixels per metre of what stands where the robot's face is
    width, height = uniform(rng, 0.65, 0.95), uniform(rng, 0.8, 1.1)
    left, foot = round(middle_u - width / 2 * scale), round(middle_v + (EYE + MARGIN) * scale)
    return photo[foot - round(height * scale) : foot, left : left + round(width * scale)], width, height
