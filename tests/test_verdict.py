from dataclasses import replace

import numpy as np
import pytest
from drawn import flat_pair
from hypothesis import given
from hypothesis import strategies as st

from algorithms.evidence import Evidence, evidence
from algorithms.fuse import fuse
from algorithms.observation import encounter
from algorithms.pose import Pose2
from algorithms.verdict import Rival, VerdictConfig, deviation_from, judge, others

REF, MOV, SEEN, T = flat_pair()
AT = encounter(SEEN)
CLEAN = Evidence(100.0, 1.0, 98.0, 3.0)
FUSION = fuse(REF, MOV, T)
TURNED = T @ Pose2(*AT.x_mov.tolist()) @ Pose2(theta=np.pi) @ Pose2(*(-AT.x_mov).tolist())


def verdict_on(weighed=CLEAN, T_ref_mov=T, rivals=(), doubts=(), encounters=(AT,), **config):
    return judge(FUSION, weighed, T_ref_mov, encounters, rivals, VerdictConfig(**config), doubts=doubts)


def after_slipping(contradiction, before, metres):
    """Evidence over so many metres of wall, a share of which contradicts after and before slipping."""
    return Evidence(
        metres * (1 - contradiction), metres * contradiction, metres * (1 - before), metres * before
    )


def test_the_known_pose_is_accepted_with_its_numbers_in_the_sentence():
    verdict = verdict_on(evidence(REF, MOV, T))
    assert verdict.accepted
    assert verdict.reason.startswith("Merged: ")
    assert f"{1 - verdict.contradiction:.0%}" in verdict.reason
    assert f"{verdict.shared_wall:.0f} m" in verdict.reason
    assert verdict.deviation < 0.5


def test_a_wrong_turn_is_refused_because_the_maps_disagree():
    verdict = verdict_on(evidence(REF, MOV, TURNED), TURNED)
    assert not verdict.accepted
    assert "the maps disagree on" in verdict.reason


def test_too_little_wall_in_common_is_refused_whatever_agrees():
    verdict = verdict_on(after_slipping(0.0, 0.0, 8.0))
    assert not verdict.accepted
    assert "only 8 m of wall were seen by both robots" in verdict.reason


@given(st.floats(0, 1), st.floats(0, 1), st.floats(19, 500))
def test_more_contradiction_never_turns_a_refusal_into_a_merge(contradiction, more, metres):
    little = verdict_on(after_slipping(contradiction, 0.9, metres))
    much = verdict_on(after_slipping(min(1.0, contradiction + more), 0.9, metres))
    assert little.accepted or not much.accepted


@given(st.floats(0, 1), st.floats(0, 1), st.floats(0, 500), st.floats(0, 500))
def test_more_wall_never_turns_a_merge_into_a_refusal(contradiction, before, metres, more):
    short = verdict_on(after_slipping(contradiction, before, metres))
    long = verdict_on(after_slipping(contradiction, before, metres + more))
    assert long.accepted or not short.accepted


def test_contradictions_are_forgiven_where_they_go_away_when_patches_slip_and_much_wall_agrees():
    assert verdict_on(after_slipping(0.2, 0.45, 120.0)).accepted
    assert not verdict_on(after_slipping(0.2, 0.25, 120.0)).accepted  # slipping mends little: not bent, wrong
    assert not verdict_on(after_slipping(0.2, 0.45, 40.0)).accepted  # too little wall for so vague a fit
    assert not verdict_on(after_slipping(0.4, 0.8, 120.0)).accepted


def test_a_rival_nearly_as_good_is_a_reason_to_refuse_that_says_where_it_is():
    verdict = verdict_on(rivals=[Rival(TURNED, 0.97, CLEAN)])
    assert not verdict.accepted
    assert "two answers fit almost equally well, 180° apart: a second observation would decide" in (
        verdict.reason
    )
    assert verdict.rival == TURNED
    moved = Pose2(1.2, 0.0, 0.0) @ T
    assert "1.2 m apart" in verdict_on(rivals=[Rival(moved, 0.97, CLEAN)]).reason


