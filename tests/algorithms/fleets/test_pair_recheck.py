"""Answers held against newer maps, and a robot's last map against its next."""

from __future__ import annotations

from math import radians

import numpy as np
import pytest
from explorers import exploration

from algorithms.common.pose import Pose2, pose_error
from algorithms.files.case_folder import Case
from algorithms.fleets.pair_hypotheses import PairOrder, find_pair
from algorithms.fleets.pair_recheck import correction_between, denied_share, recheck
from algorithms.observations.fleet import Fleet, FleetSighting
from algorithms.simulator.fleets.exploration import SlamCorrection

ORDER = PairOrder("ann", "bob", (0,))


@pytest.fixture(scope="module")
def fleet(small_case: Case) -> Fleet:
    (seen,) = small_case.observations
    return Fleet({"ann": small_case.ref, "bob": small_case.mov}, (FleetSighting("ann", "bob", seen),))


def test_on_the_same_maps_an_answer_is_as_likely_as_the_search_found_it(fleet):
    searched = find_pair(fleet, ORDER)
    checked = recheck(fleet, ORDER, [each.T_ref_mov for each in searched.hypotheses])
    assert checked.accepted
    assert checked.hypotheses[0].probability == pytest.approx(searched.hypotheses[0].probability, abs=0.02)


def test_an_answer_a_little_off_climbs_back_and_one_far_off_is_unlikely(fleet):
    (T, *_) = (each.T_ref_mov for each in find_pair(fleet, ORDER).hypotheses)
    beside = recheck(fleet, ORDER, [T @ Pose2(0.08, -0.06, 0.005)])
    assert beside.accepted
    distance, _ = pose_error(beside.hypotheses[0].T_ref_mov, T, fleet.sightings[0].observation.observer.xy)
    assert distance < 0.1
    assert not recheck(fleet, ORDER, [T @ Pose2(0.0, 0.0, radians(90))]).accepted


def test_a_map_that_grows_denies_nothing_and_one_that_is_turned_is_found_turned():
    plain, turned = exploration(), exploration(SlamCorrection("r3", 25, 3.0))
    before = plain.grid("r3", 24)
    assert denied_share(before, plain.grid("r3", 30)) < 0.01
    after = turned.grid("r3", 25)
    assert denied_share(before, after) > 0.03
    T = correction_between(before, after)
    truth = turned.true_transform("r3", 25).inverse() @ turned.true_transform("r3", 24)
    distance, angle = pose_error(T, truth, plain.pose("r3", 24).xy)
    assert distance < 0.1
    assert angle < radians(0.5)


def test_a_map_of_another_place_is_no_correction():
    robots = exploration()
    other = robots.grid("r1", 34)
    mirrored = other.mirrored()
    assert np.count_nonzero(mirrored.occupied)
    assert correction_between(robots.grid("r2", 34), mirrored) is None
