"""Which maps are published within reach, and what is to be listened to of the robots whose maps they are."""

from __future__ import annotations

import time
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace

from algorithms.common.errors import SettingError
from algorithms.files.bags.message_types import GRID, SEEN
from algorithms.fleets.living_merge import PairSearch
from app.live.live_fleet_file import LONGEST, LiveFleet, LiveRobot
from app.live.live_run import LiveRun
from app.live.ros_link import Topic
from app.live.simulation import sightings_of
from app.live.watch.robot_network import RobotNetwork

FIND_WITHIN = 3.0  # seconds in which participants of DDS find each other
MOST_LISTED = 100  # maps


@dataclass(frozen=True)
class PublishedMaps:
    """topics of maps; of poses of robots that are seen"""

    maps: tuple[str, ...]
    seen: frozenset[str] = frozenset()


def published_maps(network: RobotNetwork, patience: float = FIND_WITHIN) -> PublishedMaps:
    """Look for maps; raises SettingError."""
    links = network.links()
    try:
        link = links.link(network.bridge)
        time.sleep(0.0 if network.bridge else patience)
        return usable(link.published())
    finally:
        links.close()


def usable(published: Iterable[Topic]) -> PublishedMaps:
    """Those of topics with names that can be listened to."""
    named = [each for each in published if each.name.isprintable() and len(each.name) <= LONGEST]
    maps = sorted({each.name for each in named if each.type == GRID})
    return PublishedMaps(
        tuple(maps[:MOST_LISTED]), frozenset(each.name for each in named if each.type == SEEN)
    )


def name_of(topic: str) -> str:
    """What the robot of a map's topic is called: r1 of /r1/map; "" where that does not tell."""
    return topic.strip("/").rpartition("/")[0].replace("/", "_")


def with_robot(fleet: LiveFleet, name: str, topic: str, network: RobotNetwork) -> LiveFleet:
    """A robot that runs more; raises SettingError where its map is listened to already."""
    if any(each.topic == topic for each in fleet.robots.values()):
        raise SettingError(f"{topic} is listened to already")
    robots = {**fleet.robots, name: LiveRobot(topic, bridge=network.bridge)}
    return replace(fleet, robots=robots, anchor=fleet.anchor or name)


def with_sightings(fleet: LiveFleet, seen: frozenset[str]) -> LiveFleet:
    """With those topics of sightings that are called by the names of two of its robots: /r1/sees/r2."""
    run = [name for name, each in fleet.robots.items() if each.grid is None]

    def sees(one: str) -> Mapping[str, str]:
        topics = {other: sightings_of(one, other).name for other in run if other != one}
        return {other: topic for other, topic in topics.items() if topic in seen}

    robots = {
        name: replace(each, sees=sees(name)) if name in run else each for name, each in fleet.robots.items()
    }
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
