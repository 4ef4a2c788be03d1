"""Pairs of maps from simulated buildings, on which laws of whole merges are tried."""

from __future__ import annotations

from functools import cache

from algorithms.simulator.robot import Conditions
from algorithms.simulator.scenario import SimulatedCase, simulate

SimulatedBuilding = tuple[str, int, float]
"""Kind, seed, and the overlap that is aimed at."""

BUILDINGS: list[SimulatedBuilding] = [
    ("apartment", 1, 0.4),
    ("corridor", 3, 0.3),
    ("home", 10, 0.4),
    ("office", 2, 0.3),
    ("warehouse", 20, 0.3),
]


@cache
def cases_of(kind: str, seed: int, overlap: float) -> tuple[SimulatedCase, ...]:
    """Both pairs of a building, in cells of 5 cm, each with two sightings where the robots met twice."""
    return simulate(kind, seed, overlap, conditions=(Conditions(resolution=0.05),) * 3, sightings=2).cases
