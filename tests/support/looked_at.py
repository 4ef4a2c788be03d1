"""A robot before a round wall, with the box that a perfect detector draws: no image is looked at."""

from __future__ import annotations

from math import hypot

import numpy as np
from robot_scans import scan_of

from algorithms.common.pose import Pose2
from algorithms.detection.detection import Detection
from algorithms.detection.footprint import Footprint
from algorithms.detection.robot_sighting import LaserView, SightedRobots, sight
from algorithms.sensors.camera import Camera

CAMERA = Camera(640, 480, (500.0, 500.0), (319.5, 239.5))


def looked_at(at: Pose2, wall: float = 8.0) -> tuple[SightedRobots, LaserView]:
    """What camera and laser make of a robot at a pose in the observer's frame."""
    body = Footprint()
    half = np.array([[1, 1], [1, -1], [-1, -1], [-1, 1]]) * [body.length / 2, body.width / 2]
    corners = at.apply(half)
    columns = CAMERA.columns(np.arctan2(corners[:, 1], corners[:, 0]))
    high = 250.0 / hypot(at.x, at.y)
    box = Detection(float(columns.min()), 240.0, float(columns.max()), 240.0 + high, 0.97, "front_back")
    scan = scan_of(body, at, wall=wall, noise=0.01)
    return sight([box], scan, CAMERA, body), LaserView.of(scan, CAMERA, None)
