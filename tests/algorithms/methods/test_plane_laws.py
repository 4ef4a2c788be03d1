"""What a merge without a sighting owes: laws, on simulated buildings."""

from __future__ import annotations

from dataclasses import asdict
from functools import cache
from itertools import islice, pairwise, permutations
from math import radians

import numpy as np
import pytest
from drawn import T_MOV_WORLD, T_REF_WORLD, drawn_map
from hypothesis import example, given, settings
from hypothesis import strategies as st
from simulated import BUILDINGS, SimulatedBuilding, cases_of

from algorithms.common.parallel_kernels import use_threads
from algorithms.common.pose import Pose2, pose_error
from algorithms.maps.grid_map import GridMap
from algorithms.methods.merge_result import MergeResult
from algorithms.methods.registry import PLANE_METHOD, merge
from algorithms.observations.priors import InitialPose, TurnPrior

NOISE = 0.02  # of a probability
PAIRS = [(*building, 0) for building in BUILDINGS] + [("corridor", 3, 0.3, 1), ("warehouse", 20, 0.3, 1)]
UNRELATED = list(islice(permutations([b for b in BUILDINGS if b[0] != "warehouse"], 2), 10))


def named(value: object) -> str:
    return "_".join(str(part) for part in value) if isinstance(value, tuple) else str(value)


@cache
def alone(kind: str, seed: int, overlap: float, n: int) -> MergeResult:
    """A pair of a building, merged by its walls."""
    case = cases_of(kind, seed, overlap)[n]
    return merge(case.ref, case.mov)


@pytest.mark.parametrize(("first", "second"), UNRELATED, ids=named)
def test_no_sighting_on_maps_of_different_buildings_is_refused(
    first: SimulatedBuilding, second: SimulatedBuilding
):
    verdict = merge(cases_of(*first)[0].ref, cases_of(*second)[0].mov).verdict
    assert not verdict.accepted
    assert verdict.probability < 0.3


@pytest.mark.parametrize("pair", PAIRS, ids=named)
def test_the_more_is_truly_known_the_likelier_is_the_merge(pair):
    """From nothing over a rough turn and a rough pose to a good one, each off by half its deviation."""
    *building, n = pair
    case = cases_of(*building)[n]
    T = case.T_ref_mov
    turn = TurnPrior(T.theta + radians(5), radians(10))
    poses = [
        InitialPose(Pose2(T.x + m / 2, T.y - m / 2, T.theta + a / 2), m, m, a)
        for m, a in ((2.0, radians(10)), (0.5, radians(3)))
    ]
    told = [alone(*pair), *(merge(case.ref, case.mov, known, PLANE_METHOD) for known in (turn, *poses))]
    likely = [result.verdict.probability for result in told]
    for before, after in pairwise(likely):
        assert after > before - NOISE, likely


@pytest.mark.parametrize("pair", PAIRS, ids=named)
def test_swapping_the_maps_inverts_the_answer(pair):
    *building, n = pair
    case, one = cases_of(*building)[n], alone(*pair)
    other = merge(case.mov, case.ref)
    distance, angle = pose_error(other.T_ref_mov.inverse(), one.T_ref_mov, one.pivot)
    assert distance < 0.005
    assert angle < radians(0.05)
    assert other.verdict.probability == pytest.approx(one.verdict.probability, abs=NOISE)


def most_moved(grid: GridMap, T: Pose2, other: Pose2) -> float:
    """By how much two transforms put a wall of a map at two places, at most; metres."""
    return float(np.linalg.norm(T.apply(grid.points) - other.apply(grid.points), axis=1).max())


@given(st.one_of(st.just(1.0), st.floats(1.01, 4)), st.booleans())
@example(1.0, False)
@example(4.0, False)
@example(4.0, True)
@settings(max_examples=5)
def test_maps_of_other_resolutions_merge_to_a_cell_of_the_coarser_one(ratio, first):
    cells = (0.05 * ratio, 0.05) if first else (0.05, 0.05 * ratio)
    ref = drawn_map(T_REF_WORLD, cells[0], seen=(-1, -1, 6.7, 8))
    mov = drawn_map(T_MOV_WORLD, cells[1], seen=(2.5, -1, 10, 8))
    result = merge(ref, mov)
    assert most_moved(mov, result.T_ref_mov, T_REF_WORLD @ T_MOV_WORLD.inverse()) < max(cells)
    assert result.verdict.accepted
    assert result.fusion.merged.resolution == 0.05
    coarser = {1 if first else 2: max(cells)}
    assert result.fusion.resampled == (coarser if ratio > 1 else {})


@pytest.mark.parametrize("building", BUILDINGS[1:3], ids=named)
def test_one_thread_and_two_give_the_same_answer_bit_for_bit(building):
    case = cases_of(*building)[0]
    told = []
    try:
        for most in (1, 2):
            use_threads(most)
            told.append(merge(case.ref, case.mov))
    finally:
        use_threads(64)
    one, two = told
    assert [each.T_ref_mov for each in one.weighed] == [each.T_ref_mov for each in two.weighed]
    assert [each.score for each in one.weighed] == [each.score for each in two.weighed]
    assert asdict(one.verdict) == asdict(two.verdict)
    np.testing.assert_array_equal(one.covariance, two.covariance)
    np.testing.assert_array_equal(one.fusion.merged.cells, two.fusion.merged.cells)
