"""Where a view is set up: who looks from where, and places for what there is to see."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from algorithms.common.pose import Pose2
from algorithms.sensors.camera import Camera
from algorithms.simulator.buildings.floor_plan import Building
from algorithms.simulator.lidar import sees
from algorithms.simulator.portable_random import (
    TURN,
    chance,
    cosine,
    pick,
    radians,
    sine,
    snap,
    uniform,
    whole,
)
from algorithms.simulator.views.camera_image import viewpoint
from algorithms.simulator.views.clutter import draw_posters, draw_things
from algorithms.simulator.views.interiors.free_floor import FreeFloor, free_floor
from algorithms.simulator.views.light import Light
from algorithms.simulator.views.projection import box_of, seen_share
from algorithms.simulator.views.robot_body import CREAM, TOPS, WHITE, RobotBody
from algorithms.simulator.views.solids import ticks_of
from algorithms.simulator.views.view_scene import ViewScene

ROOM_TO_STAND = 0.35  # metres from walls, of who looks
UNCLUTTERED = 0.5  # metres around the middle of a robot in which nothing else is
RIM = 2.0  # pixels that a whole robot stays away from the left and the right edge


@dataclass(frozen=True, eq=False)
class Staged:
    """A scene, and who looks at it, T_world_observer."""

    scene: ViewScene
    observer: Pose2


@dataclass(frozen=True, eq=False)
class Stage:
    """A building and the sensors of the robot that looks.

    seed          : of the building's style
    camera_height : metres
    distance      : from … to, of the robot that is looked at; metres
    """

    building: Building
    seed: int
    camera: Camera
    camera_height: float
    distance: tuple[float, float]
    light: Light

    @property
    def floor(self) -> FreeFloor:
        return free_floor(self.building)

    def observer(self, rng: np.random.Generator) -> Pose2 | None:
        """Somebody who looks anywhere, but not at a wall right before the lens."""
        place = self.floor.draw(rng, ROOM_TO_STAND)
        if place is None:
            return None
        for _ in range(8):
            heading = whole(rng, 0, TURN - 1)
            ahead = place[0] + 0.9 * float(cosine(heading)), place[1] + 0.9 * float(sine(heading))
            if self.floor.is_indoors(*ahead) and sees(self.building, np.array(place), np.array(ahead)):
                return Pose2(*place, radians(heading))
        return None

    def robot_before(
        self, rng: np.random.Generator, observer: Pose2, clearance: float = UNCLUTTERED, in_sight: bool = True
    ) -> Pose2 | None:
        """A robot within the distance and the camera's view, turned anyhow; None where it finds no place."""
        T_world_camera = observer @ self.camera.mounting
        half = self.camera.degrees_wide() / 2
        far = uniform(rng, *self.distance)
        for _ in range(12):
            off = round(uniform(rng, -half, half) * TURN / 360)
            way = ticks_of(T_world_camera.theta) + off
            x, y = observer.x + far * float(cosine(way)), observer.y + far * float(sine(way))
            x, y = snap(np.array([x, y])).tolist()
            pose = Pose2(x, y, radians(whole(rng, 0, TURN - 1)))
            if self.floor.clear_of_walls(x, y) < clearance or not self.floor.footprint_clear(
                RobotBody().footprint(pose)
            ):
                continue
            if not in_sight or sees(self.building, observer.xy, pose.xy):
                return pose
        return None

    def is_whole(self, observer: Pose2, pose: Pose2, body: RobotBody) -> bool:
        """Whether a robot lies between the left and the right edge of the image."""
        view = viewpoint(observer, self.camera, self.camera_height)
        box = box_of(view, self.camera, body, pose)
        if box is None:
            return False
        middle = self.camera.height / 2
        return (
            box[0] >= RIM
            and box[2] <= self.camera.width - 1 - RIM
            and box[1] < middle * 1.4
            and box[3] > middle * 0.6
        )

    def dressed(
        self, rng: np.random.Generator, observer: Pose2, robots: tuple[tuple[Pose2, RobotBody], ...]
    ) -> ViewScene:
        """The building with robots, and with things and posters that were not there when it was mapped."""
        apart = np.array([observer.xy, *(pose.xy for pose, _ in robots)])
        ahead = observer.apply(np.array([2.5, 0.0]))
        posters = draw_posters(rng, self.building, self.seed, ahead)
        things = draw_things(rng, self.building, ahead, apart)
        return ViewScene(
            self.building, robots, tuple(posters), things=tuple(things), light=self.light, seed=self.seed
        )

    def share(self, staged: Staged, robot: int = 0) -> float:
        """How much of a robot nothing hides."""
        return seen_share(staged.scene, robot, staged.observer, self.camera, self.camera_height)[0]


def draw_body(rng: np.random.Generator, number: int = 0) -> RobotBody:
    """A robot's looks; its tags are those of its number, or else some others."""
    first = 4 * number if chance(rng, 0.5) else 4 * whole(rng, 2, 140)
    white = WHITE if chance(rng, 0.6) else CREAM
    tint = uniform(rng, 0.93, 1.03)
    paper = tuple(min(0.99, part * tint) for part in white)
    tags = (first, first + 1, first + 2, first + 3)
    return RobotBody(tags=tags, paper=(paper[0], paper[1], paper[2]), top=pick(rng, TOPS))
