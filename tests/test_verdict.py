from dataclasses import replace

import numpy as np
import pytest
from drawn import flat_pair
from hypothesis import given
from hypothesis import strategies as st

from algorithms.fuse import fuse
from algorithms.gridmap import GridMap
from algorithms.observation import encounter
from algorithms.pose import Pose2
from algorithms.verdict import VerdictConfig, ambiguity_of, deviation_from, judge

REF, MOV, SEEN, T = flat_pair()
AT = encounter(SEEN)


def verdict_on(T_ref_mov, ambiguity=0.3, config=None, ref=REF, mov=MOV):
    return judge(fuse(ref, mov, T_ref_mov), T_ref_mov, AT, ambiguity, config or VerdictConfig())


def test_the_known_pose_is_accepted_with_its_numbers_in_the_sentence():
    verdict = verdict_on(T)
    assert verdict.accepted
    assert verdict.reason.startswith("Merged: ")
    assert f"{verdict.acceptance_index:.0%}" in verdict.reason
    assert verdict.deviation < 0.5


def test_a_turned_answer_is_refused_because_its_walls_do_not_coincide():
    about = AT.x_mov.tolist()
    turned = T @ Pose2(*about) @ Pose2(theta=np.pi / 2) @ Pose2(-about[0], -about[1])
    verdict = verdict_on(turned)
    assert not verdict.accepted
    assert "walls that both robots should have seen" in verdict.reason


def test_a_rival_nearly_as_good_is_a_reason_to_refuse():
    verdict = verdict_on(T, ambiguity=0.97)
    assert not verdict.accepted
    assert "another answer fits almost as well (97%" in verdict.reason


def test_an_answer_far_from_the_sighting_is_refused():
    beside = Pose2(1.5, 0, 0) @ T
    assert "standard deviations from where it was seen" in verdict_on(beside).reason


def test_too_little_in_common_is_refused_whatever_agrees():
    corner = GridMap(np.zeros((3, 3), dtype=np.int8), 0.05, MOV.origin)
    verdict = verdict_on(T, mov=corner)
    assert not verdict.accepted
    assert "too little to tell right from wrong" in verdict.reason


def test_every_doubt_is_named():
    reason = verdict_on(Pose2(1.5, 0, 1.0) @ T, ambiguity=0.99).reason
    assert reason.count(";") >= 2


@given(st.floats(0, 5), st.floats(0, 2 * np.pi))
def test_the_deviation_grows_with_the_distance_from_the_sighting(metres, direction):
    def at(distance):
        return deviation_from(Pose2(distance * np.cos(direction), distance * np.sin(direction)) @ T, AT, 0.05)

    assert at(metres + 0.1) > at(metres)


def test_one_standard_deviation_is_one():
    along = replace(AT, covariance=np.diag([0.3**2 - 0.05**2, 1.0]))
    assert deviation_from(Pose2(0.3, 0, 0) @ T, along, 0.05) == pytest.approx(1.0, rel=1e-3)


def test_an_answer_is_its_own_neighbours_keeper_and_rivals_are_elsewhere():
    best, neighbour = Pose2(0, 0, 0), Pose2(0.1, 0, 0.01)
    turned, moved = Pose2(0, 0, 3.1), Pose2(3.0, 0, 0)
    origin = np.zeros(2)
    assert ambiguity_of([(best, 10), (neighbour, 9.9)], origin, 0.7, 0.17) == 0
    assert ambiguity_of([(best, 10), (neighbour, 9.9), (turned, 6)], origin, 0.7, 0.17) == 0.6
    assert ambiguity_of([(best, 10), (moved, 8), (turned, 6)], origin, 0.7, 0.17) == 0.8


def test_without_any_evidence_everything_is_a_rival():
    assert ambiguity_of([(Pose2(), 0.0)], np.zeros(2), 0.7, 0.17) == 1.0
    assert ambiguity_of([], np.zeros(2), 0.7, 0.17) == 1.0
