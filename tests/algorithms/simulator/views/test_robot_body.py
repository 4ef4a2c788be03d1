import cv2
import numpy as np
import pytest

from algorithms.common.pose import Pose2
from algorithms.simulator.views.robot_body import PIXEL, RobotBody

DETECTOR = cv2.aruco.ArucoDetector(cv2.aruco.getPredefinedDictionary(cv2.aruco.DICT_APRILTAG_36h11))


def test_its_half_size_is_the_mean_of_half_its_sides():
    body = RobotBody()
    assert body.half_size == pytest.approx((0.46 / 2 + 0.40 / 2) / 2)


@pytest.mark.parametrize("face", range(4))
def test_each_board_shows_the_tag_of_its_face(face):
    board = np.pad(
        RobotBody(tags=(7, 11, 13, 17)).board(face), [(30, 30), (30, 30), (0, 0)], constant_values=230
    )
    corners, ids, _ = DETECTOR.detectMarkers(np.ascontiguousarray(board))
    assert ids.ravel().tolist() == [(7, 11, 13, 17)[face]]
    width = np.linalg.norm(corners[0][0][1] - corners[0][0][0]) * PIXEL
    assert width == pytest.approx(0.256, abs=0.006)


def test_boards_at_the_side_have_bars_that_those_at_front_and_back_lack():
    body = RobotBody()
    middle = (body.high - body.low) / 2 / PIXEL
    rows = np.s_[int(middle) - 20 : int(middle) + 20]
    bars = [(body.board(face)[rows, :30].max(axis=2) < 60).mean() for face in range(4)]
    assert max(bars[:2]) == 0
    assert min(bars[2:]) > 0.4


def test_its_footprint_and_its_solids_stand_where_its_pose_says():
    body, pose = RobotBody(), Pose2(3.0, -2.0, 0.7)
    corners = pose.inverse().apply(body.footprint(pose))
    assert np.abs(np.abs(corners) - [0.23, 0.20]).max() < 1e-9
    boards = body.solids(pose, 4)[0]
    assert np.abs(np.sort(boards.corners(), axis=0) - np.sort(body.footprint(pose), axis=0)).max() < 1e-4
    assert {part.robot for part in body.solids(pose, 4)} == {4}
    assert max(part.top for part in body.solids(pose, 4)) > body.high
