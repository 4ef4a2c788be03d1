"""Of the pairs' answers those are chosen that are true together, whatever the lies and the order."""

from __future__ import annotations

from math import log

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from algorithms.common.pose import Pose2
from algorithms.fleets.consistent_set import AnswerGraph
from algorithms.fleets.fleet_merge import probability_of
from algorithms.fleets.pair_hypotheses import Hypothesis, PairFinding, PairOrder

COVARIANCE = np.diag([0.03, 0.03, 0.005]) ** 2
AREA = 1e4


def hypothesis(T: Pose2, probability: float, none: float | None = None) -> Hypothesis:
    none = 1 - probability if none is None else none
    return Hypothesis(T, COVARIANCE, probability, log(probability / none))


def finding(number: int, ref: str, mov: str, *answers: Hypothesis) -> PairFinding:
    return PairFinding(PairOrder(ref, mov, (number,)), np.zeros(2), answers, "")


def world(seed: int, robots: int) -> tuple[np.random.Generator, dict[str, Pose2]]:
    """Names and true poses."""
    rng = np.random.default_rng(seed)
    return rng, {f"r{k}": Pose2(*rng.uniform(-20, 20, 2), rng.uniform(-3, 3)) for k in range(robots)}


def true(poses: dict[str, Pose2], ref: str, mov: str) -> Pose2:
    return poses[ref].inverse() @ poses[mov]


def anywhere(rng: np.random.Generator) -> Pose2:
    return Pose2(*rng.uniform(-30, 30, 2), rng.uniform(-3, 3))


def ring(seed: int, robots: int = 5) -> tuple[dict[str, Pose2], list[PairFinding]]:
    """Each robot saw the next, the last the first, and two a third one each."""
    _, poses = world(seed, robots)
    names = list(poses)
    pairs = [*zip(names, [*names[1:], names[0]], strict=True), (names[0], names[2]), (names[1], names[3])]
    return poses, [finding(k, a, b, hypothesis(true(poses, a, b), 0.97)) for k, (a, b) in enumerate(pairs)]


@settings(max_examples=20)
@given(st.integers(0, 10_000), st.floats(0.3, 0.95))
def test_a_lie_among_enough_truths_is_left_out_however_likely_it_looks_alone(seed, looks):
    poses, found = ring(seed)
    lie = finding(len(found), "r0", "r3", hypothesis(anywhere(np.random.default_rng([seed, 1])), looks))
    best = AnswerGraph(list(poses), [*found, lie], AREA).best()
    assert set(best.chosen) == set(range(len(found)))


@settings(max_examples=20)
@given(st.integers(0, 10_000), st.randoms(use_true_random=False))
def test_the_order_of_robots_and_pairs_changes_nothing(seed, shuffled):
    poses, found = ring(seed)
    found.append(finding(len(found), "r0", "r3", hypothesis(anywhere(np.random.default_rng([seed, 1])), 0.9)))
    names, order = list(poses), list(range(len(found)))
    best = AnswerGraph(names, found, AREA).best()
    shuffled.shuffle(order)
    shuffled.shuffle(names)
    again = AnswerGraph(names, [found[k] for k in order], AREA).best()
    assert {order[number] for number in again.chosen} == set(best.chosen)
    assert again.score == pytest.approx(best.score)


@settings(max_examples=20)
@given(st.integers(0, 10_000))
def test_a_loop_through_a_third_robot_decides_between_two_answers_that_are_alike_alone(seed):
    rng, poses = world(seed, 3)
    right, wrong = (hypothesis(T, 0.48, 0.04) for T in (true(poses, "r0", "r1"), anywhere(rng)))
    for answers in ((right, wrong), (wrong, right)):
        found = [
            finding(0, "r0", "r1", *answers),
            finding(1, "r1", "r2", hypothesis(true(poses, "r1", "r2"), 0.95)),
            finding(2, "r0", "r2", hypothesis(true(poses, "r0", "r2"), 0.95)),
        ]
        graph = AnswerGraph(list(poses), found, AREA)
        best = graph.best()
        assert answers[best.chosen[0]] is right
        assert probability_of(graph, best, 0) > 0.99


def test_without_a_loop_two_answers_that_are_alike_stay_undecided():
    rng, poses = world(7, 2)
    answers = [hypothesis(T, 0.48, 0.04) for T in (true(poses, "r0", "r1"), anywhere(rng))]
    graph = AnswerGraph(list(poses), [finding(0, "r0", "r1", *answers)], AREA)
    assert probability_of(graph, graph.best(), 0) == pytest.approx(0.5, abs=0.05)


@given(st.lists(st.floats(0.02, 1.0), min_size=1, max_size=5), st.floats(0.02, 1.0))
def test_an_answer_that_none_supports_has_its_own_probability(shares, none):
    """However many others of its pair there are."""
    rng, poses = world(7, 2)
    total = sum(shares) + none
    answers = [hypothesis(anywhere(rng), share / total, none / total) for share in shares]
    graph = AnswerGraph(list(poses), [finding(0, "r0", "r1", *answers)], AREA)
    best = graph.best()
    if best.chosen:
        assert probability_of(graph, best, 0) == pytest.approx(max(shares) / total)
    else:
        assert max(shares) <= none


def test_unlikely_answers_that_close_a_loop_are_likely_together():
    _, poses = world(11, 3)
    pairs = [("r0", "r1"), ("r1", "r2"), ("r0", "r2")]
    found = [finding(k, a, b, hypothesis(true(poses, a, b), 0.4)) for k, (a, b) in enumerate(pairs)]
    graph = AnswerGraph(list(poses), found, AREA)
    best = graph.best()
    assert set(best.chosen) == {0, 1, 2}
    assert min(probability_of(graph, best, number) for number in range(3)) > 0.99


@given(st.floats(0.3, 0.97), st.floats(0.3, 0.97))
def test_two_findings_of_the_same_two_robots_are_no_surer_together_than_the_surer_one(one, other):
    """They weigh the same walls, whoever of the robots saw the other."""
    _, poses = world(13, 2)
    found = [
        finding(0, "r0", "r1", hypothesis(true(poses, "r0", "r1"), one)),
        finding(1, "r1", "r0", hypothesis(true(poses, "r1", "r0"), other)),
    ]
    graph = AnswerGraph(list(poses), found, AREA)
    best = graph.best()
    for number in best.chosen:
        assert probability_of(graph, best, number) == pytest.approx(max(one, other))


@settings(max_examples=20)
@given(st.integers(0, 10_000), st.floats(0.6, 0.97))
def test_two_findings_that_agree_outvote_a_lie_of_the_same_robots_and_a_third_robot_makes_them_surer(seed, p):
    rng, poses = world(seed, 3)
    found = [
        finding(0, "r0", "r1", hypothesis(true(poses, "r0", "r1"), p)),
        finding(1, "r0", "r1", hypothesis(anywhere(rng), 0.98)),
        finding(2, "r1", "r0", hypothesis(true(poses, "r1", "r0"), p)),
    ]
    graph = AnswerGraph(list(poses), found, AREA)
    assert set(graph.best().chosen) == {0, 2}
    found += [
        finding(3, "r1", "r2", hypothesis(true(poses, "r1", "r2"), 0.9)),
        finding(4, "r2", "r0", hypothesis(true(poses, "r2", "r0"), 0.9)),
    ]
    graph = AnswerGraph(list(poses), found, AREA)
    best = graph.best()
    assert set(best.chosen) == {0, 2, 3, 4}
    assert min(probability_of(graph, best, number) for number in best.chosen) > 0.99
