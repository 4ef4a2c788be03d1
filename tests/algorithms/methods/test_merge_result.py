"""What a merge ends with: one answer, judged, with all that was known of it."""

from __future__ import annotations

from dataclasses import fields, replace

import numpy as np
import pytest
from proofs import proof_state

from algorithms.common.pose import Pose2
from algorithms.methods.baselines.base import BaselineConfig
from algorithms.methods.merge_result import Answer, MergeResult
from algorithms.methods.shared_stages import Found, finish_merge
from algorithms.observations.pair_problem import PairProblem
from algorithms.verdict.decision import VerdictConfig, judge

COVARIANCE = np.diag([0.01, 0.02, 0.003])


@pytest.fixture
def finished(result, small_case):
    """``finished(...)`` ends a merge at the answer of the sample, with whatever else is given."""
    named = result.weighed[0]
    problem = PairProblem(small_case.ref, small_case.mov, small_case.observations)

    def finish(beside=None, timings_s=None, **given) -> MergeResult:
        answers = (Answer(named.T_ref_mov, 12.5, "still"),)
        found = Found(named, beside, COVARIANCE, answers, 12.5, **given)
        return finish_merge(problem, found, result.fusion, BaselineConfig(), "m", 3, timings_s or {})

    return finish


def test_it_ends_on_the_answer_that_was_named_and_keeps_what_it_was_given(result, finished):
    ended = finished(timings_s={"search": 0.5}, search_found_it=True)
    assert ended.T_ref_mov == result.weighed[0].T_ref_mov
    assert np.array_equal(ended.covariance, COVARIANCE)
    assert (ended.value, ended.method, ended.seed) == (12.5, "m", 3)
    assert ended.answers[0].stopped == "still"
    assert ended.fusion is result.fusion
    assert np.array_equal(ended.encounter.x_ref, result.encounters[0].x_ref)
    assert ended.timings_s == {"search": 0.5}
    assert ended.search_found_it is True


def test_its_verdict_is_the_one_that_judging_the_same_answer_gives(result, finished):
    named = result.weighed[0]
    turned = replace(named, T_ref_mov=named.T_ref_mov @ Pose2(theta=0.4))
    for beside in (None, (), (turned,)):
        alone = judge(result.fusion, named, beside, result.pivot, VerdictConfig())
        assert finished(beside).verdict == alone
    assert finished().verdict.accepted
    assert not finished(doubts=["it was stopped"]).verdict.accepted


def test_other_answers_are_weighed_after_the_named_one_in_their_order(result, finished):
    named = result.weighed[0]
    others = tuple(replace(named, score=named.score - k) for k in (1, 2))
    assert finished(others).weighed == (named, *others)
    assert finished().weighed == (named,)
    assert finished(others).verdict.ambiguity is not None
    assert finished().verdict.ambiguity is None


@pytest.mark.parametrize(
    ("proof", "proven"), [(None, False), (proof_state(), True), (proof_state(proven=False), False)]
)
def test_only_a_proof_that_was_finished_makes_an_answer_proven(finished, proof, proven):
    assert finished(proof=proof).proven_optimal is proven


def test_a_hint_changes_nothing_but_the_hint(finished):
    plain = finished()
    hinted = plain.with_hint("mirrored")
    assert plain.verdict.hint == ""
    assert hinted.verdict == replace(plain.verdict, hint="mirrored")
    for field in fields(MergeResult):
        if field.name != "verdict":
            assert getattr(hinted, field.name) is getattr(plain, field.name), field.name
