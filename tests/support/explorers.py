"""Simulated robots that explore, and a search of pairs that is done at once."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache

from algorithms.fleets.pair_hypotheses import PairFinding, PairOrder, find_pair
from algorithms.observations.fleet import Fleet
from algorithms.simulator.fleets.exploration import Exploration, SlamCorrection
from algorithms.simulator.fleets.fleet_scenario import SimulatedFleet, simulate_fleet


@cache
def home() -> SimulatedFleet:
    """Three robots in a home of 34 scans; r1 meets the two others at scan 22."""
    return simulate_fleet("home", 5, 3, lies=0.0)


def exploration(correction: SlamCorrection | None = None) -> Exploration:
    return Exploration(home(), correction)


class SearchNow:
    """Answers the next time that it is asked; ``asked`` holds every set of orders."""

    def __init__(self) -> None:
        self.asked: list[list[PairOrder]] = []
        self._found: list[PairFinding] | None = None

    def start(self, fleet: Fleet, orders: Sequence[PairOrder]) -> None:
        self.asked.append(list(orders))
        self._found = [find_pair(fleet, order) for order in orders]

    def finished(self) -> list[PairFinding] | None:
        found, self._found = self._found, None
        return found
