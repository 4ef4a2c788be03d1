from dataclasses import replace

import numpy as np
import pytest
from drawn import OBSERVED, OBSERVER, T_MOV_WORLD, T_REF_WORLD, drawn_map, flat_pair, sighting

from algorithms.common import parallel_kernels as kernels
from algorithms.common.errors import SettingError
from algorithms.common.pose import Pose2, pose_error
from algorithms.maps.grid_map import GridMap
from algorithms.maps.map_fusion import ConflictRule
from algorithms.methods.merge_result import MergeResult
from algorithms.methods.registry import METHODS, merge, run
from algorithms.methods.spectra_config import PipelineConfig, RefineConfig
from algorithms.methods.steps import CandidatesDetail, HoughDetail, RefineDetail, ShiftDetail
from algorithms.observations.search_window import WindowConfig
from algorithms.optimisation.particle_swarm import SwarmConfig
from algorithms.spectra.augmented_map import AugmentConfig
from algorithms.verdict.decision import VerdictConfig

REF, MOV, SEEN, T_REF_MOV = flat_pair()
QUICK = PipelineConfig(swarm=SwarmConfig(particles=100, iterations=40))
SURE = [name for name, method in METHODS.items() if method.family == "ours"] + ["bilateral"]


def off(result, T=T_REF_MOV):
    return pose_error(result.T_ref_mov, T, result.pivot)


@pytest.mark.parametrize("method", SURE)
@pytest.mark.parametrize(
    ("frame_1", "frame_2"),
    [(T_REF_WORLD, T_MOV_WORLD), (Pose2(), Pose2(80.0, -60.0, 2.9)), (Pose2(5, 5, -1.2), Pose2(0, 0, 1.94))],
)
def test_a_known_pose_is_found_and_accepted(method, frame_1, frame_2):
    ref, mov, seen, T = flat_pair(frame_1, frame_2)
    result = merge(ref, mov, seen, method)
    distance, angle = off(result, T)
    assert distance < 0.1
    assert angle < np.deg2rad(1)
    assert result.verdict.accepted


@pytest.mark.parametrize("method", SURE)
def test_swapping_the_two_maps_inverts_the_answer(method):
    swapped = sighting(T_MOV_WORLD, T_REF_WORLD, OBSERVED, OBSERVER)
    there, back = merge(REF, MOV, SEEN, method), merge(MOV, REF, swapped, method)
    distance, angle = pose_error(back.T_ref_mov.inverse(), there.T_ref_mov, there.pivot)
    assert distance < 0.1
    assert angle < np.deg2rad(1)


def test_maps_of_different_resolution_are_merged():
    ref, mov, seen, T = flat_pair(mov_resolution=0.08)
    result = merge(ref, mov, seen)
    assert off(result, T)[0] < 0.15
    assert result.fusion.merged.resolution == 0.05


def test_a_map_with_a_yawed_origin_is_merged():
    yawed = drawn_map(T_MOV_WORLD, origin_yaw=0.8, seen=(2.5, -1, 10, 8))
    assert off(merge(REF, yawed, SEEN))[0] < 0.1


@pytest.mark.parametrize("method", list(METHODS))
def test_one_observation_may_be_given_alone_or_in_a_list(method):
    alone = merge(REF, MOV, SEEN, method)
    for listed in ([SEEN], (SEEN,)):
        assert merge(REF, MOV, listed, method).T_ref_mov == alone.T_ref_mov


@pytest.mark.parametrize("method", SURE)
def test_several_observations_are_all_told_and_the_maps_merged(method):
    there = [Pose2(4.6, 3.2, 2.0), Pose2(3.5, 6.0), Pose2(5.6, 0.8)]
    several = [sighting(T_REF_WORLD, T_MOV_WORLD, OBSERVER, observed) for observed in there]
    steps = list(run(method, REF, MOV, several))
    places = [at.x_mov for at in steps[0].detail.encounters]
    assert np.allclose(places, [(T_MOV_WORLD @ observed).xy for observed in there])
    assert off(steps[-1].detail)[0] < 0.1


