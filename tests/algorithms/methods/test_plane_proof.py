"""The proof over the plane ends at the best of all transforms, whatever was climbed; or says why not."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from drawn import poses, small_maps
from hypothesis import assume, given, settings

from algorithms.common.parallel_kernels import use_threads
from algorithms.common.pose import Pose2, pose_error
from algorithms.maps.grid_map import GridMap
from algorithms.maps.robots import NO_ROBOTS
from algorithms.methods import plane_proof
from algorithms.methods.plane_method import ELSEWHERE
from algorithms.methods.plane_proof import prove_plane, with_proven
from algorithms.methods.registry import METHODS, PLANE_METHOD, merge, run
from algorithms.methods.steps import AnswersDetail, ProofDetail
from algorithms.observations.pair_problem import Known, PairProblem
from algorithms.observations.priors import InitialPose, TurnPrior
from algorithms.observations.search_window import WindowConfig
from algorithms.optimisation.branch_and_bound import ProofState
from algorithms.optimisation.objective import Lookup
from algorithms.optimisation.transform_lattice import TransformLattice
from algorithms.verdict.whole_maps import WholeMaps, make_whole_maps

PROVING = replace(METHODS[PLANE_METHOD].defaults, prove=True)


def whole_of(ref: GridMap, mov: GridMap, *known: Known) -> WholeMaps:
    window = PairProblem.of(ref, mov, known).window(WindowConfig("coupled", deviations=3.5), curved=True)
    return make_whole_maps(ref, mov, NO_ROBOTS, window, 0.25)


def climbed(*tops: Pose2) -> AnswersDetail:
    return AnswersDetail((), np.array([top.array() for top in tops]))


def proof_from(whole: WholeMaps, *tops: Pose2) -> ProofState:
    return [detail.state for detail in prove_plane(whole, climbed(*tops))][-1]


@settings(max_examples=25)
@given(small_maps(8), small_maps(8), poses)
def test_it_ends_at_the_best_of_all_transforms_whatever_was_climbed(ref, mov, anywhere):
    whole = whole_of(ref, mov)
    objective = replace(whole.crisp, lookup=Lookup.NEAREST)
    lattice = TransformLattice(objective, whole.window)
    assume(lattice.turns * lattice.side**2 < 1_000_000)
    numbers = np.indices((lattice.turns, lattice.side, lattice.side)).reshape(3, -1).T
    values = objective(lattice.poses(lattice.coordinates(numbers, 0)))
    top = Pose2(*(whole.window.place - whole.window.pivot).tolist()) @ Pose2(theta=anywhere.theta)
    state = proof_from(whole, top)
    if values.max() <= 0:
        assert not state.proven
        assert state.ceiling <= 0
    else:
        assert state.proven
        assert state.best_value == values.max()


def test_on_a_flat_it_is_where_the_search_had_come_to(small_case):
    steps = list(run(None, small_case.ref, small_case.mov, (), PROVING))
    stages = list(dict.fromkeys(step.stage for step in steps))
    assert stages == ["observe", "correlate", "climb", "prove", "weigh", "fuse", "verdict"]
    result = steps[-1].detail
    assert result.proven_optimal
    assert result.search_found_it
    metres, turn = pose_error(Pose2.from_array(result.proof.best), result.T_ref_mov, result.pivot)
    assert metres < 0.05
    assert turn < 0.02
    told = [step.detail.state for step in steps if isinstance(step.detail, ProofDetail)]
    assert [state.nodes for state in told] == sorted(state.nodes for state in told)
    assert all(np.isfinite(state.ceiling) for state in told)
    assert told[0].ceiling >= result.proof.best_value


def test_without_it_the_result_says_how_the_plane_was_searched_and_no_more(small_case):
    result = merge(small_case.ref, small_case.mov)
    assert result.proof is None
    assert not result.proven_optimal
    assert result.scan.turn_step == pytest.approx(np.radians(3.0))
    assert 0 < result.scan.climbed <= METHODS[PLANE_METHOD].defaults.places


def test_the_answer_is_the_same_with_it_and_without(small_case):
    result = merge(small_case.ref, small_case.mov, (), PLANE_METHOD, PROVING)
    assert result.T_ref_mov == merge(small_case.ref, small_case.mov).T_ref_mov


def test_a_place_that_the_search_has_missed_joins_the_answers(small_case):
    whole = whole_of(small_case.ref, small_case.mov)
    truth = small_case.truth.T_ref_mov
    wrong, state = climbed(truth @ Pose2(3.0, 2.0, 1.0)), proof_from(whole, truth)
    right = climbed(truth)
    assert with_proven(whole, right, state, *ELSEWHERE) == (right, True)
    answers, found_it = with_proven(whole, wrong, state, *ELSEWHERE)
    assert not found_it
    metres, turn = pose_error(answers.answers[-1].T_ref_mov, truth, whole.window.pivot)
    assert metres < 0.05
    assert turn < 0.02


def test_what_is_known_leaves_less_to_prove(small_case):
    truth = small_case.truth.T_ref_mov
    nodes = [
        proof_from(whole_of(small_case.ref, small_case.mov, *known), truth).nodes
        for known in ((), (TurnPrior(truth.theta, 0.1),), (InitialPose(truth, 0.5, 0.5, 0.05),))
    ]
    assert nodes == sorted(nodes, reverse=True)
    assert nodes[2] < nodes[1] < nodes[0] / 3


@pytest.mark.parametrize(
    ("limit", "most", "says"),
    [("MOST_BLOCKS", 1000, "more than 1,000"), ("PATIENCE", 0, "may hold a better place")],
)
def test_too_much_work_is_not_begun_or_left_and_told(small_case, monkeypatch, limit, most, says):
    monkeypatch.setattr(plane_proof, limit, most)
    whole, truth = whole_of(small_case.ref, small_case.mov), small_case.truth.T_ref_mov
    state = proof_from(whole, truth)
    assert not state.proven
    assert says in state.stopped
    assert state.best_value == pytest.approx(whole.crisp.value_at(truth), rel=0.1)
    assert state.gap > 0


def test_one_thread_and_two_prove_the_same(small_case):
    told = []
    try:
        for most in (1, 2):
            use_threads(most)
            told.append(proof_from(whole_of(small_case.ref, small_case.mov), small_case.truth.T_ref_mov))
    finally:
        use_threads(64)
    one, two = told
    assert (one.nodes, one.best_value, one.stopped) == (two.nodes, two.best_value, two.stopped)
    np.testing.assert_array_equal(one.best, two.best)
    np.testing.assert_array_equal(one.ceilings, two.ceilings)
