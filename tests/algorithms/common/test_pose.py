import numpy as np
import pytest
from drawn import angles, lengths, poses
from hypothesis import given
from hypothesis import strategies as st

from algorithms.common.pose import Pose2, pose_error, wrap_angle, wrap_angles

points = st.lists(st.tuples(lengths, lengths), min_size=1, max_size=5).map(np.array)


@given(poses, points)
def test_inverse_undoes_apply(T_ref_mov, points):
    assert np.allclose(T_ref_mov.inverse().apply(T_ref_mov.apply(points)), points, atol=1e-9)


@given(poses, poses, points)
def test_a_chain_is_one_after_the_other(T_a_b, T_b_c, points):
    assert np.allclose((T_a_b @ T_b_c).apply(points), T_a_b.apply(T_b_c.apply(points)), atol=1e-9)


@given(poses)
def test_the_matrix_is_the_pose(T_ref_mov):
    distance, angle = pose_error(Pose2.from_matrix(T_ref_mov.matrix()), T_ref_mov, np.array([3.0, -2.0]))
    assert distance < 1e-9
    assert angle < 1e-9


@given(st.floats(-1000, 1000))
def test_wrapping_keeps_the_direction_and_lands_in_one_turn(angle):
    wrapped = wrap_angle(angle)
    assert -np.pi < wrapped <= np.pi
    assert np.cos(wrapped) == pytest.approx(np.cos(angle), abs=1e-9)
    assert np.sin(wrapped) == pytest.approx(np.sin(angle), abs=1e-9)
    assert wrap_angles(np.array([angle]))[0] == pytest.approx(wrapped, abs=1e-9) or abs(wrapped) > 3.14159


def test_a_quarter_turn_takes_x_to_y_and_then_shifts():
    assert np.allclose(Pose2(1.0, 2.0, np.pi / 2).apply(np.array([[1.0, 0.0]])), [[1.0, 3.0]])


@given(poses, angles)
def test_the_error_of_a_turn_about_a_point_is_the_turn_alone(T_ref_mov, turn):
    point = np.array([4.0, -1.0])
    where = T_ref_mov.apply(point)
    about = Pose2(*where.tolist()) @ Pose2(theta=turn) @ Pose2(*(-where).tolist())
    distance, angle = pose_error(about @ T_ref_mov, T_ref_mov, point)
    assert distance < 1e-7
    assert angle == pytest.approx(abs(turn), abs=1e-7)
