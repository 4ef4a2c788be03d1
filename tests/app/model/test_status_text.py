"""What the page says while it searches and proves, and of the end of it."""

from __future__ import annotations

from dataclasses import replace
from math import inf, radians

import numpy as np
import pytest
from proofs import NO_ROBOTS, proof_state

from algorithms.common.pose import Pose2
from algorithms.methods.merge_result import MergeResult
from algorithms.methods.registry import METHODS, PLANE_METHOD, run
from algorithms.methods.steps import ProofDetail, ProvenDetail, Step
from app.model import status_text as words
from app.model.objective_label import AGREEMENT, GAMMA, measure_of
from app.model.run_state import RunState

PROVEN = METHODS["spectra-proven"].defaults


@pytest.fixture(scope="module")
def told(small_case) -> RunState:
    """A whole run of the method with the proof."""
    story = RunState(PROVEN)
    for step in run("spectra-proven", small_case.ref, small_case.mov, small_case.observations, PROVEN):
        story.add(step)
    return story


def proving(told: RunState, **changes) -> str:
    story = RunState(PROVEN)
    window = told.get(ProofDetail).window
    story.add(Step("prove", ProofDetail(proof_state(**changes), window), 0.0))
    return words.sentence(story)


def ended(told: RunState, found_it: bool, T: Pose2 | None = None, **changes) -> str:
    """The sentence at the end of a proof whose optimum is T."""
    story = replace(told, _newest=dict(told._newest))
    proven = told.get(ProvenDetail)
    peak = replace(proven.peak, T_ref_mov=T) if T else proven.peak
    story.add(Step("prove", ProvenDetail(proof_state(**changes), peak, found_it), 0.0))
    return words.sentence(story)


def test_a_proof_says_how_many_blocks_it_bounded_and_what_is_still_possible(told):
    going_on = {"rival_sought": False, "proven": False, "stopped": None, "ceiling": 12.4}
    said = proving(told, **going_on)
    assert "12,300 blocks" in said
    assert "12.4 m" in said
    assert "Rivals" not in said


def test_once_proven_it_speaks_of_rivals(told):
    said = proving(told, ceiling=17.0)
    assert said.startswith("Proven")
    assert "ivals" in said
    assert "12,300 blocks" in said
    assert "17.0 m" in said


def test_the_page_says_whether_the_swarm_found_the_proven_optimum(told):
    found, stuck = ended(told, True), ended(told, False)
    assert found != stuck
    for said in (found, stuck):
        assert said.startswith("The swarm")
        assert "proven optimum" in said
    assert "stuck" in stuck
    assert "stuck" not in found


def test_a_swarm_that_got_stuck_is_told_with_how_far_off(told, small_case):
    best, at = told.swarm.box.transform(told.swarm.state.best), told.get(MergeResult).pivot
    turned = Pose2(theta=best.theta + radians(178))
    x, y = (best.apply(at) + (1.2, 0.0) - turned.apply(at)).tolist()
    said = ended(told, False, Pose2(x, y, turned.theta))
    assert "stuck" in said
    assert "1.2 m and 178°" in said


def test_a_proof_that_was_given_up_says_what_may_still_be(told):
    said = ended(told, True, proven=False, ceiling=31.0, stopped="not all searched: 12,300 blocks")
    assert said.startswith("Not proven")
    assert "12,300 blocks" in said
    assert "31.0 m" in said


def test_sightings_that_exclude_each_other_and_maps_that_fit_nowhere_are_told_apart(told):
    assert "every sighting" in ended(told, False, **NO_ROBOTS, empty=True, ceiling=0.0)
    assert "nothing anywhere is above" in ended(told, False, **NO_ROBOTS, ceiling=0.0)


@pytest.mark.parametrize(
    "state",
    [
        proof_state(),
        proof_state(rivals=np.zeros((0, 3)), rival_values=np.zeros(0)),
        proof_state(proven=False, stopped=None, ceiling=50.0),
        proof_state(best=None, proven=False, ceiling=0.0),
        proof_state(best=None, proven=False, empty=True),
    ],
)
def test_the_line_above_the_proof_is_a_sentence_without_infinities(state):
    line = words.proof_says(state, AGREEMENT)
    assert line.endswith(".")
    assert "inf" not in line
    assert "nan" not in line


def test_a_run_with_a_proof_never_speaks_of_gamma_where_it_means_the_agreement(small_case):
    story, said, shares = RunState(PROVEN), [], []
    for step in run("spectra-proven", small_case.ref, small_case.mov, small_case.observations, PROVEN):
        story.add(step)
        said.append(words.sentence(story))
        shares.append(words.progress(story))
    assert not [line for line in said if "Γ" in line]
    assert any(line.startswith("Proving: ") for line in said)
    assert shares == sorted(shares)
    assert shares[-1] == 1.0


def test_each_objective_has_its_name():
    assert measure_of(PROVEN) is AGREEMENT
    assert measure_of(METHODS["spectra-swarm"].defaults) is GAMMA
    assert measure_of(METHODS["bilateral"].defaults) is GAMMA
    assert AGREEMENT.text(12.34) == "12.3 m"
    assert AGREEMENT.text(-2.0) == "−2.0 m"
    assert GAMMA.text(0.012345) == "0.01235"
    assert AGREEMENT.text(-inf) == GAMMA.text(-inf) == "–"


def test_the_swarm_that_is_shown_in_the_end_is_the_one_that_got_highest(told):
    assert told.swarm.state.best_value == max(course[-1] for course in told.courses)
    assert told.answer == told.get(MergeResult).T_ref_mov


def test_a_search_of_the_plane_says_how_many_turns_are_done_and_gets_ahead(small_case):
    story, said, share = RunState(METHODS[PLANE_METHOD].defaults), [], [0.0]
    for step in run(PLANE_METHOD, small_case.ref, small_case.mov):
        story.add(step)
        share.append(words.progress(story))
        if step.stage == "correlate":
            said.append(words.sentence(story))
    assert share == sorted(share)
    assert share[-1] == 1
    assert said[0].startswith("Turning: 8 of 120 turns")
    assert "m." in said[-1]
