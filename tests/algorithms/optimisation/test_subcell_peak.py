from math import cos, pi, sin

import numpy as np
import pytest
from drawn import flat_pair
from hypothesis import given, settings
from hypothesis import strategies as st

from algorithms.common.pose import Pose2, pose_error
from algorithms.maps.grid_map import FREE, OCCUPIED, GridMap
from algorithms.observations.observation import Observation, encounter
from algorithms.observations.search_window import CoupledWindow, WindowConfig, coupled_window
from algorithms.optimisation.covariance import covariance_of
from algorithms.optimisation.likelihood_field import AgreementConfig, make_agreement
from algorithms.optimisation.subcell_peak import climb_to_peak
from algorithms.spectra.augmented_map import AugmentConfig

REF, MOV, SEEN, T = flat_pair()
AT = encounter(SEEN)
AGREEMENT = make_agreement(REF, MOV, [AT], AugmentConfig(spread=4.0), AgreementConfig())
WINDOW = coupled_window([AT], WindowConfig())
WIDEST = np.array([0.3, 0.3, 0.2])
LEAST = np.array([0.01, 0.01, 0.001])


def beside(x, y, turn):
    """The known pose, robot 2 moved by (x, y) and turned on the spot."""
    place = T.apply(AT.x_mov) + (x, y)
    theta = T.theta + turn
    back = Pose2(theta=theta).apply(AT.x_mov)
    return Pose2(*(place - back).tolist(), theta)


@settings(max_examples=25)
@given(st.floats(-0.07, 0.07), st.floats(-0.07, 0.07), st.floats(-0.012, 0.012))
def test_from_a_neighbour_on_the_lattice_it_climbs_to_within_a_third_of_a_cell(x, y, turn):
    peak = climb_to_peak(AGREEMENT, beside(x, y, turn), WINDOW, 4.0)
    distance, angle = pose_error(peak.T_ref_mov, T, AT.x_mov)
    assert distance < 0.018
    assert angle < np.deg2rad(0.25)


@given(st.floats(-2, 2), st.floats(-2, 2), st.floats(-3, 3))
def test_it_never_ends_lower_than_it_began_and_tells_the_value_where_it_ends(x, y, turn):
    start = beside(x, y, turn)
    peak = climb_to_peak(AGREEMENT, start, WINDOW, 4.0)
    before, after = AGREEMENT(np.array([start.array(), peak.T_ref_mov.array()]))
    assert peak.value >= before - 1e-9
    assert peak.value == pytest.approx(after, abs=1e-4)


@given(st.floats(0.05, 1.0), st.floats(-pi, pi), st.floats(-0.02, 0.02))
def test_it_does_not_step_off_the_edge_of_the_window(sigma, way, turn):
    """The top, beyond the edge, is what the search was kept from."""
    edge = CoupledWindow(
        (T.apply(AT.x_mov) + 4.0 * sigma * np.array([cos(way), sin(way)]))[None],
        AT.x_mov[None],
        np.eye(2)[None] * sigma**2,
        k=3.9,
    )
    off = 0.11 * sigma
    start = beside(off * cos(way), off * sin(way), turn)
    assert edge.contains(start.array()[None]).all()
    assert edge.contains(climb_to_peak(AGREEMENT, start, edge, 4.0).T_ref_mov.array()[None]).all()


def covariance_at_robot(T_ref_mov, covariance):
    x, y = (T_ref_mov.apply(AT.x_mov) - T_ref_mov.xy).tolist()
    jacobian = np.array([[1, 0, -y], [0, 1, x], [0, 0, 1]])
    return jacobian @ covariance @ jacobian.T


def test_the_covariance_is_that_of_a_sharp_peak_in_a_flat_full_of_walls():
    peak = climb_to_peak(AGREEMENT, T, WINDOW, 4.0)
    covariance = covariance_of(peak, AT.x_mov, 0.5, WIDEST, LEAST)
    assert np.allclose(covariance, covariance.T)
    assert np.all(np.linalg.eigvalsh(covariance) > 0)
    at_robot = np.sqrt(np.diag(covariance_at_robot(peak.T_ref_mov, covariance)))
    assert np.all(at_robot[:2] < 0.05)
    assert at_robot[2] < np.deg2rad(1)


def test_more_wall_per_measurement_is_a_wider_covariance():
    peak = climb_to_peak(AGREEMENT, T, WINDOW, 4.0)
    narrow, wide = (covariance_of(peak, AT.x_mov, metres, WIDEST, LEAST) for metres in (0.25, 1.0))
    assert np.all(np.linalg.eigvalsh(wide - narrow) > -1e-12)
    assert np.trace(wide) > np.trace(narrow)


def test_along_a_bare_corridor_nothing_is_known_but_what_the_sighting_says():
    cells = np.full((60, 600), FREE, dtype=np.int8)
    cells[:2], cells[-2:] = OCCUPIED, OCCUPIED
    grid = GridMap(cells, 0.05)
    at = encounter(Observation(Pose2(13.0, 1.5), 15.0, 1.5, 2.0, 0.0))
    objective = make_agreement(grid, grid, [at], AugmentConfig(spread=2.0), AgreementConfig())
    peak = climb_to_peak(objective, Pose2(), coupled_window([at], WindowConfig()), 2.0)
    covariance = covariance_of(peak, at.x_mov, 0.5, WIDEST, LEAST)
    x, y = (peak.T_ref_mov.apply(at.x_mov) - peak.T_ref_mov.xy).tolist()
    jacobian = np.array([[1, 0, -y], [0, 1, x], [0, 0, 1]])
    along, across, _ = np.sqrt(np.diag(jacobian @ covariance @ jacobian.T))
    assert along == pytest.approx(WIDEST[0], rel=0.2)
    assert across < 0.03
