"""The merges that the lesson compares: each knows more than the one before, and searches less."""

from __future__ import annotations

from math import radians

import pytest

from algorithms.common.pose import pose_error
from algorithms.methods.steps import PlaneDetail
from algorithms.observations.pair_problem import PairProblem
from app.model.merge_inputs import MergeInputs
from app.model.run_state import RunState
from app.page.lesson.side_runs import VAGUE, SideRuns, knowledge_runs


@pytest.fixture(scope="module")
def runs(small_case) -> SideRuns:
    """All of them over."""
    found = knowledge_runs(MergeInputs.of(small_case))
    for one in found.each:
        one.run = RunState(one.job.config)
        for step in one.job.run({}):
            one.run.add(step)
    return found


def test_the_more_is_known_the_fewer_shifts_are_left_and_the_truth_is_among_them(runs, small_case):
    searched = [one.run.get(PlaneDetail).searched for one in runs.each]
    assert searched[0] > 2 * searched[1] > 4 * searched[2]
    truth = small_case.truth.T_ref_mov
    for one in runs.each:
        problem = PairProblem.of(one.job.ref, one.job.mov, one.job.known)
        assert problem.window(one.job.config.window, curved=True).contains(truth.array()[None]).all()
        distance, angle = pose_error(one.result.T_ref_mov, truth, one.result.pivot)
        assert distance < 0.1
        assert angle < radians(1)


def test_the_vague_place_is_given_as_far_off_as_it_is_vague(runs, small_case):
    _, vague, exact = runs.each
    assert sum((vague.place - exact.place) ** 2) == pytest.approx(VAGUE**2)
    assert exact.place == pytest.approx(MergeInputs.of(small_case).at.x_ref)


def test_one_is_at_work_after_another_until_all_are_over(small_case, runs):
    fresh = knowledge_runs(MergeInputs.of(small_case))
    for k, (one, over) in enumerate(zip(fresh.each, runs.each, strict=True)):
        assert fresh.at_work is None
        assert fresh.done is None
        assert fresh.next is fresh.of(one.job) is one
        one.run = RunState(one.job.config)
        assert fresh.at_work is one
        assert fresh.done == pytest.approx(k / 3)
        one.run = over.run
    assert fresh.next is None
