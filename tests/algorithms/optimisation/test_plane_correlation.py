"""The plane: its best hill is the true place, whichever map is the larger, and what is known narrows it."""

from __future__ import annotations

from math import pi, radians

import numpy as np
import pytest
from drawn import flat_pair

from algorithms.common.pose import Pose2, pose_error
from algorithms.maps.coarse_grid import trimmed
from algorithms.observations.pair_problem import Known, PairProblem
from algorithms.observations.priors import InitialPose, TurnPrior
from algorithms.observations.search_window import CoupledWindow, WindowConfig
from algorithms.optimisation.plane_correlation import PlaneConfig, PlaneCorrelation, inverses, places

REF, MOV, SEEN, T_TRUE = flat_pair()
REF, MOV = trimmed(REF), trimmed(MOV)
PIVOT = np.array([SEEN.observed_x, SEEN.observed_y])
PLANE = PlaneCorrelation(REF, MOV, PlaneConfig())


def window(*known: Known) -> CoupledWindow:
    return PairProblem.of(REF, MOV, known).window(WindowConfig(kind="coupled", deviations=3.5), curved=True)


def nearest_turn(theta: float) -> float:
    return float(PLANE.turns[np.abs(np.angle(np.exp(1j * (PLANE.turns - theta)))).argmin()])


@pytest.mark.parametrize("swapped", [False, True])
def test_the_highest_hill_of_all_turns_is_the_true_place_whichever_map_is_called_the_first(swapped):
    ref, mov, truth = (MOV, REF, T_TRUE.inverse()) if swapped else (REF, MOV, T_TRUE)
    pivot = T_TRUE.apply(PIVOT) if swapped else PIVOT
    plane = PlaneCorrelation(ref, mov, PlaneConfig())
    open_window = PairProblem(ref, mov).window(WindowConfig(kind="coupled"))
    looks = [plane.look(turn, open_window, 1) for turn in plane.turns.tolist()]
    best = max(looks, key=lambda look: look.top)
    distance, angle = pose_error(Pose2.from_array(best.poses[0]), truth, pivot)
    assert distance < 0.2
    assert angle < radians(2.5)


def test_a_place_of_the_surface_and_its_transform_say_the_same_shift():
    turn = nearest_turn(T_TRUE.theta)
    one, right, up = PLANE.poses(turn, np.array([40, 40, 41]), np.array([30, 31, 30]))
    assert np.hypot(*(right - one)[:2]) == pytest.approx(PLANE.cell)
    assert np.hypot(*(up - one)[:2]) == pytest.approx(PLANE.cell)
    assert np.angle(np.exp(1j * (one[2] - turn))) == pytest.approx(0, abs=1e-9)


def test_what_is_known_shuts_turns_and_shifts_out_and_never_the_truth():
    turn = nearest_turn(T_TRUE.theta)
    rough = Pose2(T_TRUE.x + 0.3, T_TRUE.y - 0.3, T_TRUE.theta + 0.05)
    for known in (InitialPose(rough, 0.5, 0.5, 0.1), TurnPrior(rough.theta, 0.1), SEEN):
        look = PLANE.look(turn, window(known), 3)
        errors = [pose_error(Pose2.from_array(pose), T_TRUE, PIVOT) for pose in look.poses]
        assert min(metres for metres, _ in errors) < 0.3
    assert (
        PLANE.look(nearest_turn(T_TRUE.theta + pi), window(TurnPrior(T_TRUE.theta, 0.1)), 3).surface is None
    )
    narrow = PLANE.look(turn, window(InitialPose(rough, 0.5, 0.5, 0.1)), 3)
    assert 0 < narrow.shifts < PLANE.look(turn, window(), 3).shifts / 2


def test_hills_beside_a_higher_one_are_no_places_of_their_own():
    poses = np.array([[0.0, 0, 0], [0.2, 0, 0], [3.0, 0, 0], [0.1, 0, 1.0]])
    kept = places(poses, np.array([1, 2, 3, 4], dtype=np.float32), np.zeros(2), 9, 0.5, 0.1)
    assert kept.tolist() == [3, 2, 1]
    assert places(poses, np.ones(4, dtype=np.float32), np.zeros(2), 2, 0.5, 0.1).tolist() == [0, 2]


def test_the_inverse_undoes_a_transform():
    T = Pose2(1.5, -2.0, 0.8)
    assert Pose2.from_array(inverses(T.array()[None])[0]) @ T == Pose2(
        pytest.approx(0, abs=1e-12), pytest.approx(0, abs=1e-12), pytest.approx(0, abs=1e-12)
    )
