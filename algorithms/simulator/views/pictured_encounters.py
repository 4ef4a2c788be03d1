"""Encounters of drives with what the observer's camera and laser measured, and the files of them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from algorithms.common.pose import Pose2
from algorithms.files.camera_file import CAMERA_FILE, camera_to_bytes
from algorithms.files.camera_picture import picture_to_jpeg
from algorithms.files.encounter_table import ENCOUNTER_TABLE, EncounterRow, encounters_to_bytes
from algorithms.files.scan_file import scan_to_bytes
from algorithms.simulator.buildings.floor_plan import Building
from algorithms.simulator.path_planning import Track
from algorithms.simulator.portable_random import radians, stream, ticks_of_degrees, uniform
from algorithms.simulator.robot import Robot
from algorithms.simulator.sighting import RobotSighting
from algorithms.simulator.views.light import draw_light
from algorithms.simulator.views.robot_body import TOPS, RobotBody
from algorithms.simulator.views.robot_sensors import draw_camera, draw_camera_height, draw_mounting
from algorithms.simulator.views.robot_views import RobotView, view_of
from algorithms.simulator.views.solids import ticks_of
from algorithms.simulator.views.view_scene import ViewScene

OFF_AXIS = 12.0  # degrees; so far from straight ahead the other robot is, at most
FOCAL_LENGTHS = 590.0, 620.0  # pixels; robots meet at up to five metres
QUALITY = 88  # of JPEG


@dataclass(frozen=True, eq=False)
class PicturedEncounter:
    """One robot saw another.

    view     : what it saw, and the truth
    observer : where it believed to be, once it had turned to the other robot; metres, radians, its own frame
    observed : where the other robot believed to be; the other robot's frame
    """

    view: RobotView
    observer: Pose2
    observed: Pose2


def body_of(name: str) -> RobotBody:
    """The looks of a robot named R1, R2, …: its tags follow those of the one before."""
    number = int(name[1:]) - 1
    first = 4 * number
    return RobotBody(tags=(first, first + 1, first + 2, first + 3), top=TOPS[number % 2])


def pictured(
    building: Building, seed: int, observer: Robot, observed: Robot, meetings: Sequence[RobotSighting]
) -> tuple[PicturedEncounter, ...]:
    """What an observer sees of another robot at their meetings, turned to it on the spot.

    building, seed : in which they drove
    """
    words = (building.name, "encounter", observer.body.name, observed.body.name)
    rng = stream(seed, *words)
    camera, height, mounting = draw_camera(rng, FOCAL_LENGTHS), draw_camera_height(rng), draw_mounting(rng)
    found = []
    for n, at in enumerate(meetings):
        rng = stream(seed, *words, f"{n}")
        (x1, y1), (x2, y2) = observer.true.xy[at.observer].tolist(), observed.true.xy[at.observed].tolist()
        towards = ticks_of(float(np.arctan2(y2 - y1, x2 - x1)))
        heading = towards + ticks_of_degrees(uniform(rng, -OFF_AXIS, OFF_AXIS))
        turn = heading - int(observer.true.heading[at.observer])
        other = Pose2(x2, y2, radians(int(observed.true.heading[at.observed])))
        robots = ((other, body_of(observed.body.name)),)
        scene = ViewScene(building, robots, light=draw_light(rng), seed=seed)
        here = Pose2(x1, y1, radians(heading))
        view = view_of(scene, here, camera, height, observer.body.lidar, mounting, rng)
        believed = believed_pose(observer.believed, at.observer, turn)
        found.append(PicturedEncounter(view, believed, believed_pose(observed.believed, at.observed)))
    return tuple(found)


def believed_pose(track: Track, scan: int, turn: int = 0) -> Pose2:
    """Where a robot believed to be, turned by so many ticks; as files hold it."""
    x, y = track.xy[scan].tolist()
    return Pose2(round(x, 6), round(y, 6), round(radians(int(track.heading[scan]) + turn), 6))


def encounter_files(encounters: Sequence[PicturedEncounter]) -> dict[str, bytes]:
    """The files of encounters of one pair by name; none where there are no encounters."""
    if not encounters:
        return {}
    files, rows = {CAMERA_FILE: camera_to_bytes(encounters[0].view.camera)}, []
    for n, encounter in enumerate(encounters, 1):
        image, scan, there = f"seen_{n}.jpg", f"scan_{n}.yaml", encounter.observed
        files[image] = picture_to_jpeg(encounter.view.image, QUALITY)
        files[scan] = scan_to_bytes(encounter.view.scan)
        rows.append(EncounterRow(image, scan, encounter.observer, there.x, there.y, there.theta))
    return {**files, ENCOUNTER_TABLE: encounters_to_bytes(rows)}
