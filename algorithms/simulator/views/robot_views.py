"""One look of a robot at another one, or at none: picture, scan and the truth."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from algorithms.common.errors import SettingError
from algorithms.common.pose import Pose2
from algorithms.sensors.camera import Camera
from algorithms.sensors.laser_scan import LaserScan
from algorithms.simulator.buildings.building_types import build
from algorithms.simulator.buildings.floor_plan import Building
from algorithms.simulator.lidar import Lidar
from algorithms.simulator.portable_random import stream
from algorithms.simulator.views.camera_image import render, viewpoint
from algorithms.simulator.views.hardships import HARDSHIPS, plain
from algorithms.simulator.views.light import draw_light
from algorithms.simulator.views.projection import Box, box_of, clipped, face_seen, seen_share
from algorithms.simulator.views.reflections import reflection_seen
from algorithms.simulator.views.robot_body import RobotBody
from algorithms.simulator.views.robot_scan import scan_of
from algorithms.simulator.views.robot_sensors import (
    draw_camera,
    draw_camera_height,
    draw_lidar,
    draw_mounting,
)
from algorithms.simulator.views.stage import Stage
from algorithms.simulator.views.surfaces.materials import Picture
from algorithms.simulator.views.view_scene import ViewScene

VIEWS = 12  # of consecutive seeds that share a building, which takes longer to make than a view
TRIES = 400  # of setting up a view in a building
BUILDINGS_TRIED = 6
LEAST_SHARE = 0.02  # of a robot; less is not seen


@dataclass(frozen=True, eq=False)
class SeenRobot:
    """The truth about a robot in a picture; of a robot in a mirror, about its mirror image.

    pose    : where it stands, T_world_robot
    body    : what it looks like
    range   : of its middle from the observer's; metres
    bearing : of its middle from the observer's heading; radians, counter-clockwise
    box     : u0, v0, u1, v1 around its projected corners, floor to upper edge of the boards, cut off at the
              image's edges; pixels
    face    : which kind of board looks larger, "front_back" or "side"
    share   : of its pixels in the image, how many nothing hides, 0 … 1
    """

    pose: Pose2
    body: RobotBody
    range: float
    bearing: float
    box: Box
    face: str
    share: float


@dataclass(frozen=True, eq=False)
class RobotView:
    """What a robot's camera and laser measured at one moment.

    image         : (H, W, 3) uint8; red, green, blue
    camera, scan  : with their mountings
    camera_height : metres
    observer      : who looked, T_world_observer
    robots        : those in the picture, whatever they are hidden by
    reflections   : those in the picture that are mirror images
    scene         : all that was there
    """

    image: Picture
    camera: Camera
    camera_height: float
    scan: LaserScan
    observer: Pose2
    robots: tuple[SeenRobot, ...]
    reflections: tuple[SeenRobot, ...]
    scene: ViewScene


@lru_cache(maxsize=4)
def _building(kind: str, seed: int) -> Building:
    return build(kind, seed)


def draw_view(
    seed: int,
    kind: str,
    *,
    robot: bool,
    distance: tuple[float, float] = (1.0, 6.0),
    hardship: str | None = None,
) -> RobotView:
    """A view in a simulated building; one seed gives one view, bit for bit.

    seed     : VIEWS consecutive ones share a building, and its style
    kind     : of building, a key of ``BUILDINGS``
    robot    : whether there is one: free of clutter, whole and in sight, unless a hardship says otherwise.
               Without one there are other things, as cartons and notices
    distance : from … to, between the middles of the two robots; metres
    hardship : a key of HARDSHIPS. "mirror" shows a robot in a mirror alone, "poster" a picture of a robot
               alone, whatever ``robot`` is; "night" is a plain view in the dark; the others have robots
    raises   : SettingError for a hardship that is not there, or where no such view can be set up
    """
    if hardship is not None and hardship not in HARDSHIPS:
        raise SettingError(f"no hardship is called {hardship!r}; choose one of {', '.join(HARDSHIPS)}")
    rng = stream(seed, kind, "view", hardship or "plain", "robot" if robot else "nobody")
    setting = HARDSHIPS[hardship] if hardship else plain
    for n in range(BUILDINGS_TRIED):
        number = seed // VIEWS + 100_000 * n
        stage = Stage(
            _building(kind, number), number, draw_camera(rng), draw_camera_height(rng), distance,
            draw_light(rng, night=hardship == "night"),
        )  # fmt: skip
        for _ in range(TRIES):
            staged = setting(stage, rng, robot)
            if staged is not None:
                lidar, mounting = draw_lidar(rng), draw_mounting(rng)
                where = staged.scene, staged.observer
                return view_of(*where, stage.camera, stage.camera_height, lidar, mounting, rng)
    raise SettingError(f"no view of this kind in a {kind}: {hardship or 'plain'}, {distance} m")


def view_of(
    scene: ViewScene,
    observer: Pose2,
    camera: Camera,
    camera_height: float,
    lidar: Lidar,
    mounting: Pose2,
    rng: np.random.Generator,
) -> RobotView:
    """Take a picture and a scan.

    observer      : who looks, T_world_observer
    camera_height : metres
    mounting      : T_robot_laser
    """
    return RobotView(
        image=render(scene, observer, camera, camera_height, rng),
        camera=camera,
        camera_height=camera_height,
        scan=scan_of(scene, observer, mounting, lidar, rng),
        observer=observer,
        robots=seen_robots(scene, observer, camera, camera_height),
        reflections=_reflections(scene, observer, camera, camera_height),
        scene=scene,
    )


def seen_robots(
    scene: ViewScene, observer: Pose2, camera: Camera, camera_height: float
) -> tuple[SeenRobot, ...]:
    """The truth about all robots of a scene that a camera sees anything of.

    observer : who looks, T_world_observer
    """
    found = []
    for n, (pose, body) in enumerate(scene.robots):
        share, _ = seen_share(scene, n, observer, camera, camera_height)
        if share >= LEAST_SHARE:
            found.append(_truth(pose, body, share, observer, camera, camera_height))
    return tuple(found)


def _reflections(
    scene: ViewScene, observer: Pose2, camera: Camera, camera_height: float
) -> tuple[SeenRobot, ...]:
    found = []
    for m in range(len(scene.mirrors)):
        for n, (_, body) in enumerate(scene.robots):
            pose, share = reflection_seen(scene, m, n, observer, camera, camera_height)
            if share >= LEAST_SHARE:
                found.append(_truth(pose, body, share, observer, camera, camera_height))
    return tuple(found)


def _truth(
    pose: Pose2, body: RobotBody, share: float, observer: Pose2, camera: Camera, camera_height: float
) -> SeenRobot:
    view = viewpoint(observer, camera, camera_height)
    box = box_of(view, camera, body, pose)
    assert box is not None  # something of it is seen
    x, y = observer.inverse().apply(pose.xy).tolist()
    return SeenRobot(
        pose=pose,
        body=body,
        range=float(np.hypot(x, y)),
        bearing=float(np.arctan2(y, x)),
        box=clipped(box, camera),
        face=face_seen(view, camera, body, pose),
        share=share,
    )
