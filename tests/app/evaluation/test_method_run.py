"""One method on one pair: what counts as right."""

from dataclasses import replace
from math import radians

import pytest

from algorithms.common.pose import Pose2
from algorithms.files.truth_file import Truth
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
