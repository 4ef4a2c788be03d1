import numpy as np
import pytest
from drawn import drawn_map, flat_pair, poses
from hypothesis import given, settings
from hypothesis import strategies as st

from algorithms.common import parallel_kernels as kernels
from algorithms.common.pose import Pose2
from algorithms.maps.grid_map import GridMap
from algorithms.observations.observation import encounter
from algorithms.optimisation.objective import Lookup, make_objective
from algorithms.spectra.augmented_map import augment

REF, MOV, SEEN, T_REF_MOV = flat_pair()
AT = encounter(SEEN)


def lift(grid, x_hat, spread=2.0, intensity=100.0):
    return augment(grid, x_hat, np.eye(2) * spread**2, intensity)


def around_truth(n, seed=0, size=(0.5, 0.5, 0.2)):
    return T_REF_MOV.array() + np.random.default_rng(seed).uniform(-1, 1, (n, 3)) * size


def by_the_book(ref, mov, T, lookup):
    """Eq. (17), cell by cell, on the rasters themselves: slow, and written from the definition."""
    level = np.zeros(ref.grid.cells.shape)
    level[ref.rows, ref.cols] = ref.levels
    rows, cols = level.shape

    def at(row, col):
        return level[row, col] if 0 <= row < rows and 0 <= col < cols else 0.0

    total = 0.0
    for point, weight in zip(mov.points, mov.levels, strict=True):
        u, v = ref.grid.grid_coordinates(T.apply(point))
        if lookup is Lookup.NEAREST:
            total += weight * at(int(np.floor(v)), int(np.floor(u)))
            continue
        col, row = int(np.floor(u - 0.5)), int(np.floor(v - 0.5))
        du, dv = u - 0.5 - col, v - 0.5 - row
        total += weight * (
            (1 - du) * (1 - dv) * at(row, col) + du * (1 - dv) * at(row, col + 1)
            + (1 - du) * dv * at(row + 1, col) + du * dv * at(row + 1, col + 1)
        )  # fmt: skip
    return total


@pytest.mark.parametrize("lookup", list(Lookup))
@pytest.mark.parametrize("mov_resolution", [0.05, 0.08])
def test_it_is_the_sum_of_the_definition(lookup, mov_resolution):
    ref, mov, seen, T_ref_mov = flat_pair(mov_resolution=mov_resolution)
    at = encounter(seen)
    a, b = lift(ref, at.x_ref), lift(mov, at.x_mov)
    candidates = np.vstack([T_ref_mov.array(), T_ref_mov.array() + (0.313, -0.207, 0.11)])
    expected = [by_the_book(a, b, Pose2.from_array(t), lookup) for t in candidates]
    # nearest: a point on the border of two cells may fall to either side in 32 bits
    tolerance = 1e-4 if lookup is Lookup.BILINEAR else 2e-3
    assert np.allclose(make_objective(a, b, lookup)(candidates), expected, rtol=tolerance)


def test_it_is_the_sum_of_the_definition_for_a_yawed_raster():
    ref = drawn_map(Pose2(1, 2, 0.4), origin_yaw=0.7)
    mov = drawn_map(Pose2(-3, 0, -0.9), origin_yaw=-1.2)
    T = Pose2(1, 2, 0.4) @ Pose2(-3, 0, -0.9).inverse()
    a = lift(ref, Pose2(1, 2, 0.4).apply(np.array([4.0, 3.0])))
    b = lift(mov, Pose2(-3, 0, -0.9).apply(np.array([4.0, 3.0])))
    value = make_objective(a, b)(T.array()[None])[0]
    assert value == pytest.approx(by_the_book(a, b, T, Lookup.BILINEAR), rel=1e-4)


@pytest.mark.parametrize("lookup", list(Lookup))
def test_the_known_pose_beats_poses_around_it(lookup):
    objective = make_objective(lift(REF, AT.x_ref), lift(MOV, AT.x_mov), lookup)
    others = around_truth(300)
    far = np.abs(others - T_REF_MOV.array()).max(axis=1) > 0.15
    assert objective(T_REF_MOV.array()[None])[0] > objective(others[far]).max()


@settings(max_examples=20, deadline=None)
@given(poses)
def test_it_is_never_negative_and_nothing_far_away(T):
    objective = make_objective(lift(REF, AT.x_ref), lift(MOV, AT.x_mov))
    assert objective(T.array()[None])[0] >= 0
    beyond = T_REF_MOV.array() + (500.0, -300.0, 0.0)
    assert objective(beyond[None])[0] == 0


@settings(max_examples=10, deadline=None)
@given(st.floats(1, 1000), st.floats(1, 1000))
def test_the_intensity_scales_it_and_moves_nothing(first, second):
    def values(intensity):
        return make_objective(
            lift(REF, AT.x_ref, intensity=intensity), lift(MOV, AT.x_mov, intensity=intensity)
        )(around_truth(50))

    a, b = values(first), values(second)
    assert np.allclose(a * (second / first) ** 2, b, rtol=1e-5)


@pytest.mark.parametrize("lookup", list(Lookup))
@pytest.mark.parametrize("threads", [1, 2, 3, 7])
def test_the_same_bits_on_any_number_of_threads(lookup, threads, monkeypatch):
    wide = make_objective(lift(REF, AT.x_ref, 5.0), lift(MOV, AT.x_mov, 5.0), lookup)
    poses = around_truth(2000)
    monkeypatch.setattr(kernels, "cores", lambda: 1)
    alone = wide(poses)
    monkeypatch.setattr(kernels, "cores", lambda: threads)
    assert np.array_equal(alone, wide(poses))


def test_a_map_without_walls_is_worth_nothing_everywhere():
    empty = GridMap(np.zeros((50, 50), dtype=np.int8), 0.05)
    objective = make_objective(lift(empty, np.ones(2)), lift(MOV, AT.x_mov))
    assert not objective(around_truth(20)).any()
    assert not make_objective(lift(REF, AT.x_ref), lift(empty, np.ones(2)))(around_truth(20)).any()
