"""The sightings of a fleet that runs: bounded, and in the frames that its robots have now."""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Iterable
from dataclasses import replace

import numpy as np

from algorithms.common.pose import Pose2
from algorithms.observations.fleet import MOST_SIGHTINGS, FleetSighting

MOST_SEEN = 12  # of one robot by another, the newest


class LiveSightings:
    """In the order in which they came."""

    def __init__(self, sightings: Iterable[FleetSighting] = ()) -> None:
        self._all = list(sightings)

    def add(self, sighting: FleetSighting) -> bool:
        """Whether it is new."""
        same = [each for each in self._all if _way(each) == _way(sighting)]
        if sighting in same:
            return False
        for old in same[: max(0, len(same) + 1 - MOST_SEEN)]:
            self._all.remove(old)
        self._all.append(sighting)
        return True

    def forget(self, name: str) -> None:
        """Those of a robot hold no more."""
        self._all = [each for each in self._all if name not in _way(each)]

    def move(self, name: str, T: Pose2) -> None:
        """A robot's frame has been corrected by T_new_old."""
        self._all = [_moved(each, name, T) for each in self._all]

    def among(self, names: Collection[str]) -> tuple[FleetSighting, ...]:
        """Those between these robots; of every two the way that most go, on a tie that of the first.

        Merged both ways, one pair of maps would weigh the same walls twice, and be twice as sure.
        """
        known = [each for each in self._all if set(_way(each)) <= set(names)]
        ways: dict[frozenset[str], tuple[str, str]] = {}
        for way, _ in Counter(map(_way, known)).most_common():  # of equal ones that which came first
            ways.setdefault(frozenset(way), way)
        found = [each for each in known if _way(each) in ways.values()]
        return tuple(found[-MOST_SIGHTINGS:])


def _way(seen: FleetSighting) -> tuple[str, str]:
    return seen.observer, seen.observed


def _moved(seen: FleetSighting, name: str, T: Pose2) -> FleetSighting:
    o = seen.observation
    if seen.observer == name:
        o = replace(o, observer=T @ o.observer)
    if seen.observed == name:
        x, y = T.apply(np.array([o.observed_x, o.observed_y])).tolist()
        heading = None if o.observed_heading is None else o.observed_heading + T.theta
        o = replace(o, observed_x=x, observed_y=y, observed_heading=heading)
    return replace(seen, observation=o)
