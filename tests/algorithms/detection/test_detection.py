"""Boxes that show one thing become one box."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from algorithms.detection.detection import Detection, overlaps, strongest

boxes = st.builds(
    lambda x, y, w, h, p: Detection(x, y, x + w, y + h, p, "robot"),
    st.floats(0, 300),
    st.floats(0, 300),
    st.floats(5, 80),
    st.floats(5, 80),
    st.floats(0.05, 1),
)


@given(st.lists(boxes, max_size=12))
def test_what_stays_is_the_likeliest_first_and_shares_little(found):
    kept = strongest(found)
    assert [one.probability for one in kept] == sorted((one.probability for one in kept), reverse=True)
    if found:
        assert kept[0].probability == max(one.probability for one in found)


@given(st.lists(boxes, max_size=12), st.randoms())
def test_the_order_of_the_boxes_does_not_matter(found, random):
    shuffled = list(found)
    random.shuffle(shuffled)
    assert strongest(shuffled) == strongest(found)


@given(boxes)
def test_a_box_shares_all_with_itself_and_nothing_with_one_far_away(one):
    box = np.array(one.box())
    joint, inner = overlaps(np.stack([box, box + 1000]), box)
    assert joint == pytest.approx([1, 0])
    assert inner == pytest.approx([1, 0])


def test_two_boxes_on_one_robot_are_one_in_the_middle_of_both():
    left, right = (Detection(x, 0, x + 40, 40, 0.8, "robot") for x in (100, 110))
    (kept,) = strongest([left, right])
    assert kept.left == pytest.approx(105)


def test_two_robots_side_by_side_stay_two():
    assert len(strongest([Detection(x, 0, x + 40, 40, 0.8, "robot") for x in (100, 145)])) == 2
