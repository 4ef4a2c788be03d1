from math import cos, pi, sin

import numpy as np
import pytest
from drawn import flat_pair
from hypothesis import given, settings
from hypothesis import strategies as st

from algorithms.common.pose import Pose2, pose_error
from algorithms.observations.observation import encounter
from algorithms.observations.search_window import CoupledWindow, WindowConfig, coupled_window
from algorithms.optimisation.likelihood_field import AgreementConfig, make_agreement
from algorithms.optimisation.subcell_peak import climb_to_peak
from algorithms.spectra.augmented_map import AugmentConfig

REF, MOV, SEEN, T = flat_pair()
AT = encounter(SEEN)
AGREEMENT = make_agreement(REF, MOV, [AT], AugmentConfig(spread=4.0), AgreementConfig())
WINDOW = coupled_window([AT], WindowConfig())


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
