"""A transform made by hand is weighed like any other, and refining it never makes it worse."""

from __future__ import annotations

from math import radians

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from algorithms.common.errors import SettingError
from algorithms.common.pose import Pose2, pose_error
from algorithms.methods.manual_merge import ManualMerge, known_answers, refine
from algorithms.methods.merge_result import BY_HAND, MergeResult
from algorithms.methods.registry import DEFAULT_METHOD, METHODS, PLANE_METHOD, merge
from algorithms.methods.steps import RefineDetail
from algorithms.observations.pair_problem import PairProblem

DEFAULTS = METHODS[DEFAULT_METHOD].defaults


def problem_of(case) -> PairProblem:
    return PairProblem(case.ref, case.mov, case.observations)


@pytest.fixture(scope="module")
def scales(small_case, result) -> ManualMerge:
    return ManualMerge(problem_of(small_case), DEFAULTS, known_answers(result))


def about(T: Pose2, at: np.ndarray, dx: float, dy: float, turn: float) -> Pose2:
    """T, moved by so much where it puts a point of the mov frame, and turned about it."""
    x, y = T.apply(at) + (dx, dy)
    turned = Pose2(0, 0, T.theta + turn).apply(at)
    return Pose2(x - turned[0], y - turned[1], T.theta + turn)


def test_the_methods_own_answer_weighs_the_same_by_hand(scales, result):
    hand = scales.weigh(result.T_ref_mov)
    assert hand.method == BY_HAND
    assert hand.value == pytest.approx(result.value)
    assert np.array_equal(hand.fusion.merged.cells, result.fusion.merged.cells)
    assert hand.verdict == result.verdict
    assert hand.covariance == pytest.approx(result.covariance, rel=1e-6)


def test_a_wrong_hand_is_refused_and_told_that_another_answer_fits_better(scales, result):
    wrong = about(result.T_ref_mov, result.pivot, 0.3, 0.0, radians(90))
    verdict = scales.weigh(wrong).verdict
    assert not verdict.accepted
    assert verdict.reason.startswith("Refused: ")
    assert "he walls fit better" in verdict.reason
    assert verdict.rival == result.T_ref_mov
    assert verdict.ambiguity > 1


@pytest.mark.parametrize("method", ["spectra-proven", "spectra-swarm", "bilateral"])
@pytest.mark.parametrize(("dx", "dy", "turn"), [(0.4, 0.0, 0.0), (0.0, -0.25, 0.0), (0.1, 0.1, 3.0)])
def test_a_hand_beside_the_right_place_is_refused_although_bent_maps_may_slip_so_far(
    small_case, result, method, dx, dy, turn
):
    beside = about(result.T_ref_mov, result.pivot, dx, dy, radians(turn))
    config = METHODS[method].defaults
    verdict = ManualMerge(problem_of(small_case), config).weigh(beside).verdict
    assert not verdict.accepted
    assert "fit better" in verdict.reason


def test_a_hand_far_off_the_sighting_is_told_so(scales, result):
    away = about(result.T_ref_mov, result.pivot, 3.0, 0.0, 0.0)
    assert "standard deviations from where it was seen" in scales.weigh(away).verdict.reason


@settings(max_examples=6, suppress_health_check=[HealthCheck.function_scoped_fixture], deadline=None)
@given(st.floats(-0.5, 0.5), st.floats(-0.5, 0.5), st.floats(-3, 3), st.integers(0, 9))
def test_refining_ends_no_lower_than_it_began_and_near_the_best(scales, result, dx, dy, degrees, seed):
    begun = about(result.T_ref_mov, result.pivot, dx, dy, radians(degrees))
    last = [step.detail for step in refine(scales, begun, seed)][-1]
    assert isinstance(last, MergeResult)
    assert last.method == BY_HAND
    assert last.value >= scales.value(begun)
    assert last.value >= 0.98 * result.value
    distance, turn = pose_error(last.T_ref_mov, result.T_ref_mov, result.pivot)
    assert distance < 0.1
    assert turn < radians(1)


def test_refining_tells_the_swarm_and_the_same_seed_gives_the_same_answer(scales, result):
    begun = about(result.T_ref_mov, result.pivot, 0.3, -0.2, radians(2))
    first, second = ([step.detail for step in refine(scales, begun, 5)] for _ in range(2))
    assert sum(isinstance(detail, RefineDetail) for detail in first) > 3
    assert first[-1].T_ref_mov == second[-1].T_ref_mov


def test_a_hand_outside_of_the_window_can_be_refined_too(scales, result):
    away = about(result.T_ref_mov, result.pivot, 6.0, 6.0, 0.0)
    *_, last = refine(scales, away, 0)
    assert last.detail.value >= scales.value(away)


def test_a_method_that_maximises_nothing_weighs_but_does_not_refine(small_case, result):
    plain = ManualMerge(problem_of(small_case), METHODS["bilateral"].defaults)
    assert plain.weigh(result.T_ref_mov).value is None
    assert np.linalg.eigvalsh(plain.weigh(result.T_ref_mov).covariance).min() > 0
    with pytest.raises(SettingError, match="maximises nothing; choose one that does"):
        next(refine(plain, result.T_ref_mov))


def test_maps_are_never_touched_and_merging_twice_gives_the_same(small_case, result, scales):
    before = [grid.cells.tobytes() for grid in (small_case.ref, small_case.mov)]
    scales.weigh(Pose2(1, 2, 3))
    again = merge(small_case.ref, small_case.mov, small_case.observations)
    assert [grid.cells.tobytes() for grid in (small_case.ref, small_case.mov)] == before
    assert again.T_ref_mov == result.T_ref_mov
    assert again.fusion.merged.cells.tobytes() == result.fusion.merged.cells.tobytes()


def test_without_a_sighting_a_hand_weighs_as_the_search_over_the_plane_does(small_case):
    found = merge(small_case.ref, small_case.mov)
    problem = PairProblem(small_case.ref, small_case.mov)
    manual = ManualMerge(problem, METHODS[PLANE_METHOD].defaults, known_answers(found))
    hand = manual.weigh(found.T_ref_mov)
    assert hand.kind == found.kind
    assert hand.verdict.probability == pytest.approx(found.verdict.probability, abs=0.01)
    assert hand.value == pytest.approx(found.value)
    beside = about(found.T_ref_mov, found.pivot, 0.1, -0.1, 0.01)
    *_, last = refine(manual, beside)
    assert last.detail.value >= manual.value(beside)
    assert max(pose_error(last.detail.T_ref_mov, found.T_ref_mov, found.pivot)) < 0.05
