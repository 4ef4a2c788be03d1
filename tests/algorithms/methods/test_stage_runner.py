import numpy as np
import pytest

from algorithms.methods import stage_runner as chain
from algorithms.methods.stage_runner import StageRunner
from algorithms.methods.steps import RefineDetail
from algorithms.optimisation.particle_swarm import SwarmConfig, settled_within, swarm
from algorithms.optimisation.search_box import SearchBox

BOX = SearchBox(-np.ones(3), np.ones(3), np.zeros(2))


def snapshots():
    rng = np.random.default_rng(0)
    states = swarm(
        lambda poses: -np.abs(poses).sum(axis=1),
        BOX,
        SwarmConfig(particles=50, iterations=40),
        settled_within(1e-9),
        rng,
    )
    for state in states:
        yield RefineDetail(0, 1, BOX, state)


def told(memo, inputs=("same",)):
    return list(StageRunner(memo).stage("refine", inputs, snapshots))


def test_what_was_told_once_is_told_again_and_not_made_again():
    memo = {}
    first, second = told(memo), told(memo)
    assert [step.detail for step in second] == [step.detail for step in first]
    assert all(step.reused for step in second)
    assert not any(step.reused for step in first)


def test_other_inputs_are_worked_on_anew():
    memo = {}
    told(memo)
    assert not any(step.reused for step in told(memo, ("other",)))


def test_a_long_search_is_told_whole_once_and_with_gaps_again(monkeypatch):
    monkeypatch.setattr(chain, "MOST_BYTES", 20_000)
    memo = {}
    first, second = told(memo), told(memo)
    assert len(first) == 40
    assert 2 < len(second) < 20
    assert sum(map(chain._bytes, second)) <= 20_000
    assert second[-1].detail is first[-1].detail
    iterations = [step.detail.state.iteration for step in second]
    assert iterations == sorted(iterations)


def test_a_stage_returns_its_last_detail_whether_made_or_remembered():
    def last_of(memo):
        stage = StageRunner(memo).stage("refine", (), snapshots)
        while True:
            try:
                step = next(stage)
            except StopIteration as end:
                return step.detail, end.value

    memo = {}
    for _ in range(2):
        last, returned = last_of(memo)
        assert returned is last


def test_a_stage_that_fails_is_not_remembered():
    def broken():
        yield from list(snapshots())[:3]
        raise ValueError("half-way")

    memo = {}
    with pytest.raises(ValueError, match="half-way"):
        list(StageRunner(memo).stage("refine", (), broken))
    assert memo == {}
