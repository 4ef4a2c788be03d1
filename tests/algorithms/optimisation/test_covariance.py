"""Both covariances of a transform, seen from where robot 2 goes: what a person would measure with a rule."""

from __future__ import annotations

from math import pi

import numpy as np
import pytest
from drawn import flat_pair
from hypothesis import given, settings
from hypothesis import strategies as st

from algorithms.common.pose import FloatArray, Pose2, rotation, wrap_angles
from algorithms.maps.grid_map import FREE, OCCUPIED, GridMap
from algorithms.observations.observation import Observation, encounter
from algorithms.observations.search_window import WindowConfig, coupled_window
from algorithms.optimisation.covariance import covariance_of, peak_covariance
from algorithms.optimisation.likelihood_field import AgreementConfig, make_agreement
from algorithms.optimisation.objective import make_objective
from algorithms.optimisation.search_box import SearchBox
from algorithms.optimisation.subcell_peak import Peak, climb_to_peak
from algorithms.spectra.augmented_map import AugmentConfig, augment

REF, MOV, SEEN, T = flat_pair()
AT = encounter(SEEN)
AGREEMENT = make_agreement(REF, MOV, [AT], AugmentConfig(spread=4.0), AgreementConfig())
WIDEST = np.array([0.3, 0.3, 0.2])
LEAST = np.array([0.01, 0.01, 0.001])
PLACES = st.tuples(st.floats(-20, 20), st.floats(-20, 20)).map(np.array)
TURNS = st.floats(-pi, pi)
DRAWS = np.random.default_rng(0).standard_normal((20_000, 3))


@st.composite
def bells(draw: st.DrawFn) -> FloatArray:
    """(3, 3) covariances of where robot 2 goes and of the turn; metres and radians."""
    sigma = np.array([draw(st.floats(0.01, 0.2)), draw(st.floats(0.01, 0.2)), draw(st.floats(0.001, 0.02))])
    axes = np.linalg.qr(np.random.default_rng(draw(st.integers(0, 999))).standard_normal((3, 3)))[0]
    strengths = draw(st.lists(st.floats(0.2, 1.0), min_size=3, max_size=3))
    return np.outer(sigma, sigma) * (axes @ np.diag(strengths) @ axes.T)


def at_robot(T_ref_mov: Pose2, covariance: FloatArray, place: FloatArray) -> FloatArray:
    """(3, 3) covariance of where a place of map 2 goes and of the turn, from transforms drawn at random.

    A thousandth of the deviation, for over small turns a swing is a straight line.
    """
    drawn = T_ref_mov.array() + 1e-3 * DRAWS @ np.linalg.cholesky(covariance).T
    c, s = np.cos(drawn[:, 2]), np.sin(drawn[:, 2])
    x, y = place
    went = np.column_stack([drawn[:, 0] + c * x - s * y, drawn[:, 1] + s * x + c * y, drawn[:, 2]])
    return np.cov(went.T) * 1e6


def alike(one: FloatArray, other: FloatArray) -> bool:
    """Whether two covariances are the same up to the luck of the draw."""
    inverse = np.linalg.inv(np.linalg.cholesky(other))
    return np.allclose(inverse @ one @ inverse.T, np.eye(3), atol=0.05)


class Bell:
    """An objective that is a bell around a transform, by where it puts the pivot and how it turns."""

    cell = 0.05

    def __init__(self, box: SearchBox, top: FloatArray, covariance: FloatArray) -> None:
        self.box, self.top, self.precision = box, top, np.linalg.inv(covariance)

    def __call__(self, poses: FloatArray) -> FloatArray:
        c, s = np.cos(poses[:, 2]), np.sin(poses[:, 2])
        x, y = self.box.pivot
        at = np.column_stack([poses[:, 0] + c * x - s * y, poses[:, 1] + s * x + c * y, poses[:, 2]])
        off = at - self.top
        off[:, 2] = wrap_angles(off[:, 2])
        return np.exp(-0.5 * np.einsum("ni,ij,nj->n", off, self.precision, off))


def box_around(pivot: FloatArray, place: FloatArray, turn: float, half=(1.0, 1.0, 0.2)) -> SearchBox:
    centre = np.append(place, turn)
    return SearchBox(centre - np.array(half), centre + np.array(half), pivot)


# ---- the width of a peak of Γ


@settings(max_examples=30)
@given(bells(), PLACES, PLACES, TURNS)
def test_the_width_of_a_bell_is_the_bells_own_wherever_the_frames_have_their_origins(
    bell, pivot, place, turn
):
    box = box_around(pivot, place, turn)
    top = box.transform(np.append(place, turn))
    found = peak_covariance(Bell(box, np.append(place, turn), bell), top, box, 4.0)
    assert alike(at_robot(top, found, pivot), bell)


