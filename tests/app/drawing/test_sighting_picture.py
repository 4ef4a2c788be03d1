"""The picture of a sighting: the box is where the detector put it, the laser's points are in its columns."""

from __future__ import annotations

import numpy as np
import pytest
from looked_at import looked_at

from algorithms.common.pose import Pose2
from app.drawing.sighting_picture import CHOSEN, REFUSED, sighting_picture

GREY = np.full((480, 640, 3), 90, np.uint8)
FACTOR = 1.5  # 640 pixels become 960


def of_colour(drawn, colour):
    """Rows and columns of the pixels of a colour."""
    return np.nonzero((drawn == np.array(colour, np.uint8)).all(axis=2))


@pytest.mark.parametrize("y", [0.6, -0.6])
def test_the_chosen_robot_is_framed_and_its_points_are_below_it(y):
    seen, view = looked_at(Pose2(2.5, y, 0.3))
    drawn = sighting_picture(GREY, seen, view)
    rows, columns = of_colour(drawn, CHOSEN)
    box = seen.sighted[0].detection
    assert columns.min() == pytest.approx(box.left * FACTOR, abs=4)
    framed = (rows < 480 * FACTOR) & (rows > (box.top + 5) * FACTOR)
    assert columns[framed].max() == pytest.approx(box.right * FACTOR, abs=4)
    below = columns[rows > 480 * FACTOR]
    assert len(below)
    assert below.min() >= box.left * FACTOR - 6
    assert below.max() <= box.right * FACTOR + 6
    # to the left in the world is to the left in the image
    assert (columns.mean() < 480) == (y > 0)


def test_a_refused_box_is_orange():
    seen, view = looked_at(Pose2(2.5, 0.0, 0.3), wall=2.4)
    drawn = sighting_picture(GREY, seen, view)
    assert len(of_colour(drawn, REFUSED)[0]) > 100
    assert len(of_colour(drawn, CHOSEN)[0]) == 0


def test_a_nearer_robot_is_drawn_lower_in_the_strip():
    heights = []
    for distance in (1.5, 4.0):
        seen, view = looked_at(Pose2(distance, 0.0, 0.0))
        rows, columns = of_colour(sighting_picture(GREY, seen, view), CHOSEN)
        inner = (rows > 480 * FACTOR) & (np.abs(columns - 480) < 10)
        heights.append(rows[inner].mean())
    assert heights[0] > heights[1]


def test_without_a_laser_there_is_no_strip():
    seen, _ = looked_at(Pose2(2.5, 0.0, 0.3))
    assert sighting_picture(GREY, seen, None).shape == (720, 960, 3)


def test_a_large_image_is_not_made_larger():
    seen, _ = looked_at(Pose2(2.5, 0.0, 0.3))
    assert sighting_picture(np.zeros((960, 1280, 3), np.uint8), seen, None).shape == (960, 1280, 3)
