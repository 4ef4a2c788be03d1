"""Where sightings of robots that run come from: topics, and a folder that is watched."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import permutations
from math import atan2, hypot
from pathlib import Path
from typing import Any

import numpy as np

from algorithms.common.errors import InputFileError, MapMergeError
from algorithms.common.pose import rotation, wrap_angle
from algorithms.files.bags.frame_tree import stamp_of
from algorithms.files.bags.message_types import SEEN
from algorithms.files.observation_file import read_observations
from algorithms.observations.fleet import FleetSighting
from algorithms.observations.observation import (
    SIGMA_BEARING,
    SIGMA_BEARINGS,
    SIGMA_RANGE,
    SIGMA_RANGES,
    Observation,
)
from app.live.map_source import TopicSource
from app.live.ros_link import RosLink, Topic

SAW = "_saw_"  # in the name of an observation file, between the names of the two robots
MOST_FILES = 1000
PATIENCE = 1.0  # seconds for which a sighting waits for the transforms of its moment
MOST_WAITING = 20
FARTHEST = 100.0  # metres at which a robot is seen
Sightings = tuple[list[FleetSighting], list[str]]
"""What came, and what was wrong with what could not be used."""


class SightingTopic:
    """Poses of one robot as another sees it, in any frame of the one that sees it."""

    def __init__(self, link: RosLink, topic: str, observer: TopicSource, observed: TopicSource) -> None:
        self._topic, self._observer, self._observed = topic, observer, observed
        self._messages = link.subscribe(Topic(topic, SEEN, depth=MOST_WAITING))
        self._waiting: list[tuple[float, Any]] = []

    def poll(self, now: float) -> Sightings:
        """Those that came. One may come before the transforms of its moment: it is tried for a while."""
        found: list[FleetSighting] = []
        wrong: list[str] = []
        tried, self._waiting = self._waiting, []
        for came, message in [*tried, *((now, each) for each in self._messages.take())]:
            try:
                if isinstance(message, InputFileError):
                    raise message
                found.append(sighting_of(self._topic, message, self._observer, self._observed))
            except MapMergeError as error:
                if isinstance(message, InputFileError) or now - came >= PATIENCE:
                    wrong.append(f"a sighting on {self._topic} cannot be used: {error}")
                else:
                    self._waiting.append((came, message))
        self._waiting = self._waiting[-MOST_WAITING:]
        return found, wrong


def sighting_of(topic: str, message: Any, one: TopicSource, other: TopicSource) -> FleetSighting:
    """Where one robot saw another, by a geometry_msgs/PoseWithCovarianceStamped; raises InputFileError,
    SettingError.
    """
    time = stamp_of(message.header)
    place = np.array([message.pose.pose.position.x, message.pose.pose.position.y], float)
    if not np.isfinite(place).all():
        raise InputFileError(topic, f"has a robot at {place.tolist()}", "give metres")
    observer, observed = one.pose(time), other.pose(time)
    T_base_frame = one.frames.pose(one.base, str(message.header.frame_id), time)
    x, y = T_base_frame.apply(place).tolist()
    distance, bearing = hypot(x, y), atan2(y, x)
    if not distance <= FARTHEST:
        raise InputFileError(topic, f"has a robot {distance:g} m away", "give metres")
    spread = np.asarray(message.pose.covariance, float).reshape(6, 6)[:2, :2]
    turn = rotation(wrap_angle(T_base_frame.theta - bearing))
    along, across = np.diag(turn @ spread @ turn.T).tolist()
    observation = Observation(
        observer=observer,
        observed_x=observed.x,
        observed_y=observed.y,
        range=distance,
        bearing=bearing,
        observed_heading=observed.theta,
        sigma_range=_deviation(along, 1.0, SIGMA_RANGE, SIGMA_RANGES),
        sigma_bearing=_deviation(across, distance, SIGMA_BEARING, SIGMA_BEARINGS),
    )
    return FleetSighting(one.name, other.name, observation)


def _deviation(variance: float, distance: float, usual: float, limits: tuple[float, float]) -> float:
    """A standard deviation; the usual one where a message tells none, or none that can be."""
    if not 0 < variance < np.inf:
        return usual
    return float(np.clip(variance**0.5 / max(distance, 0.1), *limits))


class SightingFolder:
    """Observation files that are put into a folder, each called OBSERVER_saw_OBSERVED….yaml."""

    def __init__(self, folder: Path, names: Sequence[str]) -> None:
        if not folder.is_dir():
            raise InputFileError(folder, "is no folder", "give one into which observation files are put")
        self._folder = folder
        self._pairs = {f"{one}{SAW}{other}": (one, other) for one, other in permutations(names, 2)}
        self._read: dict[str, tuple[int, int]] = {}

    def poll(self) -> Sightings:
        """Those of files that are new, or have been written again."""
        found: list[FleetSighting] = []
        wrong: list[str] = []
        for path in sorted(self._folder.glob("*.yaml"))[:MOST_FILES]:
            try:
                about = path.stat()
            except OSError:
                continue
            version = about.st_mtime_ns, about.st_size
            if self._read.get(path.name) == version:
                continue
            self._read[path.name] = version
            try:
                found += [FleetSighting(*self._pair(path), each) for each in read_observations(path)]
            except MapMergeError as error:
                wrong.append(str(error))
        return found, wrong

    def _pair(self, path: Path) -> tuple[str, str]:
        begins = [each for each in self._pairs if path.stem.startswith(each)]
        if not begins:
            usual = f"{next(iter(self._pairs))}.yaml"
            raise InputFileError(path, "does not say whose sighting it is", f"call it as {usual}")
        return self._pairs[max(begins, key=len)]
