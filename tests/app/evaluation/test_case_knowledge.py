"""What a case is merged from: drawn around its truth, the same every time, and nothing else beside it."""

from dataclasses import replace

import numpy as np
import pytest

from algorithms.common.errors import SettingError
from algorithms.observations.pair_problem import PairProblem
from algorithms.observations.priors import InitialPose, TurnPrior
from app.evaluation.case_knowledge import known_of

KINDS = {"initial": InitialPose, "turn": TurnPrior}


def named(case, count):
    return [replace(case, name=f"{case.name}_{number}") for number in range(count)]


@pytest.mark.parametrize("knowledge", KINDS)
def test_what_is_drawn_depends_on_the_name_alone_and_has_the_deviations_that_it_states(small_case, knowledge):
    cases = named(small_case, 300)
    drawn = [known_of(case, knowledge) for case in cases]
    assert drawn == [known_of(case, knowledge) for case in cases]
    assert len(set(drawn)) == len(cases)
    assert {type(prior) for known in drawn for prior in known} == {KINDS[knowledge]}
    truth = small_case.truth.T_ref_mov.array()[None]
    off = [prior.deviations(truth)[0] ** 2 for known in drawn for prior in known]
    assert np.mean(off) == pytest.approx(3 if knowledge == "initial" else 1, rel=0.25)  # degrees of freedom


def test_a_sighting_is_all_that_the_file_says_and_none_is_nothing(small_case):
    informed = replace(small_case, priors=(TurnPrior(0.3),))
    assert known_of(informed, "sighting") == (*small_case.observations, TurnPrior(0.3))
    assert known_of(informed, "none") == ()
    assert not set(known_of(informed, "turn")) & set(informed.known)


def test_of_maps_that_share_no_place_the_pose_agrees_with_the_sighting_and_the_turn_is_any(strangers):
    turns = []
    for case in named(strangers, 60):
        (pose,) = known_of(case, "initial")
        PairProblem.of(case.ref, case.mov, (*case.observations, pose))  # raises where they contradict
        turns.append(pose.pose.theta)
    assert min(turns) < -2.5
    assert max(turns) > 2.5
    unknown = replace(strangers, truth=None)
    assert known_of(unknown, "initial") == known_of(strangers, "initial")


def test_without_truth_and_sighting_there_is_nothing_to_draw_from(small_case):
    empty = replace(small_case, observations=(), truth=None)
    assert known_of(empty, "none") == ()
    for knowledge in KINDS:
        with pytest.raises(SettingError, match=r"flat_1 has neither .* add a truth\.yaml"):
            known_of(empty, knowledge)
