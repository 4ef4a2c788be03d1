"""Simulated robots on topics: they publish what robots that run publish."""

from __future__ import annotations

from collections.abc import Iterator
from math import cos, radians, sin

import numpy as np

from algorithms.common.pose import rotation
from algorithms.files.bags.message_types import SCAN, SEEN
from algorithms.files.bags.message_writing import Fields
from algorithms.observations.observation import Observation
from algorithms.simulator.fleets.exploration import Exploration
from algorithms.simulator.path_planning import STEP
from app.live.live_fleet_file import LiveFleet, LiveRobot
from app.live.message_fields import grid_message, scan_message, seen_message, transforms_message
from app.live.ros_link import TF, Topic, map_topic

SPEED = 0.5  # metres per second that a robot drives
PACE = STEP / SPEED  # seconds from one scan to the next
SCANS_PER_MAP = 2


def map_of(name: str) -> Topic:
    return map_topic(f"/{name}/map")


def scans_of(name: str) -> Topic:
    return Topic(f"/{name}/scan", SCAN)


def sightings_of(observer: str, observed: str) -> Topic:
    return Topic(f"/{observer}/sees/{observed}", SEEN)


def fleet_text(names: tuple[str, ...]) -> str:
    """The fleet file with which ``mapmeld live`` listens to them."""
    lines = ["robots:"]
    for name in names:
        sees = ", ".join(f"{other}: {sightings_of(name, other).name}" for other in names if other != name)
        lines.append(f"  {name}: {{topic: {map_of(name).name}, sees: {{{sees}}}}}")
    return "\n".join(lines) + "\n"


def fleet_of(names: tuple[str, ...]) -> LiveFleet:
    """The same as it is read from there."""
    robots = {
        name: LiveRobot(map_of(name).name, sees={o: sightings_of(name, o).name for o in names if o != name})
        for name in names
    }
    return LiveFleet(robots, (), (), names[0])


def messages_of(
    exploration: Exploration, scan: int, time: int, maps: bool | None = None
) -> Iterator[tuple[Topic, Fields]]:
    """What all robots publish at a scan of their clock; ``time`` in nanoseconds since 1970.

    Transforms come before what is told in their frames. ``maps``: whether their maps are told, too;
    None: at every other scan.
    """
    with_maps = scan % SCANS_PER_MAP == 0 if maps is None else maps
    poses = [(f"{name}/map", f"{name}/base_link", exploration.pose(name, scan)) for name in exploration.names]
    yield Topic("/tf", TF), transforms_message(poses, time)
    for name in exploration.names:
        robot, at = exploration.made.robots[name], exploration.done(name, scan) - 1
        if with_maps:
            yield map_of(name), grid_message(exploration.grid(name, scan), f"{name}/map", time)
        lidar, ranges = robot.body.lidar, robot.ranges[at]
        field = radians(lidar.field)
        step = field / lidar.beams
        yield scans_of(name), scan_message(f"{name}/base_link", time, -field / 2, step, lidar.reach, ranges)
    for seen in exploration.seen(scan):
        topic = sightings_of(seen.observer, seen.observed)
        yield topic, _seen(f"{seen.observer}/base_link", time, seen.observation)


def _seen(frame: str, time: int, o: Observation) -> Fields:
    turn = rotation(o.bearing)
    spread = turn @ np.diag([o.sigma_range**2, (o.range * o.sigma_bearing) ** 2]) @ turn.T
    return seen_message(frame, time, o.range * cos(o.bearing), o.range * sin(o.bearing), spread)
