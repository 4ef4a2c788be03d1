import numpy as np
import pytest
from drawn import T_REF_WORLD, drawn_map
from hypothesis import given
from hypothesis import strategies as st

from algorithms.common.errors import SettingError
from algorithms.maps.grid_map import GridMap
from algorithms.spectra.augmented_map import CUT_AT, AugmentConfig, augment

FLAT = drawn_map(T_REF_WORLD)
X_HAT = T_REF_WORLD.apply(np.array([3.0, 3.0]))
spreads = st.floats(0.3, 5.0)


@given(spreads, st.floats(1, 1000))
def test_a_wall_nearer_to_the_seen_robot_is_never_lower(spread, intensity):
    lifted = augment(FLAT, X_HAT, np.eye(2) * spread**2, intensity)
    distance = np.hypot(*(lifted.points - X_HAT).T)
    order = np.argsort(distance)
    assert np.all(np.diff(lifted.levels[order]) <= 1e-12 * lifted.peak)
    assert np.all(lifted.levels > 0)


@given(spreads)
def test_twice_the_intensity_is_twice_the_level_everywhere(spread):
    once = augment(FLAT, X_HAT, np.eye(2) * spread**2, 50.0)
    twice = augment(FLAT, X_HAT, np.eye(2) * spread**2, 100.0)
    assert np.allclose(twice.levels, 2 * once.levels)


def test_the_level_of_a_wall_one_deviation_away_is_the_normal_density_there():
    # a standard normal in the plane has 0.0965 at one deviation
    one = GridMap(np.array([[100]], dtype=np.int8), 0.1)
    lifted = augment(one, np.array([1.05, 0.05]), np.eye(2), 1.0)
    assert lifted.levels[0] == pytest.approx(0.09653, abs=1e-5)


def test_only_walls_are_lifted_and_all_near_walls_are():
    lifted = augment(FLAT, X_HAT, np.eye(2) * 25.0, 100.0)
    assert len(lifted.points) == np.count_nonzero(FLAT.occupied)
    assert np.all(FLAT.occupied[lifted.rows, lifted.cols])
    assert np.allclose(FLAT.centres(lifted.rows, lifted.cols), lifted.points)


def test_walls_too_far_to_change_a_sum_are_left_out_and_no_others():
    spread = 0.4
    lifted = augment(FLAT, X_HAT, np.eye(2) * spread**2, 100.0)
    near = np.hypot(*(FLAT.points - X_HAT).T) <= CUT_AT * spread
    assert 0 < len(lifted.points) == np.count_nonzero(near) < len(FLAT.points)
    assert lifted.levels.min() > lifted.peak * 2**-24.01


def test_a_tilted_gaussian_is_higher_along_its_long_axis():
    config = AugmentConfig(spread=1.0, aspect=4.0, tilt=90.0)
    cross = np.full((21, 21), -1, dtype=np.int8)
    cross[10, 20] = cross[20, 10] = 100
    lifted = augment(GridMap(cross, 0.1), np.array([1.05, 1.05]), config.covariance(), 1.0)
    right, above = lifted.levels[np.argsort(lifted.rows)]
    assert above > right


def test_the_aspect_keeps_the_height_of_the_peak():
    round_, long = AugmentConfig(), AugmentConfig(aspect=3.0, tilt=20.0)
    peaks = [augment(FLAT, X_HAT, c.covariance(), 100.0).peak for c in (round_, long)]
    assert peaks[0] == pytest.approx(peaks[1])


@pytest.mark.parametrize(
    "sigma", [[[1, 2], [2, 1]], [[0, 0], [0, 0]], [[1, 0.5], [0, 1]], [[-1, 0], [0, -1]]]
)
def test_a_matrix_that_is_no_covariance_is_refused(sigma):
    with pytest.raises(SettingError, match="Σ_aug"):
        augment(FLAT, X_HAT, np.array(sigma, dtype=float), 100.0)


def test_an_encounter_far_off_the_map_lifts_nothing():
    assert len(augment(FLAT, np.array([500.0, 500.0]), np.eye(2), 100.0).points) == 0
