"""Laser scans of one robot before a wall, computed by geometry alone."""

from __future__ import annotations

from math import cos, inf, pi, sin

import numpy as np

from algorithms.common.pose import FloatArray, Pose2
from algorithms.detection.footprint import Footprint
from algorithms.sensors.laser_scan import LaserScan


def hits(body: Footprint, at: Pose2, angles: FloatArray) -> FloatArray:
    """(N,) range of beams from the origin to a robot, inf where they miss; metres."""
    beams = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    if body.round:
        along = beams @ at.xy
        left = along**2 - (at.xy @ at.xy - (body.length / 2) ** 2)
        return np.where((left >= 0) & (along > 0), along - np.sqrt(np.maximum(left, 0)), inf)
    start = at.inverse().apply(np.zeros(2))
    c, s = cos(at.theta), sin(at.theta)
    ways = beams @ np.array([[c, -s], [s, c]])
    half = np.array([body.length, body.width]) / 2
    with np.errstate(divide="ignore", invalid="ignore"):
        first, second = (-half - start) / ways, (half - start) / ways
    enter = np.minimum(first, second).max(axis=1)
    leave = np.maximum(first, second).min(axis=1)
    return np.where((enter <= leave) & (enter > 0), enter, inf)


def scan_of(
    body: Footprint,
    *at: Pose2,
    beams: int = 540,
    field: float = 1.5 * pi,
    wall: float = 8.0,
    noise: float = 0.0,
    seed: int = 0,
    lost: float = 0.0,
    mounting: Pose2 | None = None,
) -> LaserScan:
    """A scan of robots, in the laser's frame, before a round wall."""
    rng = np.random.default_rng(seed)
    step = field / beams
    angles = -field / 2 + step * np.arange(beams)
    ranges = np.full(beams, wall)
    for pose in at:
        ranges = np.minimum(ranges, hits(body, pose, angles))
    ranges = ranges + noise * rng.normal(size=beams)
    ranges[rng.random(beams) < lost] = np.nan
    return LaserScan(-field / 2, step, ranges, 0.05, 30.0, mounting or Pose2())
