"""What the likelihood of a merge may depend on, and what not: laws, on simulated buildings.

Where maps share so little that the likelihood lies in the middle, swapping or turning them can move it by
some hundredths: where cells end counts for more there. These buildings share enough.
"""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from itertools import permutations
from math import atan2

import numpy as np
import pytest
from scipy.spatial import cKDTree
from simulated import BUILDINGS, cases_of

from algorithms.common.pose import Pose2, rotation, wrap_angle
from algorithms.maps.grid_map import UNKNOWN
from algorithms.methods.refusal_causes import NO_SWARM
from algorithms.methods.registry import DEFAULT_METHOD, METHODS, merge
from algorithms.observations.observation import Observation, encounter
from algorithms.simulator.scenario import SimulatedCase
from algorithms.simulator.wrong_pairs import mismatch
from algorithms.verdict.wall_map import SAME_WALL

DEFAULT = METHODS[DEFAULT_METHOD].defaults
QUICK = replace(DEFAULT, swarm=NO_SWARM)  # the proof finds what the swarm does not
FRAMES = [Pose2(13.3, -22.7, 2.5), Pose2(-71.0, 8.0, -0.4), Pose2(0.02, 0.01, 0.9)]
LITTLE = 0.01


def likely(ref, mov, observations) -> float:
    return merge(ref, mov, observations, config=QUICK).verdict.probability


@cache
def likelihood_of(building: tuple[str, int, float]) -> float:
    case = cases_of(*building)[0]
    return likely(case.ref, case.mov, case.observations[0])


@pytest.fixture(params=BUILDINGS, ids=lambda building: building[0])
def building(request) -> tuple[str, int, float]:
    return request.param


@pytest.fixture
def case(building) -> SimulatedCase:
    return cases_of(*building)[0]


@pytest.fixture
def likelihood(building) -> float:
    return likelihood_of(building)


def the_other_way(o: Observation, T_ref_mov: Pose2) -> Observation:
    """The same sighting as robot 2 would have made it, of robot 1, with the same error."""
    x, y = rotation(T_ref_mov.theta).T @ (o.observer.xy - encounter(o).x_ref)
    heading = o.observed_heading or 0.0
    return Observation(
        observer=Pose2(o.observed_x, o.observed_y, heading),
        observed_x=o.observer.x,
        observed_y=o.observer.y,
        range=o.range,
        bearing=wrap_angle(atan2(y, x) - heading),
        sigma_range=o.sigma_range,
        sigma_bearing=o.sigma_bearing,
    )


def test_swapping_the_maps_changes_nothing(case, likelihood):
    other = the_other_way(case.observations[0], case.T_ref_mov)
    assert likely(case.mov, case.ref, other) == pytest.approx(likelihood, abs=LITTLE)


@pytest.mark.parametrize("T", FRAMES, ids=lambda T: f"{T.theta:g}")
def test_another_frame_of_either_map_changes_nothing(case, likelihood, T):
    seen = case.observations[0]
    ref, mov = (replace(grid, origin=T @ grid.origin) for grid in (case.ref, case.mov))
    x, y = T.apply(np.array([seen.observed_x, seen.observed_y])).tolist()
    first = likely(ref, case.mov, replace(seen, observer=T @ seen.observer))
    second = likely(case.ref, mov, replace(seen, observed_x=x, observed_y=y))
    assert (first, second) == pytest.approx((likelihood, likelihood), abs=LITTLE)


def test_the_name_of_a_map_changes_nothing(case, likelihood):
    ref, mov = replace(case.ref, name="another"), replace(case.mov, name="")
    assert likely(ref, mov, case.observations[0]) == likelihood


MET_TWICE = [building for building in BUILDINGS if building[0] != "home"] + [
    ("home", 4, 0.6),
    ("office", 8, 0.2),
]


@pytest.mark.parametrize("building", MET_TWICE, ids=lambda b: f"{b[0]}_{b[1]}")
def test_a_second_true_sighting_does_not_lower_it(building):
    met_twice = [case for case in cases_of(*building) if len(case.observations) > 1]
    assert met_twice
    for case in met_twice:
        one = likely(case.ref, case.mov, case.observations[0])
        assert likely(case.ref, case.mov, case.observations) >= one - 1e-6


def test_rubbing_out_most_of_the_wall_that_agrees_lowers_it(case, likelihood):
    """Row by row from below, in map 2."""
    rows, cols = np.nonzero(case.mov.occupied)
    there = case.T_ref_mov.apply(case.mov.centres(rows, cols))
    near = cKDTree(case.ref.points).query(there)[0] <= SAME_WALL
    before = likelihood
    for share in (0.8, 0.95):
        gone = near & (rows <= np.quantile(rows[near], share))
        cells = case.mov.cells.copy()
        cells[rows[gone], cols[gone]] = UNKNOWN
        after = likely(case.ref, replace(case.mov, cells=cells), case.observations[0])
        assert after < before
        before = after


STRANGERS = [(kind, 500 + n) for n, kind in enumerate(3 * ["apartment", "corridor", "home", "office"])]


def test_maps_of_different_buildings_are_not_likely_to_belong_together():
    """34 pairs, of the thousand that `make unrelated` looks at: hardly one is as likely as one in twenty. Two
    office floors of the simulator may be so alike that the likeliest of all is as likely as two in three.
    """
    told = []
    for a, b in list(permutations(STRANGERS, 2))[::8]:
        for first, second in zip(cases_of(*a, 0.3), cases_of(*b, 0.3), strict=False):
            forged = mismatch(first, second)
            told.append(likely(forged.ref, forged.mov, forged.observations[0]))
    assert len(told) == 34
    assert np.quantile(told, 0.96) < 0.05
    assert max(told) < 0.65
