"""Robots of a fleet that drive at the same time: their maps grow scan by scan, and they see each other."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import permutations
from math import cos, sin

import numpy as np

from algorithms.common.pose import Pose2
from algorithms.maps.grid_map import GridMap
from algorithms.observations.fleet import FleetSighting
from algorithms.observations.observation import SIGMA_BEARING, SIGMA_RANGE
from algorithms.simulator.fleets.fleet_scenario import SimulatedFleet
from algorithms.simulator.lidar import sees
from algorithms.simulator.log_odds_mapping import build_map
from algorithms.simulator.path_planning import Track
from algorithms.simulator.portable_random import TURN, radians, stream
from algorithms.simulator.robot import Robot
from algorithms.simulator.sighting import FURTHEST, NEAREST, RobotSighting, observe

AGAIN = 40  # scans from one sighting of a robot to the next of the same one by the same
FIRST = 4  # scans that a robot has made when the clock begins


@dataclass(frozen=True)
class SlamCorrection:
    """A robot's SLAM finds that all of its map was turned about where it began.

    robot   : by name
    scan    : by the fleet's clock, from which on its map and its poses are turned
    degrees : counter-clockwise
    """

    robot: str
    scan: int
    degrees: float


class Exploration:
    """A fleet's drives on one clock, which counts scans from 0 on.

    A robot begins so late that it meets, at one moment, the first of those before it whom it met.
    """

    def __init__(self, made: SimulatedFleet, correction: SlamCorrection | None = None) -> None:
        self.made, self.correction = made, correction
        self._begins = _begins(made)
        self._seen: dict[tuple[str, str], int] = {}
        self._rng = stream(0, "exploration", *made.robots)
        self.scans = max(begin + len(made.robots[name].true) for name, begin in self._begins.items())
        """Until all have driven."""

    @property
    def names(self) -> tuple[str, ...]:
        return tuple(self.made.robots)

    def done(self, name: str, scan: int) -> int:
        """How many scans a robot has made by then."""
        return int(np.clip(scan - self._begins[name], FIRST, len(self.made.robots[name].true)))

    def grid(self, name: str, scan: int) -> GridMap:
        """Its map so far, in its own frame."""
        robot, count = self.made.robots[name], self.done(name, scan)
        track, body = _first(self._believed(name, scan), count), robot.body
        return build_map(track, robot.ranges[:count], body.lidar, body.resolution, name)

    def pose(self, name: str, scan: int) -> Pose2:
        """T_map_robot, as it believes."""
        return _pose(self._believed(name, scan), self.done(name, scan) - 1)

    def true_transform(self, name: str, scan: int) -> Pose2:
        """T_anchor_robot: where the frame of its map truly lies in the anchor's, as corrected by then."""
        anchor = self.made.fleet.anchor
        T = self._turn(anchor, scan) @ self.made.T_anchor_robot[name]
        return T @ self._turn(name, scan).inverse()

    def seen(self, scan: int) -> list[FleetSighting]:
        """Who sees whom, and has not for a while; to be asked once for every scan."""
        found = []
        robots: Mapping[str, Robot] = self.made.robots
        for one, other in permutations(robots, 2):
            i, j = self.done(one, scan) - 1, self.done(other, scan) - 1
            here, there = robots[one].true.xy[i], robots[other].true.xy[j]
            if scan - self._seen.get((one, other), -AGAIN) < AGAIN:
                continue
            if not NEAREST <= float(np.linalg.norm(there - here)) <= FURTHEST:
                continue
            if not sees(self.made.building, here, there):
                continue
            self._seen[one, other] = scan
            true = robots[one].true, robots[other].true
            believed = self._believed(one, scan), self._believed(other, scan)
            sigma = SIGMA_RANGE, SIGMA_BEARING
            observation = observe(true, believed, RobotSighting(i, j), self._rng, sigma, both_ways=False)
            found.append(FleetSighting(one, other, observation))
        return found

    def _believed(self, name: str, scan: int) -> Track:
        """Its drive as it believes by then; only the scans that it has made count."""
        track = self.made.robots[name].believed
        if not self._corrected(name, scan):
            return track
        assert self.correction is not None
        turn = round(self.correction.degrees * TURN / 360)
        return Track(self._turn(name, scan).apply(track.xy), (track.heading + turn) % TURN)

    def _turn(self, name: str, scan: int) -> Pose2:
        """T_corrected_before of a robot's map."""
        if not self._corrected(name, scan):
            return Pose2()
        assert self.correction is not None
        angle = float(np.radians(self.correction.degrees))
        x, y = self.made.robots[name].believed.xy[0].tolist()
        c, s = cos(angle), sin(angle)
        return Pose2(x - c * x + s * y, y - s * x - c * y, angle)

    def _corrected(self, name: str, scan: int) -> bool:
        correction = self.correction
        return correction is not None and correction.robot == name and scan >= correction.scan


def _begins(made: SimulatedFleet) -> dict[str, int]:
    """By the fleet's clock, when each robot's first scan is made."""
    begins = {next(iter(made.robots)): 0}
    while len(begins) < len(made.robots):
        for one, other, at in made.met:
            if one in begins and other not in begins:
                begins[other] = begins[one] + at.observer - at.observed
            elif other in begins and one not in begins:
                begins[one] = begins[other] + at.observed - at.observer
    first = min(begins.values())
    return {name: begin - first for name, begin in begins.items()}


def _first(track: Track, count: int) -> Track:
    return Track(track.xy[:count], track.heading[:count])


def _pose(track: Track, at: int) -> Pose2:
    x, y = track.xy[at].tolist()
    return Pose2(x, y, radians(int(track.heading[at])))
