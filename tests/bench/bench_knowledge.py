"""How long a merge takes with less known: rough priors, vague sightings and nothing, on maps of four sizes.

`make bench`. The reference is the same pair with its sharp sighting; seconds are printed beside the ratio.
"""

from __future__ import annotations

import resource
from collections.abc import Callable
from dataclasses import replace
from functools import cache
from math import pi, radians
from time import perf_counter

import numpy as np
import pytest
from large_pair import simulate_large

from algorithms.methods.registry import merge
from algorithms.observations.pair_problem import Known
from algorithms.observations.priors import InitialPose, TurnPrior
from algorithms.simulator.scenario import SimulatedCase, simulate

SIZES = 500, 1000, 2300, 4000  # rows and columns


@cache
def pair_of(cells: int) -> SimulatedCase:
    return simulate("office", 7, overlap=0.4).cases[0] if cells == 500 else simulate_large(cells)


def sighting(case: SimulatedCase) -> list[Known]:
    return [case.observations[0]]


def vague(sigma_range: float) -> Callable[[SimulatedCase], list[Known]]:
    """So bad a range, and no bearing at all."""
    return lambda case: [replace(case.observations[0], sigma_range=sigma_range, sigma_bearing=pi)]


def initial(case: SimulatedCase) -> list[Known]:
    """A rough pose, off by a metre and 5°."""
    T, at = case.T_ref_mov, case.observations[0]
    assert T is not None
    point = np.array([at.observed_x, at.observed_y])
    turned = replace(T, theta=T.theta + radians(5))
    x, y = (T.apply(point) - turned.apply(point) + 0.7).tolist()
    near = replace(turned, x=turned.x + x, y=turned.y + y)
    return [InitialPose(near, 2.0, 2.0, radians(10), about_x=at.observed_x, about_y=at.observed_y)]


def turn(case: SimulatedCase) -> list[Known]:
    assert case.T_ref_mov is not None
    return [TurnPrior(case.T_ref_mov.theta + radians(5), radians(10))]


def nothing(case: SimulatedCase) -> list[Known]:
    return []


ROUGH = {"initial": initial, "turn": turn, "nothing": nothing}
TOLD = {f"{name}, {cells}": (cells, known) for cells in SIZES for name, known in ROUGH.items()}
TOLD |= {f"range to {sigma:g} m, 500": (500, vague(sigma)) for sigma in (1.0, 5.0, 20.0)}


@pytest.mark.parametrize("told", TOLD)
def bench_knowledge(told, benchmark):
    cells, known_of = TOLD[told]
    case = pair_of(cells)
    ref, mov = case.ref, case.mov
    merge(pair_of(500).ref, pair_of(500).mov, known_of(pair_of(500)))  # compiles
    began = perf_counter()
    merge(ref, mov, sighting(case))
    sharp = perf_counter() - began
    result = benchmark.pedantic(merge, (ref, mov, known_of(case)), rounds=3 if cells <= 1000 else 1)
    benchmark.extra_info.update(
        ratio=sharp / benchmark.stats.stats.median,
        reference="the same pair with its sighting",
        verdict=result.verdict.outcome.value,
        mb=resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024,
    )
    assert result.verdict.accepted or told.startswith(("turn", "nothing", "range"))
