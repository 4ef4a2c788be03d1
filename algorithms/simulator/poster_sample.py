"""A robot that is taken in by a photograph of a robot on a wall, and the sighting that it makes of it."""

from __future__ import annotations

from math import atan2, hypot

import numpy as np

from algorithms.common.pose import FloatArray, Pose2, wrap_angles
from algorithms.files.observation_file import OBSERVATION_FILE, known_to_bytes
from algorithms.observations.observation import Observation
from algorithms.simulator.portable_random import radians, stream, whole
from algorithms.simulator.scenario import Scenario
from algorithms.simulator.views.hardships import poster_before
from algorithms.simulator.views.light import Light
from algorithms.simulator.views.pictured_encounters import (
    FOCAL_LENGTHS,
    PicturedEncounter,
    believed_pose,
    encounter_files,
)
from algorithms.simulator.views.robot_sensors import draw_camera, draw_camera_height, draw_mounting
from algorithms.simulator.views.robot_views import view_of
from algorithms.simulator.views.solids import ticks_of
from algorithms.simulator.views.stage import Stage
from algorithms.simulator.views.view_scene import Poster

POSTER_SAMPLE = "office_poster"  # folder of sample_maps; its maps are those of office_r2_r1
VARIANT = 3  # of the photograph
DISTANCE = 2.0, 3.5  # metres; from … to, of who looks
TRIES = 4000
FAR_FROM_TRUTH = 4.0  # metres; so far is the robot from the photograph, at least


def poster_encounter(made: Scenario, seed: int) -> PicturedEncounter:
    """What the observer of the first pair takes for the other robot, somewhere on its drive.

    seed : of the building
    """
    pair = made.pairs[0]
    rng = stream(seed, made.building.name, "encounter with a poster")
    camera, height, mounting = draw_camera(rng, FOCAL_LENGTHS), draw_camera_height(rng), draw_mounting(rng)
    stage = Stage(made.building, seed, camera, height, DISTANCE, Light())
    observer, at = pair.observer, pair.meetings[0].observed
    stood = pair.observed.true.xy[at]
    for _ in range(TRIES):
        scan = whole(rng, 0, len(observer.true) - 1)
        heading = int(observer.true.heading[scan])
        x, y = observer.true.xy[scan].tolist()
        here = Pose2(x, y, radians(heading))
        staged = poster_before(stage, rng, here, VARIANT)
        if staged is None or hypot(*(_middle(staged.scene.posters[-1]) - stood)) < FAR_FROM_TRUTH:
            continue
        turn = ticks_of(staged.observer.theta) - heading
        view = view_of(staged.scene, staged.observer, camera, height, observer.body.lidar, mounting, rng)
        there = believed_pose(pair.observed.believed, at)
        return PicturedEncounter(view, believed_pose(observer.believed, scan, turn), there)
    raise RuntimeError(f"no poster can be hung where {observer.body.name} drove")


def poster_files(encounter: PicturedEncounter) -> dict[str, bytes]:
    """The files of the encounter by name, and the sighting that who trusts the picture alone makes of it."""
    return {**encounter_files([encounter]), OBSERVATION_FILE: known_to_bytes([taken_for_robot(encounter)])}


def taken_for_robot(encounter: PicturedEncounter) -> Observation:
    """The mean of the laser points in the direction of the poster, as section III-A measures a robot."""
    view = encounter.view
    ends = view.observer.inverse().apply(_ends(view.scene.posters[-1]))
    low, high = sorted(np.arctan2(ends[:, 1], ends[:, 0]).tolist())
    points = view.scan.points()
    bearings = np.arctan2(points[:, 1], points[:, 0])
    with np.errstate(invalid="ignore"):
        inside = np.abs(wrap_angles(bearings - (low + high) / 2)) <= (high - low) / 2
    x, y = points[inside].mean(axis=0).tolist()
    there = encounter.observed
    distance, bearing = round(hypot(x, y), 6), round(atan2(y, x), 6)
    return Observation(encounter.observer, there.x, there.y, distance, bearing, there.theta)


def _ends(poster: Poster) -> FloatArray:
    """(2, 2) left and right; metres, world frame."""
    return np.array([poster.left, poster.right])


def _middle(poster: Poster) -> FloatArray:
    """(2,) metres, world frame."""
    return np.asarray(_ends(poster).mean(axis=0))
