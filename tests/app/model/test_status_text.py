"""What the page says while it proves, and after: sentences, remedies, rivals."""

from __future__ import annotations

from dataclasses import replace
from math import inf, radians

import numpy as np
import pytest
from proofs import proof_state

from algorithms.common.pose import Pose2
from algorithms.methods.merge_result import MergeResult
from algorithms.methods.registry import METHODS, run
from algorithms.methods.steps import ProofDetail, ProvenDetail, Step
from algorithms.optimisation.branch_and_bound import ProofState
from algorithms.verdict.decision import Outcome
from app.model import status_text as words
from app.model.objective_label import AGREEMENT, GAMMA, measure_of
from app.model.run_state import RunState

PROVEN = METHODS["spectra-proven"].defaults


@pytest.fixture(scope="module")
def told(small_case) -> RunState:
    """A whole run of the method with the proof."""
    story = RunState(PROVEN)
    for step in run("spectra-proven", small_case.ref, small_case.mov, small_case.observations, PROVEN):
        story.tell(step)
    return story


@pytest.fixture(scope="module")
def result(told) -> MergeResult:
    return told.get(MergeResult)


def proving(told: RunState, **changes) -> str:
    story = RunState(PROVEN)
    window = told.get(ProofDetail).window
    story.tell(Step("prove", ProofDetail(proof_state(**changes), window), 0.0))
    return words.sentence(story)


def ended(told: RunState, found_it: bool, T: Pose2 | None = None, **changes) -> str:
    """The sentence at the end of a proof whose optimum is T."""
    story = replace(told, _newest=dict(told._newest))
    proven = told.get(ProvenDetail)
    peak = replace(proven.peak, T_ref_mov=T) if T else proven.peak
    story.tell(Step("prove", ProvenDetail(proof_state(**changes), peak, found_it), 0.0))
    return words.sentence(story)


def test_a_proof_says_how_many_blocks_it_bounded_and_what_is_still_possible(told):
    going_on = {"rival_sought": False, "proven": False, "stopped": None, "ceiling": 12.4}
    assert proving(told, **going_on) == "Proving: 12,300 blocks bounded, nothing above 12.4 m is left."


def test_once_proven_it_speaks_of_rivals(told):
    assert proving(told, ceiling=17.0) == "Proven. Rivals: 12,300 blocks bounded, none above 17.0 m."


def test_the_page_says_whether_the_swarm_found_the_proven_optimum(told):
    assert ended(told, True) == "The swarm found the proven optimum."


def test_a_swarm_that_got_stuck_is_told_with_how_far_off(told, small_case):
    best, at = told.swarm.box.transform(told.swarm.state.best), told.get(MergeResult).encounter.x_mov
    turned = Pose2(theta=best.theta + radians(178))
    x, y = (best.apply(at) + (1.2, 0.0) - turned.apply(at)).tolist()
    assert ended(told, False, Pose2(x, y, turned.theta)) == (
        "The swarm got stuck: the proven optimum lies 1.2 m and 178° from its best."
    )


def test_a_proof_that_was_given_up_says_what_may_still_be(told):
    said = ended(told, True, proven=False, ceiling=31.0, stopped="not all searched: 12,300 blocks")
    assert said == "Not proven after 12,300 blocks: somewhere there may be up to 31.0 m."


def test_sightings_that_exclude_each_other_and_maps_that_fit_nowhere_are_told_apart(told):
    nothing = {
        "best": None,
        "best_value": -inf,
        "proven": False,
        "rivals": np.zeros((0, 3)),
        "rival_values": np.zeros(0),
    }
    assert "every sighting" in ended(told, False, **nothing, empty=True, ceiling=0.0)
    assert "nothing anywhere is above" in ended(told, False, **nothing, ceiling=0.0)
    assert words.optimum(proof_state(**nothing, ceiling=0.0)) == "nothing fits"
    assert words.optimum(proof_state(**nothing, empty=True)).startswith("none")


def test_an_unproven_optimum_says_why():
    given_up = proof_state(proven=False, stopped="not all searched: 12,300 blocks", ceiling=31.0)
    assert words.optimum(given_up) == "not proven: not all searched: 12,300 blocks"
    assert words.optimum(proof_state()) == "proven"


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
        story.tell(step)
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


def refused(result: MergeResult, proof: ProofState | None = None, **changes) -> MergeResult:
    verdict = replace(result.verdict, accepted=False, outcome=Outcome.REFUSED, **changes)
    return replace(result, verdict=verdict, proof=proof)


