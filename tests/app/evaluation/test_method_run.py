"""One method on one pair: what counts as right."""

from dataclasses import replace
from math import radians

import numpy as np
import pytest

from algorithms.common.pose import Pose2, pose_error
from algorithms.files.truth_file import Truth
from algorithms.methods.registry import merge
from app.evaluation.method_run import judge_case


def off_by(case, result, metres=0.0, angle=0.0, **truth):
    """The case with a truth so far from the result, at the seen robot."""
    at = result.pivot
    x, y = result.T_ref_mov.apply(at).tolist()
    turn = Pose2(theta=result.T_ref_mov.theta + angle)
    dx, dy = turn.apply(at).tolist()
    return replace(case, truth=Truth(Pose2(x + metres - dx, y - dy, turn.theta), **truth))


@pytest.mark.parametrize(
    ("metres", "degrees", "right", "fine"),
    [
        (0.14, 0.9, True, True),
        (0.16, 0.9, True, False),
        (0.14, 1.1, True, False),
        (0.49, 2.9, True, False),
        (0.51, 0.0, False, False),
        (0.0, -3.1, False, False),
    ],
)
def test_right_and_fine_are_within_the_stated_distance_and_angle(
    small_case, result, metres, degrees, right, fine
):
    truth = judge_case(off_by(small_case, result, metres, radians(degrees)), result)
    assert truth.distance == pytest.approx(metres, abs=1e-9)
    assert truth.angle == pytest.approx(abs(radians(degrees)), abs=1e-9)
    assert (truth.right, truth.fine) == (right, fine)


def test_the_distance_is_taken_at_the_seen_robot_not_at_the_origin(small_case, result):
    truth = judge_case(off_by(small_case, result, 0.0, radians(2)), result)
    assert truth.distance == pytest.approx(0.0, abs=1e-9)


def test_a_case_may_state_a_tolerance_of_its_own(small_case, result):
    case = off_by(small_case, result, 0.8, radians(4), tolerance_m=1.0, tolerance_rad=radians(5))
    assert judge_case(case, result).right


@pytest.mark.parametrize("accepted", [True, False])
def test_two_maps_of_different_places_are_right_when_refused(small_case, result, accepted):
    case = replace(small_case, truth=Truth(None, expected="refuse"))
    verdict = replace(result.verdict, accepted=accepted)
    truth = judge_case(case, replace(result, verdict=verdict))
    assert truth.right is not accepted
    assert truth.distance is None


def test_a_merge_that_was_not_told_of_the_seen_robot_is_judged_there_all_the_same(small_case):
    found = merge(small_case.ref, small_case.mov)
    seen = small_case.observations[0]
    at = np.array([seen.observed_x, seen.observed_y])
    assert np.hypot(*(found.pivot - at)) > 0.5
    truth = Truth(found.T_ref_mov @ Pose2(theta=radians(2)))
    told = judge_case(replace(small_case, truth=truth), found)
    assert told.distance == pytest.approx(pose_error(found.T_ref_mov, truth.T_ref_mov, at)[0])
    alone = judge_case(replace(small_case, truth=truth, observations=()), found)
    assert alone.distance == pytest.approx(pose_error(found.T_ref_mov, truth.T_ref_mov, found.pivot)[0])
    assert alone.distance != pytest.approx(told.distance)


@pytest.mark.parametrize(("place", "among"), [(0, True), (1, True), (4, True), (5, False)])
def test_a_right_answer_counts_among_the_first_five(small_case, result, place, among):
    far = Pose2(30.0, 30.0, 1.0)
    answers = [replace(result.weighed[0], T_ref_mov=far)] * 8
    answers[place] = replace(answers[place], T_ref_mov=small_case.truth.T_ref_mov)
    found = replace(result, T_ref_mov=answers[0].T_ref_mov, weighed=tuple(answers))
    truth = judge_case(small_case, found)
    assert (truth.right, truth.among_five) == (place == 0, among)
    refuse = replace(small_case, truth=replace(small_case.truth, expected="refuse"))
    assert not judge_case(refuse, found).among_five