def test_no_observation_at_all_is_refused_at_once():
    with pytest.raises(SettingError, match="at least one"):
        run("spectra-swarm", REF, MOV, [])


@pytest.mark.parametrize("method", list(METHODS))
def test_the_same_seed_gives_the_same_answer_to_the_last_bit(method):
    once, again = merge(REF, MOV, SEEN, method, seed=3), merge(REF, MOV, SEEN, method, seed=3)
    assert once.T_ref_mov == again.T_ref_mov
    assert once.value == again.value
    assert np.array_equal(once.fusion.merged.cells, again.fusion.merged.cells)


def test_the_number_of_threads_does_not_change_the_answer(monkeypatch):
    many = merge(REF, MOV, SEEN, config=QUICK)
    monkeypatch.setattr(kernels, "cores", lambda: 1)
    assert merge(REF, MOV, SEEN, config=QUICK).T_ref_mov == many.T_ref_mov


def test_two_maps_of_different_flats_are_refused():
    other = np.rot90(MOV.cells, 1)[:, ::-1].copy()  # a mirror image: no turn makes it the same
    mirrored = GridMap(other, MOV.resolution, MOV.origin)
    assert not merge(REF, mirrored, SEEN).verdict.accepted


def test_maps_without_a_wall_in_common_are_refused_with_a_reason():
    empty = GridMap(np.full(MOV.cells.shape, -1, dtype=np.int8), MOV.resolution, MOV.origin)
    result = merge(REF, empty, SEEN)
    assert not result.verdict.accepted
    assert result.verdict.reason.startswith("Refused: ")


def test_the_steps_come_in_the_order_of_the_method_and_end_in_the_result():
    steps = list(run("spectra-swarm", REF, MOV, SEEN, QUICK))
    order = list(dict.fromkeys(step.stage for step in steps))
    assert order == ["observe", "augment", "spectra", "search", "refine", "weigh", "fuse", "verdict"]
    assert isinstance(steps[-1].detail, MergeResult)
    assert set(steps[-1].detail.timings_s) == set(order)
    assert all(step.seconds >= 0 and not step.reused for step in steps)


def test_every_turn_and_its_twin_becomes_a_candidate_and_the_best_look_ranks_them():
    details = [step.detail for step in run("spectra-swarm", REF, MOV, SEEN, QUICK)]
    match = next(d for d in details if isinstance(d, HoughDetail)).match
    shifts = [d for d in details if isinstance(d, ShiftDetail)]
    ranked = next(d for d in details if isinstance(d, CandidatesDetail)).candidates
    assert [d.candidate.T_ref_mov.theta for d in shifts] == pytest.approx(match.turns)
    assert sorted(c.T_ref_mov.theta for c in ranked) == pytest.approx(sorted(match.turns))
    looks = [c.value for c in ranked]
    assert looks == sorted(looks, reverse=True)


def test_the_swarm_works_on_the_best_candidates_only_and_all_answers_are_kept():
    config = replace(QUICK, refine=RefineConfig(candidates=2))
    details = [step.detail for step in run("spectra-swarm", REF, MOV, SEEN, config)]
    worked_on = {(d.index, d.total) for d in details if isinstance(d, RefineDetail)}
    assert worked_on == {(0, 2), (1, 2)}
    result = details[-1]
    candidates = next(d for d in details if isinstance(d, CandidatesDetail)).candidates
    assert len(result.answers) == len(candidates)
    assert [a.value for a in result.answers] == sorted((a.value for a in result.answers), reverse=True)
    assert result.T_ref_mov == result.answers[0].T_ref_mov


def stages_run_again(memo, config, seed=0):
    return {s.stage for s in run("spectra-swarm", REF, MOV, SEEN, config, seed, memo) if not s.reused}


