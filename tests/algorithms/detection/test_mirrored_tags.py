"""A tag that reads backwards is in a mirror."""

from __future__ import annotations

import cv2
import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from algorithms.detection.mirrored_tags import FAMILIES, tags_read_backwards
from algorithms.simulator.views.robot_body import RobotBody

BOX = (40.0, 30.0, 140.0, 130.0)


def picture_of(print_on_it, side, tilt=0.0, light=1.0):
    """A white square with a print on it, on a wall, seen from the front or at an angle."""
    wall = np.full((160, 180), 150, np.uint8)
    paper = cv2.copyMakeBorder(print_on_it, 12, 12, 12, 12, cv2.BORDER_CONSTANT, value=255)
    paper = cv2.resize(paper, (side, side), interpolation=cv2.INTER_AREA)
    narrow = cv2.resize(paper, (int(side * np.cos(tilt)), side), interpolation=cv2.INTER_AREA)
    top, left = 80 - side // 2, 90 - narrow.shape[1] // 2
    wall[top : top + side, left : left + narrow.shape[1]] = narrow
    return np.repeat((wall * light).astype(np.uint8)[..., None], 3, axis=2)


@given(
    st.sampled_from(FAMILIES),
    st.integers(0, 34),
    st.integers(50, 95),
    st.floats(0.0, 0.7),
    st.floats(0.3, 1.0),
)
def test_a_tag_and_its_mirror_image_are_told_apart(family, number, side, tilt, light):
    assume((family, number) != (cv2.aruco.DICT_APRILTAG_25h9, 22))  # its mirror image is a tag, too
    tag = cv2.aruco.generateImageMarker(cv2.aruco.getPredefinedDictionary(family), number, 100)
    picture = picture_of(tag, side, tilt, light)
    assert not tags_read_backwards(picture, BOX)
    assert tags_read_backwards(picture[:, ::-1], BOX)


@given(st.integers(0, 2**32 - 1))
def test_a_print_that_is_no_tag_does_not_read_backwards(seed):
    blocks = np.kron(np.random.default_rng(seed).integers(0, 2, (8, 8)) * 255, np.ones((12, 12)))
    assert not tags_read_backwards(picture_of(blocks.astype(np.uint8), 80), BOX)


@pytest.mark.parametrize(
    "box", [(-20.0, -20.0, -5.0, -5.0), (0.0, 0.0, 0.4, 0.4), (170.0, 150.0, 300.0, 300.0)]
)
def test_a_box_at_the_edge_of_the_image_or_beyond_it_is_no_mirror(box):
    assert not tags_read_backwards(np.zeros((160, 180, 3), np.uint8), box)


@pytest.mark.parametrize("face", range(4))
def test_the_boards_of_the_simulated_robot_read_backwards_in_a_mirror_alone(face):
    board = RobotBody().board(face)
    picture = np.full((320, 320, 3), 128, np.uint8)
    smaller = cv2.resize(board, (board.shape[1] // 2, board.shape[0] // 2), interpolation=cv2.INTER_AREA)
    picture[60 : 60 + smaller.shape[0], 60 : 60 + smaller.shape[1]] = smaller
    box = 60.0, 60.0, 60.0 + smaller.shape[1], 60.0 + smaller.shape[0]
    assert not tags_read_backwards(picture, box)
    assert tags_read_backwards(picture[:, ::-1], (320 - box[2], box[1], 320 - box[0], box[3]))
