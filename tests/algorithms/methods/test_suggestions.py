"""A merge suggests its best few answers; together they are no likelier than one."""

from __future__ import annotations

from dataclasses import replace

import pytest

from algorithms.common.pose import Pose2
from algorithms.methods.manual_merge import ManualMerge, known_answers
from algorithms.methods.merge_result import CHOSEN, MergeResult
from algorithms.methods.registry import METHODS, PLANE_METHOD, merge
from algorithms.methods.suggestions import MOST, suggested, suggestions_of
from algorithms.observations.pair_problem import PairProblem


@pytest.fixture(scope="module")
def refused(strangers) -> MergeResult:
    """Two maps of different buildings, from their walls alone."""
    return merge(strangers.ref, strangers.mov)


def test_the_named_answer_comes_first_and_the_others_lie_elsewhere(refused):
    first, *others = suggestions_of(refused)
    assert first.T_ref_mov == refused.T_ref_mov
    assert first.probability == pytest.approx(refused.verdict.probability)
    assert len({each.T_ref_mov for each in (first, *others)}) == len(others) + 1 <= MOST
    assert [each.number for each in (first, *others)] == list(range(1, len(others) + 2))


def test_the_likelier_comes_first_and_all_together_are_likely_to_one_at_most(refused):
    likely = [each.probability for each in suggestions_of(refused)]
    assert likely == sorted(likely, reverse=True)
    assert 0 < sum(likely) <= 1


def test_twins_of_one_score_are_alike_likely_and_each_speaks_against_the_other(refused):
    (named, *_) = refused.weighed
    twin = replace(named, T_ref_mov=Pose2(named.T_ref_mov.x + 9.0, named.T_ref_mov.y, 0.0))
    likely = replace(named, score=6.0), replace(twin, score=6.0)
    first, second = suggestions_of(replace(refused, weighed=likely))
    assert first.probability == pytest.approx(second.probability)
    assert 0.4 < first.probability < 0.5
    assert "others" in first.against
    assert "others" in second.against


def test_a_transform_is_known_as_the_suggestion_that_it_is(refused):
    (first, *_) = suggestions_of(refused)
    assert suggested(refused, first.T_ref_mov).number == 1
    T = first.T_ref_mov
    assert suggested(refused, Pose2(T.x + 0.01, T.y, T.theta)) is None


def test_what_a_person_takes_is_weighed_as_before_and_told_to_be_theirs(refused, strangers):
    problem = PairProblem(strangers.ref, strangers.mov)
    manual = ManualMerge(problem, METHODS[PLANE_METHOD].defaults, known_answers(refused))
    second = suggestions_of(refused)[-1]
    taken = manual.weigh(second.T_ref_mov, method=CHOSEN)
    assert taken.by_person
    assert not refused.by_person
    assert taken.T_ref_mov == second.T_ref_mov
    assert taken.verdict.probability == pytest.approx(second.probability, abs=0.02)