def test_where_an_objective_has_no_peak_the_boxs_own_variance_stands_for_it():
    """Of a flat one all of the box is as likely; where a transform is worth nothing nothing is known."""
    pivot, place = np.array([3.0, -2.0]), np.array([1.0, 5.0])
    box = box_around(pivot, place, 0.3, (0.6, 0.3, 0.1))
    top = box.transform(np.append(place, 0.3))

    class Nothing:
        cell = 0.05

        def __call__(self, poses):
            return np.zeros(len(poses))

    found = at_robot(top, peak_covariance(Nothing(), top, box, 4.0), pivot)
    assert alike(found, np.diag(np.square([1.2, 0.6, 0.2]) / 12))


def test_gamma_in_a_flat_full_of_walls_has_a_peak_about_a_wall_wide():
    sigma = AugmentConfig(spread=3.0).covariance()
    gamma = make_objective(augment(REF, AT.x_ref, sigma, 100.0), augment(MOV, AT.x_mov, sigma, 100.0))
    box = box_around(AT.x_mov, AT.x_ref, T.theta)
    found = peak_covariance(gamma, T, box, 3.0)
    assert np.allclose(found, found.T)
    assert np.all(np.linalg.eigvalsh(found) > 0)
    x, y, turn = np.sqrt(np.diag(at_robot(T, found, AT.x_mov)))
    assert 0.02 < x < 0.2
    assert 0.02 < y < 0.2
    assert turn < np.deg2rad(5)


# ---- the error that metres of wall leave


@given(bells(), PLACES, TURNS, PLACES)
def test_what_walls_leave_open_is_the_inverse_of_how_the_peak_bends(bell, pivot, turn, place):
    peak = Peak(Pose2(*place.tolist(), turn), 20.0, 0.25 * np.linalg.inv(bell))
    found = covariance_of(peak, pivot, 0.25, np.full(3, 1e6), np.zeros(3))
    assert alike(at_robot(peak.T_ref_mov, found, pivot), bell)


@given(bells(), TURNS)
def test_turning_the_frame_of_map_1_turns_the_covariance_with_it(bell, turn):
    pivot = np.array([2.0, -7.0])
    turned = np.eye(3)
    turned[:2, :2] = rotation(turn)
    curvature = np.linalg.inv(bell)
    plain = covariance_of(Peak(T, 20.0, curvature), pivot, 0.5, np.full(3, 9.0), np.zeros(3))
    moved = Peak(Pose2(theta=turn) @ T, 20.0, turned @ curvature @ turned.T)
    found = covariance_of(moved, pivot, 0.5, np.full(3, 9.0), np.zeros(3))
    assert np.allclose(found, turned @ plain @ turned.T, rtol=1e-6, atol=1e-12)


def test_the_covariance_is_that_of_a_sharp_peak_in_a_flat_full_of_walls():
    peak = climb_to_peak(AGREEMENT, T, coupled_window([AT], WindowConfig()), 4.0)
    covariance = covariance_of(peak, AT.x_mov, 0.5, WIDEST, LEAST)
    assert np.allclose(covariance, covariance.T)
    assert np.all(np.linalg.eigvalsh(covariance) > 0)
    x, y, turn = np.sqrt(np.diag(at_robot(peak.T_ref_mov, covariance, AT.x_mov)))
    assert max(x, y) < 0.05
    assert turn < np.deg2rad(1)


def test_more_wall_per_measurement_is_a_wider_covariance():
    peak = climb_to_peak(AGREEMENT, T, coupled_window([AT], WindowConfig()), 4.0)
    narrow, wide = (covariance_of(peak, AT.x_mov, metres, WIDEST, LEAST) for metres in (0.25, 1.0))
    assert np.all(np.linalg.eigvalsh(wide - narrow) > -1e-12)
    assert np.trace(wide) > np.trace(narrow)


@given(bells())
def test_no_error_is_told_to_be_smaller_than_the_least(bell):
    peak = Peak(T, 20.0, 1e9 * np.linalg.inv(bell))
    found = covariance_of(peak, AT.x_mov, 0.5, WIDEST, LEAST)
    assert alike(at_robot(T, found, AT.x_mov), np.diag(LEAST**2))


def test_along_a_bare_corridor_nothing_is_known_but_what_the_sighting_says():
    cells = np.full((60, 600), FREE, dtype=np.int8)
    cells[:2], cells[-2:] = OCCUPIED, OCCUPIED
    grid = GridMap(cells, 0.05)
    at = encounter(Observation(Pose2(13.0, 1.5), 15.0, 1.5, 2.0, 0.0))
    objective = make_agreement(grid, grid, [at], AugmentConfig(spread=2.0), AgreementConfig())
    peak = climb_to_peak(objective, Pose2(), coupled_window([at], WindowConfig()), 2.0)
    covariance = covariance_of(peak, at.x_mov, 0.5, WIDEST, LEAST)
    along, across, _ = np.sqrt(np.diag(at_robot(peak.T_ref_mov, covariance, at.x_mov)))
    assert along == pytest.approx(WIDEST[0], rel=0.2)
    assert across < 0.03
