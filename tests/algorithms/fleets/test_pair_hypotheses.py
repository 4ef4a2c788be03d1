"""What a merge of a pair hands over to the fleet: never more trust than the merge itself has."""

from __future__ import annotations

from dataclasses import replace
from math import exp, log

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from algorithms.files.case_folder import Case
from algorithms.fleets.fleet_merge import joined
from algorithms.fleets.pair_hypotheses import SUREST, PairFinding, PairOrder, find_pair, finding_of
from algorithms.methods.merge_result import CHOSEN, MergeResult
from algorithms.methods.registry import METHODS, default_method, merge
from algorithms.observations.fleet import Fleet, FleetSighting
from algorithms.observations.pair_problem import PairProblem

ORDER = PairOrder("a", "b", (0,))


@pytest.fixture(scope="module")
def two(small_case: Case) -> Fleet:
    maps = {"a": small_case.ref, "b": small_case.mov}
    return Fleet(maps, tuple(FleetSighting("a", "b", one) for one in small_case.observations))


@pytest.fixture(scope="module")
def result(small_case: Case) -> MergeResult:
    return merge(small_case.ref, small_case.mov, small_case.observations)


def found(case: Case, result: MergeResult) -> PairFinding:
    problem = PairProblem(case.ref, case.mov, case.observations)
    return finding_of(ORDER, problem, METHODS[default_method(problem)].defaults, result)


def odds(finding: PairFinding) -> float:
    """That its first answer is right, of this pair alone."""
    weights = [exp(each.weight) for each in finding.hypotheses]
    return weights[0] / (1 + sum(weights))


def test_an_answer_counts_as_much_as_its_merge_says(small_case, result):
    finding = found(small_case, result)
    assert finding.accepted
    assert odds(finding) == pytest.approx(min(result.verdict.probability, 1 - SUREST), abs=1e-3)


def test_two_robots_whose_merge_is_refused_are_not_put_together_however_likely_the_walls_find_it(
    small_case, two, result
):
    doubted = replace(result, verdict=replace(result.verdict, accepted=False))
    finding = found(small_case, doubted)
    assert odds(finding) < finding.accept_from
    assert set(joined(two, [found(small_case, result)]).placed) == {"a", "b"}
    assert set(joined(two, [finding]).placed) == {"a"}
    forced = joined(two, [finding], force=True)
    assert set(forced.placed) == {"a", "b"}
    assert forced.forced == {"b"}


def test_what_a_person_chose_is_sure_whatever_the_verdict_says(small_case, two, result):
    doubted = replace(result, method=CHOSEN, verdict=replace(result.verdict, accepted=False))
    finding = found(small_case, doubted)
    assert len(finding.hypotheses) == 1
    assert odds(finding) == pytest.approx(1 - SUREST)
    assert set(joined(two, [finding]).placed) == {"a", "b"}


def test_without_a_sighting_an_answer_must_be_as_likely_as_the_merge_asks_for(two):
    unsighted = replace(two, sightings=())
    finding = find_pair(unsighted, replace(ORDER, sightings=()))
    assert finding.accept_from == METHODS["whole-plane"].defaults.verdict.accept_from
    assert finding.accept_from > find_pair(two, ORDER).accept_from


@settings(max_examples=25, deadline=None)
@given(st.floats(0.3, 0.99), st.floats(0.5, 0.999))
def test_nobody_is_placed_who_is_less_likely_right_than_the_merge_asks_for(
    small_case, two, result, p, accept
):
    first = found(small_case, result)
    answer = replace(first.hypotheses[0], probability=p, weight=log(p / (1 - p)))
    finding = replace(first, hypotheses=(answer,), accept_from=accept)
    placed = joined(two, [finding]).placed
    assert ("b" in placed) == (p >= accept) or p == pytest.approx(accept)