@pytest.mark.parametrize(
    ("change", "again"),
    [
        ({}, set()),
        ({"conflict": ConflictRule.REF_WINS}, {"fuse", "verdict"}),
        ({"verdict": VerdictConfig(accept_from=0.9)}, {"verdict"}),
        ({"swarm": replace(QUICK.swarm, omega=0.6)}, {"refine", "weigh", "fuse", "verdict"}),
        ({"window": WindowConfig(margin=0.3)}, {"search", "refine", "weigh", "fuse", "verdict"}),
        (
            {"augment": AugmentConfig(spread=2.0)},
            {"augment", "spectra", "search", "refine", "weigh", "fuse", "verdict"},
        ),
    ],
)
def test_a_changed_setting_runs_only_what_follows_it(change, again):
    memo = {}
    first = list(run("spectra-swarm", REF, MOV, SEEN, QUICK, 0, memo))
    assert stages_run_again(memo, replace(QUICK, **change)) == again
    if not again:
        second = list(run("spectra-swarm", REF, MOV, SEEN, QUICK, 0, memo))
        assert [step.detail for step in second] == [step.detail for step in first]


def test_what_is_reused_is_what_a_fresh_run_would_give():
    memo = {}
    list(run("spectra-swarm", REF, MOV, SEEN, QUICK, 0, memo))
    changed = replace(QUICK, augment=AugmentConfig(spread=2.0))
    *_, reused = run("spectra-swarm", REF, MOV, SEEN, changed, 0, memo)
    assert reused.detail.T_ref_mov == merge(REF, MOV, SEEN, config=changed).T_ref_mov


def test_a_stage_left_half_way_is_not_taken_for_done():
    memo = {}
    for step in run("spectra-swarm", REF, MOV, SEEN, QUICK, 0, memo):
        if isinstance(step.detail, RefineDetail):
            break
    again = stages_run_again(memo, QUICK)
    assert again == {"refine", "weigh", "fuse", "verdict"}


def test_another_seed_searches_anew_but_keeps_the_spectra():
    memo = {}
    list(run("spectra-swarm", REF, MOV, SEEN, QUICK, 0, memo))
    assert stages_run_again(memo, QUICK, seed=1) == {"search", "refine", "weigh", "fuse", "verdict"}


def test_the_intensity_changes_gamma_and_not_the_answer():
    low, high = (
        merge(REF, MOV, SEEN, config=replace(QUICK, augment=AugmentConfig(intensity=i)))
        for i in (10.0, 100.0)
    )
    assert high.value == pytest.approx(100 * low.value, rel=1e-3)
    distance, angle = pose_error(low.T_ref_mov, high.T_ref_mov, low.pivot)
    assert distance < 0.01
    assert angle < np.deg2rad(0.2)


def test_the_covariance_is_one_and_narrower_than_the_box():
    result = merge(REF, MOV, SEEN)
    assert np.allclose(result.covariance, result.covariance.T)
    assert np.all(np.linalg.eigvalsh(result.covariance) > 0)
    lever = np.eye(3)  # from (Δx, Δy, Δθ) to where the seen robot goes
    lever[:2, 2] = (result.T_ref_mov @ Pose2(*result.pivot)).xy - result.T_ref_mov.xy
    lever[:2, 2] = -lever[1, 2], lever[0, 2]
    at_robot = lever @ result.covariance @ lever.T
    assert np.sqrt(np.diag(at_robot)[:2]).max() < 0.3


def test_a_candidate_without_half_of_the_best_is_given_up_and_says_so():
    details = [step.detail for step in run("spectra-swarm", REF, MOV, SEEN)]
    result = details[-1]
    given_up = [a for a in result.answers if a.stopped.startswith("given up")]
    assert given_up
    assert all(a.value < 0.5 * result.value for a in given_up)
    last = {d.index: d.state for d in details if isinstance(d, RefineDetail)}
    assert all(state.stopped for state in last.values())