def test_a_rival_that_the_rest_of_the_maps_contradicts_is_none():
    verdict = verdict_on(rivals=[Rival(TURNED, 0.97, after_slipping(0.4, 0.5, 100.0))])
    assert verdict.accepted
    assert verdict.ambiguity == 0.97
    assert verdict.rival is None


def test_a_weaker_rival_counts_where_it_is_clean_and_the_answer_is_not():
    rival = Rival(TURNED, 0.6, CLEAN)
    assert verdict_on(rivals=[rival]).accepted
    doubted = verdict_on(after_slipping(0.2, 0.45, 120.0), rivals=[rival])
    assert not doubted.accepted
    assert "another answer, 180° apart, is contradicted less" in doubted.reason


@given(st.floats(18, 100), st.floats(18, 100), st.floats(0.5, 1), st.floats(0.5, 1))
def test_less_wall_and_a_nearer_rival_never_turn_a_refusal_into_a_merge(wall, other, share, higher):
    least, most = sorted((wall, other))
    near, nearer = sorted((share, higher))
    doubted = verdict_on(after_slipping(0, 0, least), rivals=[Rival(TURNED, nearer, CLEAN)])
    assured = verdict_on(after_slipping(0, 0, most), rivals=[Rival(TURNED, near, CLEAN)])
    assert assured.accepted or not doubted.accepted


def test_where_little_wall_speaks_a_rival_counts_whatever_contradicts_it():
    rival = Rival(TURNED, 0.6, after_slipping(0.5, 0.5, 100.0))
    assert verdict_on(after_slipping(0.0, 0.0, 40.0), rivals=[rival]).accepted
    little = verdict_on(after_slipping(0.0, 0.0, 20.0), rivals=[rival])
    assert not little.accepted
    assert "is not ruled out by so little wall" in little.reason


def test_any_of_several_rivals_is_enough():
    harmless = Rival(TURNED, 0.99, after_slipping(0.5, 0.5, 100.0))
    assert not verdict_on(rivals=[harmless, Rival(TURNED, 0.9, CLEAN)]).accepted


def test_an_answer_far_from_a_sighting_is_refused():
    beside = Pose2(1.5, 0, 0) @ T
    assert "standard deviations from where it was seen" in verdict_on(T_ref_mov=beside).reason


def test_of_several_sightings_the_worst_counts():
    elsewhere = replace(AT, x_ref=AT.x_ref + (0.0, 2.0))
    assert verdict_on(encounters=(AT,)).accepted
    assert not verdict_on(encounters=(AT, elsewhere)).accepted
    assert verdict_on(encounters=(AT, elsewhere)).deviation == verdict_on(encounters=(elsewhere,)).deviation


def test_every_doubt_is_named():
    told = ["the search was stopped before it had ruled out a better place"]
    verdict = verdict_on(
        after_slipping(0.5, 0.5, 50.0), Pose2(1.5, 0, 1.0) @ T, [Rival(TURNED, 0.99, CLEAN)], told
    )
    assert verdict.reason.count(";") == 3
    assert told[0] in verdict.reason


def test_a_method_without_rivals_says_so():
    assert verdict_on(rivals=None).ambiguity is None
    assert verdict_on(rivals=[]).ambiguity == 0.0


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
    turned, beside, moved = Pose2(0, 0, 3.1), Pose2(0, 0.1, 3.1), Pose2(3.0, 0, 0)
    origin = np.zeros(2)
    assert others([(best, 10), (neighbour, 9.9)], origin, 0.7, 0.17) == []
    found = others([(best, 10), (neighbour, 9.9), (turned, 6), (beside, 5), (moved, 4)], origin, 0.7, 0.17)
    assert found == [(turned, 6), (moved, 4)]
    assert others([], origin, 0.7, 0.17) == []
