"""The best few answers held against the whole maps: they climb, come together, and the likeliest is named."""

from __future__ import annotations

from dataclasses import replace
from math import radians

import numpy as np
import pytest
from drawn import flat_pair
from hypothesis import given, settings
from hypothesis import strategies as st

from algorithms.common import parallel_kernels as kernels
from algorithms.common.pose import Pose2, pose_error
from algorithms.maps.grid_map import OCCUPIED
from algorithms.methods.registry import METHODS, merge
from algorithms.observations.observation import encounter, robots_of
from algorithms.observations.search_window import WindowConfig, coupled_window
from algorithms.optimisation.particle_swarm import SwarmConfig
from algorithms.simulator.odometry_drift import OdometryDrift
from algorithms.simulator.robot import Conditions
from algorithms.simulator.scenario import simulate
from algorithms.verdict.probability_model import shipped_model
from algorithms.verdict.ranking import better_beside, elsewhere, probability_of, ranked, weigh
from algorithms.verdict.whole_maps import WORTH_MOVING, make_whole_maps

REF, MOV, SEEN, T = flat_pair()
AT = encounter(SEEN)
MODEL = shipped_model()
APART = 0.7, radians(10)
DEFAULT = replace(METHODS["spectra-proven"].defaults, swarm=SwarmConfig(particles=10, iterations=1))


def whole_of(ref, mov, at):
    return make_whole_maps(ref, mov, robots_of([at], 0.4), coupled_window([at], WindowConfig()), 0.25)


WHOLE = whole_of(REF, MOV, AT)


def about(dx: float, dy: float, degrees: float) -> Pose2:
    """T, moved by so much at robot 2, and turned about it."""
    x, y = T.apply(AT.x_mov) + (dx, dy)
    turned = Pose2(0, 0, T.theta + radians(degrees)).apply(AT.x_mov)
    return Pose2(x - turned[0], y - turned[1], T.theta + radians(degrees))


TURNED = about(0.0, 0.0, 180.0)


@settings(max_examples=25, deadline=None)
@given(st.floats(-0.4, 0.4), st.floats(-0.4, 0.4), st.floats(-4, 4))
def test_an_answer_climbs_to_the_known_pose_and_never_down(dx, dy, degrees):
    begun = about(dx, dy, degrees)
    found = WHOLE.climb(begun)
    assert WHOLE.crisp.value_at(found) >= WHOLE.crisp.value_at(begun)
    distance, turn = pose_error(found, T, AT.x_mov)
    assert found == begun or (distance < 0.08 and turn < radians(1))
    assert found != begun or WHOLE.crisp.value_at(T) < WHOLE.crisp.value_at(begun) + 2 * WORTH_MOVING


def test_a_robot_that_stands_in_the_others_map_does_not_move_the_climb():
    """Map 1 shows robot 2, where it was seen, as a block of wall."""
    cells = REF.cells.copy()
    col, row = REF.grid_coordinates(AT.x_ref).astype(int)
    cells[row - 2 : row + 3, col - 2 : col + 3] = OCCUPIED
    seen = whole_of(replace(REF, cells=cells), MOV, AT)
    assert seen.crisp.value_at(T) == pytest.approx(WHOLE.crisp.value_at(T), abs=0.3)
    blind = make_whole_maps(seen.ref.grid, seen.mov.grid, robots_of([AT], 0.0), WHOLE.window, 0.25)
    assert blind.crisp.value_at(T) < WHOLE.crisp.value_at(T) - 0.5


def test_an_answer_at_the_top_stays_where_it_is():
    assert WHOLE.climb(T) == T


def test_answers_that_come_to_one_place_are_told_once_the_likeliest_first():
    found = ranked(WHOLE, [about(0.3, 0.1, 2), T, about(-0.2, 0.2, -3), TURNED], MODEL, *APART)
    assert pose_error(found[0].T_ref_mov, T, AT.x_mov)[0] < 0.08
    assert [each.score for each in found] == sorted((each.score for each in found), reverse=True)
    for one in found:
        others = [each for each in found if each is not one]
        assert elsewhere(WHOLE, one, others, *APART) == tuple(others)
    assert probability_of(found[0], found[1:]) > 0.9


def test_the_order_in_which_answers_come_does_not_matter():
    answers = [TURNED, about(0.3, 0.1, 2), T]
    there, back = ranked(WHOLE, answers, MODEL, *APART), ranked(WHOLE, answers[::-1], MODEL, *APART)
    assert there[0].score == pytest.approx(back[0].score, abs=0.2)


def test_a_transform_off_its_hill_has_a_better_one_beside_it_and_one_on_top_has_none():
    off = weigh(WHOLE, about(0.4, 0.0, 0.0), MODEL)
    (beside,) = better_beside(WHOLE, off, MODEL)
    assert beside.score > off.score
    assert probability_of(off, [beside]) < 0.5
    assert better_beside(WHOLE, weigh(WHOLE, T, MODEL), MODEL) == ()


def test_what_the_whole_maps_say_does_not_depend_on_the_number_of_threads(monkeypatch):
    found = weigh(WHOLE, about(0.1, 0.0, 1.0), MODEL)
    monkeypatch.setattr(kernels, "cores", lambda: 1)
    alone = weigh(whole_of(REF, MOV, AT), about(0.1, 0.0, 1.0), MODEL)
    assert alone.evidence == found.evidence
    assert alone.score == found.score


@pytest.fixture(scope="module")
def bent_case():
    """An office whose second robot bends a straight wall of 15 m by up to a metre."""
    straight, bent = Conditions(), Conditions(drift=OdometryDrift(bend=1.0))
    return simulate("office", 13, (0.7, 0.7), conditions=(bent, straight, straight)).cases[0]


def test_the_whole_maps_bring_a_bent_map_nearer_to_the_truth_than_the_search_alone(bent_case):
    case = bent_case
    alone = merge(case.ref, case.mov, case.observations, config=replace(DEFAULT, whole_maps=False))
    whole = merge(case.ref, case.mov, case.observations, config=DEFAULT)
    assert whole.weighed[0].moved
    off = [sum(pose_error(each.T_ref_mov, case.T_ref_mov, each.pivot)) for each in (alone, whole)]
    assert off[1] < off[0]
    assert whole.verdict.rigid_contradiction < alone.verdict.rigid_contradiction


def test_the_covariance_goes_with_the_answer_that_was_moved(bent_case):
    case = bent_case
    result = merge(case.ref, case.mov, case.observations, config=DEFAULT)
    assert np.linalg.eigvalsh(result.covariance).min() > 0
    assert result.value is not None
