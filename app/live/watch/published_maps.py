"""Which maps are published within reach, and what is to be listened to of the robots whose maps they are."""

from __future__ import annotations

import time
from collections.abc import Iterable
from dataclasses import replace

from algorithms.common.errors import SettingError
from algorithms.common.robot_names import check_name
from algorithms.files.bags.message_types import GRID
from algorithms.fleets.living_merge import PairSearch
from app.live.live_fleet_file import LONGEST, LiveFleet, LiveRobot
from app.live.live_run import LiveRun
from app.live.ros_link import Topic
from app.live.simulation import sightings_of
from app.live.watch.robot_network import RobotNetwork

FIND_WITHIN = 3.0  # seconds in which participants of DDS find each other
MOST_LISTED = 100  # maps


def published_maps(network: RobotNetwork, patience: float = FIND_WITHIN) -> tuple[str, ...]:
    """Topics of maps; raises SettingError."""
    links = network.links()
    try:
        link = links.link(network.bridge)
        time.sleep(0.0 if network.bridge else patience)
        return usable(link.published())
    finally:
        links.close()


def usable(published: Iterable[Topic]) -> tuple[str, ...]:
    """Those of topics on which there are maps, and whose names can be listened to."""
    maps = {each.name for each in published if each.type == GRID}
    return tuple(sorted(each for each in maps if each.isprintable() and len(each) <= LONGEST)[:MOST_LISTED])


def name_of(topic: str) -> str:
    """What the robot of a map's topic is called: r1 of /r1/map; "" where that does not tell."""
    return topic.strip("/").rpartition("/")[0].replace("/", "_")


def with_robot(fleet: LiveFleet, name: str, topic: str, network: RobotNetwork) -> LiveFleet:
    """A robot that runs more; raises SettingError where it cannot be called so, or its map is listened to."""
    check_name(name)
    if any(each.topic == topic for each in fleet.robots.values()):
        raise SettingError(f"{topic} is listened to already")
    robots = {**fleet.robots, name: LiveRobot(topic, bridge=network.bridge)}
    return replace(fleet, robots=robots, anchor=fleet.anchor or name)


def with_sightings(fleet: LiveFleet) -> LiveFleet:
    """With the topics on which its robots that run say where they see each other: /r1/sees/r2, if anybody
    publishes there.
    """
    run = [name for name, each in fleet.robots.items() if each.grid is None]
    robots = dict(fleet.robots)
    for name in run:
        sees = {other: sightings_of(name, other).name for other in run if other != name}
        robots[name] = replace(robots[name], sees=sees)
    return replace(fleet, robots=robots)


class ReachedRobots:
    """Robots of a network, as RunningRobots."""

    def __init__(self, network: RobotNetwork, fleet: LiveFleet) -> None:
        self._links, self._fleet = network.links(), fleet

    def begin(self, search: PairSearch) -> LiveRun:
        return LiveRun(self._fleet, self._links.link, search)

    def step(self, now: float) -> None:
        pass

    def close(self) -> None:
        self._links.close()
