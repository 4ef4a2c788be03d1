from dataclasses import replace

import numpy as np
import pytest
from drawn import OBSERVED, OBSERVER, T_MOV_WORLD, T_REF_MOV, T_REF_WORLD, poses, sighting
from hypothesis import given
from hypothesis import strategies as st

from algorithms.common.errors import SettingError
from algorithms.common.pose import Pose2, pose_error
from algorithms.maps.grid_map import GridMap
from algorithms.observations.observation import (
    bilateral_covariance,
    bilateral_transform,
    encounter,
    encounters_of,
)

in_flat = st.builds(Pose2, st.floats(0, 9), st.floats(0, 7), st.floats(-np.pi, np.pi))
SEEN = sighting(T_REF_WORLD, T_MOV_WORLD, OBSERVER, OBSERVED)


@given(poses, poses, in_flat, in_flat)
def test_the_encounter_is_one_place_in_both_frames(T_ref_world, T_mov_world, observer, observed):
    at = encounter(sighting(T_ref_world, T_mov_world, observer, observed))
    T_ref_mov = T_ref_world @ T_mov_world.inverse()
    assert np.allclose(T_ref_mov.apply(at.x_mov), at.x_ref, atol=1e-6)


@given(poses, poses, in_flat, in_flat)
def test_two_bearings_give_back_the_known_transform(T_ref_world, T_mov_world, observer, observed):
    T = bilateral_transform(sighting(T_ref_world, T_mov_world, observer, observed))
    known = T_ref_world @ T_mov_world.inverse()
    distance, angle = pose_error(T, known, (T_mov_world @ observed).xy)
    assert distance < 1e-6
    assert angle < 1e-6


def test_the_error_ellipse_is_long_across_the_line_of_sight_for_a_far_robot():
    far = replace(SEEN, observer=Pose2(), range=10.0, bearing=0.0, sigma_range=0.05, sigma_bearing=0.05)
    covariance = encounter(far).covariance
    assert covariance[0, 0] == pytest.approx(0.05**2)
    assert covariance[1, 1] == pytest.approx(0.5**2)
    assert covariance[0, 1] == pytest.approx(0.0, abs=1e-12)


@given(st.floats(0, 3), st.floats(-3, 3), st.floats(0.01, 0.5), st.floats(0.001, 0.2))
def test_the_error_ellipse_is_no_needle_however_near_the_robot(metres, bearing, sigma_range, sigma_bearing):
    near = replace(SEEN, range=metres, bearing=bearing, sigma_range=sigma_range, sigma_bearing=sigma_bearing)
    least = np.sqrt(np.linalg.eigvalsh(encounter(near).covariance)[0])
    assert least >= 0.6 * min(sigma_range, max(metres * sigma_bearing, sigma_range - metres)) - 1e-9


def test_robots_at_one_place_are_known_to_a_disc_of_the_deviation_of_the_range():
    together = replace(SEEN, range=0.0, sigma_range=0.07)
    assert encounter(together).covariance == pytest.approx(0.07**2 * np.eye(2), abs=1e-12)
    assert encounter(together).x_ref == pytest.approx(together.observer.xy)


@given(cell=st.floats(0.001, 0.5))
def test_coarse_cells_leave_the_place_of_the_seen_robot_less_certain_in_every_direction(cell):
    exact, coarse = encounter(SEEN).covariance, encounter(SEEN, cell).covariance
    spread = np.random.default_rng(1).uniform(-cell / 2, cell / 2, 100_000).var()
    np.testing.assert_allclose(np.linalg.eigvalsh(coarse - exact), spread, rtol=0.02)


def test_the_encounters_in_two_maps_know_the_cells_of_both():
    fine, coarse = (GridMap(np.zeros((9, 9), dtype=np.int8), cell) for cell in (0.05, 0.25))
    grown = [
        np.trace(encounters_of([SEEN], *grids)[0].covariance)
        for grids in ((fine, fine), (fine, coarse), (coarse, coarse))
    ]
    assert grown == sorted(grown)
    assert encounters_of([SEEN], fine, coarse)[0].covariance == pytest.approx(
        encounters_of([SEEN], coarse, fine)[0].covariance
    )


def test_the_covariance_is_what_noise_on_the_measurement_does():
    rng = np.random.default_rng(1)
    noisy = [
        encounter(
            replace(SEEN, range=SEEN.range + dr, bearing=SEEN.bearing + db)
        ).x_ref
        for dr, db in rng.normal(0, (SEEN.sigma_range, SEEN.sigma_bearing), (4000, 2))
    ]  # fmt: skip
    assert np.allclose(np.cov(np.array(noisy).T), encounter(SEEN).covariance, atol=3e-4)


def test_the_bilateral_covariance_is_what_noise_on_the_measurement_does():
    rng = np.random.default_rng(2)
    noisy = []
    for dr, db, dback in rng.normal(0, (SEEN.sigma_range, *2 * [SEEN.sigma_bearing]), (4000, 3)):
        T = bilateral_transform(
            replace(
                SEEN, range=SEEN.range + dr, bearing=SEEN.bearing + db, bearing_back=SEEN.bearing_back + dback
            )
        )
        noisy.append(T.array() - T_REF_MOV.array())
    sample, stated = np.cov(np.array(noisy).T), bilateral_covariance(SEEN)
    assert np.allclose(sample, stated, atol=0.06 * np.abs(stated).max())


@pytest.mark.parametrize("missing", ["bearing_back", "observed_heading"])
def test_the_bilateral_method_says_what_it_lacks(missing):
    with pytest.raises(SettingError, match="bearing_back"):
        bilateral_transform(replace(SEEN, **{missing: None}))


@pytest.mark.parametrize(
    ("field", "value"),
    [("range", -1.0), ("range", float("nan")), ("sigma_range", 0.0), ("sigma_bearing", -0.1),
     ("bearing", float("inf")), ("observer", Pose2(x=float("nan")))],
)  # fmt: skip
def test_an_impossible_measurement_is_refused_by_name(field, value):
    with pytest.raises(SettingError, match=field):
        replace(SEEN, **{field: value})


@pytest.mark.parametrize("field", ["bearing", "bearing_back"])
def test_a_bearing_in_degrees_is_told_from_one_in_radians(field):
    with pytest.raises(SettingError, match=f"{field} is 73.5 rad.*give radians"):
        replace(SEEN, **{field: 73.5})