def test_an_accepted_merge_needs_no_remedy(result):
    assert words.remedy(result) == ""


def test_a_bent_merge_is_told_what_to_mind(result):
    bent = replace(result, verdict=replace(result.verdict, outcome=Outcome.BENT))
    assert "double" in words.remedy(bent)
    assert words.mood(bent.verdict) == "bent"


@pytest.mark.parametrize(
    ("against", "remedy"),
    [
        ("others", "second observation would tell"),
        ("across", "drive on"),
        ("misfit", "Check the observation's numbers"),
        ("contradiction", "maps of one building"),
        ("unbent", "maps of one building"),
    ],
)
def test_what_speaks_most_against_a_merge_decides_what_would_help(result, against, remedy):
    contributions = dict.fromkeys(result.verdict.contributions, 1.0) | {"misfit": -0.6, against: -5.0}
    told = replace(result.weighed[0].evidence, rigid_contradicting=9.0)
    contradicted = replace(result, weighed=(replace(result.weighed[0], evidence=told),))
    assert remedy in words.remedy(refused(contradicted, proof_state(), contributions=contributions))


def test_maps_that_share_little_and_contradict_nowhere_are_not_said_to_be_of_two_buildings(result):
    contributions = dict.fromkeys(result.verdict.contributions, 1.0) | {"unbent": -5.0}
    told = replace(result.weighed[0].evidence, rigid_contradicting=0.1)
    little = replace(result, weighed=(replace(result.weighed[0], evidence=told),))
    assert "share more" in words.remedy(refused(little, contributions=contributions))


def test_a_rival_that_nobody_would_believe_in_is_not_told(result):
    likely = {"rival": Pose2(1.0, 2.0, 3.0), "probability": 0.6}
    assert words.rival(refused(result, ambiguity=0.5, **likely)).endswith("turned, 30%")
    assert words.rival(refused(result, ambiguity=0.001, **likely)) == ""
    assert words.odds_of_rival(refused(result, ambiguity=1e20, **likely).verdict) == "likelier than this"


def test_a_merge_that_is_refused_for_its_bend_alone_says_how_to_take_it(result):
    assert "--strict" in words.remedy(refused(result, only_bent=True))


def test_a_cause_that_was_found_is_told_before_anything_else(result):
    hint = "Mirrored, map 2 agrees on 99% of 42 m of wall."
    assert words.remedy(refused(result, proof_state(), hint=hint)) == hint


@pytest.mark.parametrize(
    ("changes", "remedy"),
    [
        ({"proven": False, "stopped": "not all searched"}, "patience"),
        ({"best": None, "proven": False, "empty": True}, "the odd one"),
        ({"best": None, "proven": False, "ceiling": 0.0}, "of one building"),
    ],
)
def test_a_proof_that_failed_has_its_remedy(result, changes, remedy):
    assert remedy in words.remedy(refused(result, proof_state(**{"ceiling": 30.0} | changes)))


def test_a_rival_is_told_by_how_it_differs_and_how_likely_it_is(result):
    doubt = {"probability": 0.6, "ambiguity": 0.5}
    at = replace(result, T_ref_mov=Pose2(1.0, 2.0, 0.5))
    turned = Pose2.from_array(proof_state().rivals[0])
    assert words.rival(refused(at, rival=turned, **doubt)) == "178° turned, 30%"
    assert words.rival(refused(at, rival=Pose2(1.9, 2.0, 0.5), **doubt)) == "0.9 m shifted, 30%"
    assert words.rival(result) == ""


def test_two_answers_are_never_told_to_be_likelier_together_than_certain(result):
    doubtful = refused(result, rival=Pose2(), probability=0.8, ambiguity=1.0)
    assert words.likelihood_of_rival(doubtful) == pytest.approx(0.2)


@pytest.mark.parametrize(
    ("probability", "told"), [(0.99999, "> 99.9%"), (0.9944, "99.4%"), (0.5, "50.0%"), (1e-6, "< 0.1%")]
)
def test_no_probability_is_told_to_be_certain(probability, told):
    assert words.likelihood(probability) == told


def test_the_swarm_that_is_shown_in_the_end_is_the_one_that_got_highest(told):
    assert told.swarm.state.best_value == max(course[-1] for course in told.courses)
    assert told.answer == told.get(MergeResult).T_ref_mov
