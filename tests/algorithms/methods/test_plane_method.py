"""Maps merge from any knowledge or none, and end as from a sighting; what contradicts itself is refused."""

from __future__ import annotations

from dataclasses import replace
from math import pi, radians

import numpy as np
import pytest

from algorithms.common.errors import SettingError
from algorithms.common.pose import Pose2, pose_error
from algorithms.methods.merge_result import MergeResult
from algorithms.methods.registry import METHODS, PLANE_METHOD, default_method, merge, run
from algorithms.methods.steps import PlaneDetail
from algorithms.observations.pair_problem import PairProblem
from algorithms.observations.priors import InitialPose, NearPlace, TurnPrior


@pytest.fixture(scope="module")
def alone(small_case) -> MergeResult:
    """The flat, merged by its walls alone."""
    return merge(small_case.ref, small_case.mov)


def is_at(result: MergeResult, T: Pose2) -> bool:
    """Whether an answer is a transform, within 0.1 m and a degree."""
    distance, angle = pose_error(result.T_ref_mov, T, result.pivot)
    return distance < 0.1 and angle < radians(1)


def test_without_a_sighting_the_true_place_is_found(small_case, alone):
    assert alone.method == PLANE_METHOD
    assert alone.encounters == ()
    assert is_at(alone, small_case.truth.T_ref_mov)


@pytest.mark.parametrize("kind", ["initial", "turn", "near", "ring"])
def test_whatever_is_known_the_same_place_is_found(small_case, alone, kind):
    o, T = small_case.observations[0], small_case.truth.T_ref_mov
    at = T.apply(alone.pivot).tolist()
    known = {
        "initial": InitialPose(Pose2(T.x + 0.5, T.y - 0.5, T.theta + 0.1)),
        "turn": TurnPrior(T.theta - 0.1),
        "near": NearPlace(at[0] + 0.5, at[1], *alone.pivot.tolist()),
        "ring": replace(o, range=o.range + 0.5, bearing=0.0, sigma_range=1.0, sigma_bearing=pi),
    }[kind]
    found = merge(small_case.ref, small_case.mov, known, PLANE_METHOD)
    assert is_at(found, alone.T_ref_mov)
    assert len(found.weighed[0].deviations) == 1


def test_the_turns_are_told_one_batch_after_another_with_the_best_places_so_far(small_case):
    told = [step.detail for step in run(None, small_case.ref, small_case.mov) if step.stage == "correlate"]
    assert all(isinstance(detail, PlaneDetail) for detail in told)
    assert [detail.done for detail in told] == sorted({detail.done for detail in told})
    assert told[-1].done == told[-1].total
    tops = [float(detail.values[0]) for detail in told if len(detail.values)]
    assert tops == sorted(tops)
    for detail in told:
        tried = np.isfinite(detail.tops)
        assert not tried[detail.done :].any()
        assert np.nanmax(detail.tops) == pytest.approx(float(detail.values[0]))
        assert detail.picture.turn in detail.turns[: detail.done]


def test_the_method_suits_what_is_known(small_case):
    o = small_case.observations[0]
    vague = replace(o, sigma_range=1.0, sigma_bearing=pi)
    for known, plane in (((), True), ((o,), False), ((vague,), True)):
        problem = PairProblem.of(small_case.ref, small_case.mov, known)
        assert (default_method(problem) == PLANE_METHOD) is plane


def test_settings_without_a_name_are_run_with_the_method_they_belong_to(small_case):
    o = replace(small_case.observations[0], sigma_range=1.0, sigma_bearing=pi)
    settings = METHODS[PLANE_METHOD].defaults
    assert (
        merge(small_case.ref, small_case.mov, small_case.observations, config=settings).method == PLANE_METHOD
    )
    with pytest.raises(SettingError, match="settings of the kind int"):
        merge(small_case.ref, small_case.mov, o, config=3)


def test_a_method_that_needs_a_sighting_says_so(small_case):
    with pytest.raises(SettingError, match=f"needs an observation.*{PLANE_METHOD}"):
        merge(small_case.ref, small_case.mov, method="spectra-swarm")


def test_an_initial_pose_that_contradicts_a_sighting_is_named(small_case):
    T = small_case.truth.T_ref_mov
    far = InitialPose(Pose2(T.x + 20, T.y, T.theta), 0.5, 0.5, 0.1)
    with pytest.raises(SettingError, match=r"initial pose.*observation"):
        merge(small_case.ref, small_case.mov, (small_case.observations[0], far))
    with pytest.raises(SettingError, match=r"initial pose.*turn"):
        merge(small_case.ref, small_case.mov, (far, TurnPrior(T.theta + pi)))
