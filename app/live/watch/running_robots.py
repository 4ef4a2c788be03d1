"""Robots that run, as the page follows them: simulated in this process, or within reach of a network."""

from __future__ import annotations

from collections.abc import Callable
from typing import Protocol

from algorithms.files.bags.bag_path import NANO
from algorithms.fleets.living_merge import PairSearch
from algorithms.simulator.fleets.exploration import Exploration
from algorithms.simulator.fleets.fleet_scenario import SimulatedFleet, simulate_fleet
from app.live.live_run import LiveRun
from app.live.ros_link import Topic
from app.live.simulation import PACE, fleet_of, messages_of
from app.live.watch.inner_link import InnerLink, InnerPublication
from app.system.clock import stamp

MAP_EVERY = 1.0  # seconds between two maps of a simulated robot, however fast it drives
MOST_SCANS = 60  # of simulated robots in one step: what a slow machine does not manage in time comes later


class RunningRobots(Protocol):
    """Begun, stepped and closed in one thread."""

    def begin(self, search: PairSearch) -> LiveRun:
        """Begin to listen; raises MapMergeError."""
        ...

    def step(self, now: float) -> None: ...

    def close(self) -> None: ...


class SimulatedRobots:
    """Robots of the generator that explore a building at the same time, and meet.

    speed : so many times as fast as robots drive now; 0 holds them
    """

    def __init__(self, speed: Callable[[], float], made: Callable[[], SimulatedFleet] | None = None) -> None:
        self._speed, self._made = speed, made or _office
        self._link = InnerLink()
        self._topics: dict[Topic, InnerPublication] = {}
        self._exploration: Exploration | None = None
        self._scan = -1  # the last that was published
        self._clock = 0.0  # seconds of their time
        self._stepped: float | None = None
        self._mapped = float("-inf")

    def begin(self, search: PairSearch) -> LiveRun:
        self._exploration = Exploration(self._made())
        self._start = stamp()
        return LiveRun(fleet_of(self._exploration.names), lambda _: self._link, search)

    def step(self, now: float) -> None:
        """Publish what they have seen since the last time."""
        e, before, self._stepped = self._exploration, self._stepped, now
        if e is None:
            return
        passed = 0.0 if before is None else (now - before) * max(0.0, self._speed())
        self._clock = min(self._clock + passed, (self._scan + MOST_SCANS) * PACE)
        last = min(int(self._clock / PACE), e.scans)
        for scan in range(self._scan + 1, last + 1):
            maps = scan == e.scans or (scan == last and now - self._mapped >= MAP_EVERY)
            if maps:
                self._mapped = now
            for topic, fields in messages_of(e, scan, self._start + round(scan * PACE * NANO), maps):
                self._publication(topic).send(fields)
        self._scan = max(self._scan, last)

    @property
    def done(self) -> bool:
        """Whether all have driven."""
        return self._exploration is not None and self._scan >= self._exploration.scans

    def leave(self, name: str) -> None:
        """A robot is switched off: nothing of it is published any more."""
        for topic in [topic for topic in self._topics if topic.name.startswith(f"/{name}/")]:
            self._topics.pop(topic).leave()

    def close(self) -> None:
        self._link.close()

    def _publication(self, topic: Topic) -> InnerPublication:
        if topic not in self._topics:
            self._topics[topic] = self._link.advertise(topic)
        return self._topics[topic]


def _office() -> SimulatedFleet:
    return simulate_fleet("office", 3, 3, lies=0.0)
