"""What the page says of an answer: the verdict, its rival, how the proof ended, what would help."""

from __future__ import annotations

from dataclasses import replace
from math import radians

import pytest
from proofs import NO_ROBOTS, proof_state

from algorithms.common.pose import Pose2
from algorithms.methods.merge_result import MergeResult, PlaneScan
from algorithms.optimisation.branch_and_bound import ProofState
from algorithms.verdict.decision import Outcome
from app.model import verdict_text as words


def test_a_proof_without_an_optimum_says_whether_the_sightings_or_the_maps_are_to_blame():
    assert words.optimum(proof_state(**NO_ROBOTS, ceiling=0.0)) == "nothing fits"
    assert words.optimum(proof_state(**NO_ROBOTS, empty=True)).startswith("none")


def test_an_unproven_optimum_says_why():
    given_up = proof_state(proven=False, stopped="not all searched: 12,300 blocks", ceiling=31.0)
    assert words.optimum(given_up) == "not proven: not all searched: 12,300 blocks"
    assert words.optimum(proof_state()) == "proven"


def test_the_map_that_was_resampled_is_named_with_its_cells(result):
    cell = result.fusion.merged.resolution
    assert words.resampled(result.fusion) == ""
    told = words.resampled(replace(result.fusion, resolutions=(cell, 4 * cell)))
    assert told == "map 2 from cells of 0.2 m to 0.05 m"


SCAN = PlaneScan(radians(3), 0.0784, 100)
HOW = "turns in steps of 3°, cells of 0.078 m, the 100 best places climbed"


def test_a_search_over_the_plane_says_how_it_was_done_and_that_nothing_is_proven(result):
    assert words.searched(result) == ""
    plane = replace(result, scan=SCAN, proof=None)
    assert words.searched(plane) == f"searched, not proven: {HOW}"
    given_up = proof_state(proven=False, stopped="not all searched: 12,300 blocks")
    told = words.searched(replace(plane, proof=given_up))
    assert told == f"searched, not proven (not all searched: 12,300 blocks): {HOW}"


def test_a_proof_over_the_plane_says_whether_its_best_is_the_answer(result):
    here = proof_state(best=result.T_ref_mov.array())
    told = words.searched(replace(result, scan=SCAN, proof=here))
    assert told == "proven to a cell: at no other place do the walls agree better"
    there = proof_state(best=(result.T_ref_mov @ Pose2(theta=radians(90))).array())
    told = words.searched(replace(result, scan=SCAN, proof=there))
    assert told.startswith("proven to a cell: the walls agree best ")
    assert told.endswith(" m and 90° from here")


def test_after_a_search_over_the_plane_more_patience_is_no_remedy(result):
    plane = replace(refused(result, proof_state(proven=False, ceiling=31.0)), scan=SCAN)
    assert "patience" not in words.remedy(plane)


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


@pytest.mark.parametrize("method", ["spectra-swarm", "spectra-montecarlo", "paper-argmax"])
def test_a_search_without_a_proof_is_told_to_be_done_by_the_default_method_before_the_maps_are_doubted(
    result, method
):
    contributions = dict.fromkeys(result.verdict.contributions, 1.0) | {"contradiction": -5.0}
    assert "default one" in words.remedy(replace(refused(result, contributions=contributions), method=method))


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
