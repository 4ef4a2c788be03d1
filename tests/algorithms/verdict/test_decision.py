"""Three outcomes, told apart, with what speaks against a merge in the order of its weight."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from drawn import flat_pair
from hypothesis import given
from hypothesis import strategies as st

from algorithms.common.errors import SettingError
from algorithms.common.pose import Pose2
from algorithms.maps.grid_map import FREE, OCCUPIED_FROM
from algorithms.maps.map_fusion import fuse
from algorithms.observations.observation import encounter, robots_of
from algorithms.observations.search_window import WindowConfig, coupled_window
from algorithms.verdict.decision import Outcome, VerdictConfig, judge, merges_of
from algorithms.verdict.probability_model import Fit, misfit_of, quantities_of, shipped_model
from algorithms.verdict.ranking import Weighed, weigh
from algorithms.verdict.slipping_patches import Apart
from algorithms.verdict.wall_evidence import Evidence
from algorithms.verdict.whole_maps import make_whole_maps

REF, MOV, SEEN, T = flat_pair()
AT = encounter(SEEN)
WHOLE = make_whole_maps(REF, MOV, robots_of([AT], 0.4), coupled_window([AT], WindowConfig()), 0.25)
MODEL = shipped_model()
FUSION = fuse((REF, MOV), (Pose2(), T))
TURNED = T @ Pose2(*AT.x_mov.tolist()) @ Pose2(theta=np.pi) @ Pose2(*(-AT.x_mov).tolist())

CLEAN = Evidence(100.0, 1.0, 98.0, 3.0, across=30.0, floor=60.0)
BENT = Evidence(90.0, 6.0, 60.0, 36.0, across=30.0, floor=120.0, apart=(Apart(3.0, -4.0, 0.7, 12.0),))
STRANGERS = Evidence(30.0, 30.0, 25.0, 35.0, across=8.0, floor=30.0)
CORRIDOR = Evidence(40.0, 2.0, 40.0, 3.0, across=0.3, floor=12.0)


def told(evidence: Evidence, T_ref_mov=T, deviations=(0.5,)) -> Weighed:
    quantities = quantities_of(Fit(evidence, misfit_of(deviations, 3.5)))
    return Weighed(T_ref_mov, T_ref_mov, evidence, deviations, quantities, MODEL.score(quantities))


def verdict_on(named, others=(), doubts=(), **config):
    return judge(FUSION, named, others, AT.x_mov, VerdictConfig(**config), doubts)


def test_the_known_pose_is_merged_with_its_numbers_in_the_sentence():
    verdict = verdict_on(weigh(WHOLE, T, MODEL))
    assert verdict.outcome is Outcome.MERGED
    assert verdict.accepted
    assert verdict.reason.startswith("Merged: ")
    assert "of 1,000 such merges are right" in verdict.reason
    assert "agree on 100% of" in verdict.reason
    assert f"{verdict.shared_wall:.0f} m" in verdict.reason
    assert verdict.deviation < 0.5


def test_what_is_not_all_of_the_wall_is_not_told_to_be_all():
    verdict = verdict_on(told(replace(CLEAN, agreeing=999.0, contradicting=1.0)))
    assert "agree on 99% of the 1000 m" in verdict.reason


def test_a_wrong_turn_is_refused_because_the_maps_contradict_each_other():
    verdict = verdict_on(weigh(WHOLE, TURNED, MODEL))
    assert verdict.outcome is Outcome.REFUSED
    assert "the maps contradict each other on" in verdict.reason.lower()
    assert verdict.probability < 0.05


def test_a_bent_merge_is_accepted_with_how_far_the_maps_lie_apart_and_where():
    verdict = verdict_on(told(BENT))
    assert verdict.outcome is Outcome.BENT
    assert verdict.accepted
    assert "bent" in verdict.reason
    assert "0.7 m beside each other" in verdict.reason
    assert "(3.0, -4.0)" in verdict.reason
    assert "double" in verdict.reason


def test_where_bent_merges_are_not_wanted_a_bent_one_is_refused_for_that_alone():
    verdict = verdict_on(told(BENT), refuse_bent=True)
    assert verdict.outcome is Outcome.REFUSED
    assert not verdict.accepted
    assert verdict.only_bent
    assert verdict.probability == verdict_on(told(BENT)).probability
    assert "0.7 m beside each other" in verdict.reason
    assert verdict_on(told(CLEAN), refuse_bent=True) == verdict_on(told(CLEAN))
    assert not verdict_on(told(STRANGERS), refuse_bent=True).only_bent


def test_maps_that_share_little_are_not_said_to_contradict_each_other():
    verdict = verdict_on(told(Evidence(6.0, 0.0, 6.0, 0.0, across=1.0, floor=4.0)), accept_from=0.99)
    assert "contradict each other" not in verdict.reason
    assert "only 6 m of wall and 4 m² of floor in common" in verdict.reason


def test_contradictions_that_no_slipping_mends_are_no_bend():
    furniture = replace(BENT, agreeing=62.0, contradicting=34.0, floor=1000.0, apart=())
    assert verdict_on(told(furniture), accept_from=0.5).outcome is not Outcome.BENT
    assert verdict_on(told(BENT), bent_from=0.5).outcome is Outcome.MERGED


@given(st.floats(0.5, 0.999), st.floats(0.5, 0.999))
def test_whoever_demands_more_accepts_no_more(one, other):
    least, most = sorted((one, other))
    for evidence in (CLEAN, BENT, STRANGERS, CORRIDOR):
        eager, strict = (verdict_on(told(evidence), accept_from=p) for p in (least, most))
        assert eager.accepted or not strict.accepted
        assert eager.accepted == (eager.probability >= least)


def test_a_twin_is_refused_and_named_however_much_more_wall_the_answer_has():
    less = replace(CLEAN, agreeing=57.0, rigid_agreeing=57.0, across=18.0, floor=35.0)
    verdict = verdict_on(told(CLEAN), [told(less, TURNED)])
    assert not verdict.accepted
    assert verdict.probability < 0.55
    assert verdict.rival == TURNED
    assert (
        "wo answers fit almost equally well, 180° apart: a second observation would decide" in verdict.reason
    )
    moved = Pose2(1.2, 0.0, 0.0) @ T
    assert "1.2 m apart" in verdict_on(told(CLEAN), [told(less, moved)]).reason


def test_another_answer_that_the_rest_of_the_maps_contradicts_is_no_rival():
    verdict = verdict_on(told(CLEAN), [told(STRANGERS, TURNED)])
    assert verdict.accepted
    assert verdict.rival is None
    assert verdict.ambiguity < 0.05


def test_the_likeliest_of_several_others_is_the_rival():
    others = [told(STRANGERS, Pose2()), told(CLEAN, TURNED), told(CORRIDOR, Pose2(1, 0, 0) @ T)]
    assert verdict_on(told(CLEAN), others).rival == TURNED


def test_an_answer_that_a_likelier_one_lies_beside_is_told_to_move_there():
    beside = Pose2(0.3, 0.0, 0.0) @ T
    verdict = verdict_on(told(BENT, beside), [told(CLEAN, T)])
    assert not verdict.accepted
    assert "fit better 0.30 m" in verdict.reason
    assert verdict.ambiguity > 1


def test_a_method_that_knows_no_others_says_so():
    assert verdict_on(told(CLEAN), None).ambiguity is None
    assert verdict_on(told(CLEAN), []).ambiguity == 0.0


def test_what_speaks_against_a_merge_is_named_by_its_weight():
    verdict = verdict_on(told(STRANGERS, deviations=(3.4,)))
    names = verdict.against
    weights = [verdict.contributions[name] for name in names]
    assert weights == sorted(weights)
    assert all(weight < 0 for weight in weights)
    assert "contradict each other on 58% of the 60 m" in verdict.reason
    assert "3.4 standard deviations from where it was seen" in verdict.reason


def test_a_corridor_is_told_that_little_keeps_it_in_its_place():
    verdict = verdict_on(told(CORRIDOR), accept_from=0.999)
    assert "across" in verdict.against
    assert "keeps map 2 in its place" in verdict.reason


def test_maps_that_share_no_wall_are_told_so():
    verdict = verdict_on(told(Evidence(0.0, 0.0, 0.0, 0.0)))
    assert not verdict.accepted
    assert "no wall was seen by both robots" in verdict.reason.lower()


def test_what_a_method_has_against_its_own_answer_refuses_it_whatever_the_walls_say():
    doubt = "the search was stopped before it had ruled out a better place"
    verdict = verdict_on(told(CLEAN), doubts=[doubt])
    assert verdict.probability > 0.99
    assert not verdict.accepted
    assert doubt[1:] in verdict.reason


def test_of_several_sightings_the_worst_is_told():
    assert verdict_on(told(CLEAN, deviations=(0.5, 2.5, 1.0))).deviation == 2.5


@pytest.mark.parametrize(
    ("probability", "words"),
    [
        (0.9971, "997 of 1,000 such merges are right"),
        (0.99999, "more than 999 of 1,000 such merges are right"),
        (0.5, "500 of 1,000 such merges are right"),
        (0.0012, "1 of 1,000 such merges is right"),
        (1e-9, "less than 1 of 1,000 such merges is right"),
    ],
)
def test_a_probability_is_told_as_a_count_of_merges(probability, words):
    assert merges_of(probability) == words


def test_limits_that_make_no_sense_are_refused():
    for wrong in ({"accept_from": 0.2}, {"accept_from": 1.0}, {"bent_from": -0.1}, {"robot_size": 9.0}):
        with pytest.raises(SettingError):
            VerdictConfig(**wrong)


LITTLE = Evidence(20.0, 0.5, 20.0, 0.8, across=5.0, floor=15.0)


def test_a_merge_as_likely_as_is_asked_for_is_accepted_and_one_a_hair_below_is_not():
    likely = verdict_on(told(LITTLE)).probability
    assert 0.5 < likely < 0.99
    assert verdict_on(told(LITTLE), accept_from=likely).accepted
    assert not verdict_on(told(LITTLE), accept_from=float(np.nextafter(likely, 1))).accepted


def test_the_cells_are_told_as_they_are_counted_on_the_merged_map():
    beside = Pose2(0.6, 0.4, 0.1) @ T
    fusion = replace(fuse((REF, MOV), (Pose2(), beside)), cleared=7)
    verdict = judge(fusion, told(CLEAN, beside), None, AT.x_mov, VerdictConfig())
    ref, mov = fusion.ref_cells, fusion.mov_cells
    both = (ref >= FREE) & (mov >= FREE)
    denied = both & ((ref >= OCCUPIED_FROM) != (mov >= OCCUPIED_FROM))
    assert verdict.overlap_cells == both.sum() > 1000
    assert verdict.overlap_area == pytest.approx(both.sum() * 0.05**2)
    assert verdict.conflicting_cells == denied.sum() > 10
    assert verdict.cleared_cells == 7


def test_a_rival_is_told_by_its_turn_wherever_it_lies_unless_it_does_not_turn():
    less = replace(CLEAN, agreeing=57.0, rigid_agreeing=57.0, across=18.0, floor=35.0)

    def apart(T_ref_mov):
        return verdict_on(told(CLEAN), [told(less, T_ref_mov)]).reason

    assert "180° apart" in apart(Pose2(2.0, 0.0) @ TURNED)
    assert "0° apart" in apart(Pose2(0.3, 0.0) @ T)
    assert " m apart" not in apart(Pose2(0.3, 0.0) @ T)


def test_a_likely_merge_that_is_refused_is_said_to_be_likely_all_the_same():
    assert "Refused: although" in verdict_on(told(CLEAN), doubts=["it was stopped"]).reason
    assert "although" not in verdict_on(told(STRANGERS)).reason


def test_however_hopeless_an_answer_is_its_odds_are_numbers():
    verdict = verdict_on(told(STRANGERS, deviations=(1e3,)), [told(CLEAN, TURNED)])
    assert verdict.probability < 1e-9
    assert 1 < verdict.ambiguity < np.inf
