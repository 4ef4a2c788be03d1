"""The robots over the map, as data."""

from __future__ import annotations

import numpy as np
import pytest
from drawn import OBSERVED, OBSERVER, T_MOV_WORLD, T_REF_MOV, T_REF_WORLD, flat_pair, sighting
from hypothesis import given
from hypothesis import strategies as st

from algorithms.common.pose import Pose2
from algorithms.observations.observation import encounter
from app.drawing.palette import LIGHT
from app.drawing.scene.robot_symbols import further
from app.drawing.scene_layout import lay_out

REF, MOV, SEEN, _ = flat_pair()
in_flat = st.builds(Pose2, st.floats(0, 9), st.floats(0, 7), st.floats(-np.pi, np.pi))
pairs = st.lists(st.tuples(in_flat, in_flat), max_size=4)


def drawn(seen, together=False, mov=True):
    """What is drawn of the sightings beyond the first, and where everything lies."""
    places = [encounter(o) for o in seen]
    layout = lay_out(REF, MOV, places[0])
    return further(seen, places, layout, LIGHT, mov, together), layout


@given(pairs)
def test_every_sighting_beyond_the_first_has_its_number_in_both_maps(stands):
    seen = [sighting(T_REF_WORLD, T_MOV_WORLD, *pair) for pair in [(OBSERVER, OBSERVED), *stands]]
    items, _ = drawn(seen)
    numbers = [str(number) for number in range(2, len(seen) + 1)]
    assert [item["t"] for item in items if "t" in item and item["f"] == "scene"] == numbers
    assert [item["t"] for item in items if "t" in item and item["f"] == "map2"] == numbers
    assert sum(item["k"] == "path" for item in items) == len(numbers)


@given(pairs)
def test_under_the_true_transform_robot_2_stands_where_each_line_of_sight_ends(stands):
    seen = [sighting(T_REF_WORLD, T_MOV_WORLD, *pair) for pair in [(OBSERVER, OBSERVED), *stands]]
    items, layout = drawn(seen, together=True)
    ends = [item["p"][1] for item in items if item["k"] == "path"]
    robots = [item["p"] for item in items if item["f"] == "map2"]
    placed = layout.placed(T_REF_MOV)
    assert [placed.apply(robot) for robot in robots] == [pytest.approx(end, abs=1e-6) for end in ends]


def test_one_sighting_is_drawn_as_ever():
    assert drawn([SEEN])[0] == []


def test_without_map_2_nothing_is_drawn_in_it():
    items, _ = drawn([SEEN, SEEN], mov=False)
    assert {item["f"] for item in items} == {"scene"}


def test_what_is_told_beside_the_first_sighting_is_faint_and_its_number_is_not():
    items, _ = drawn([SEEN, SEEN])
    assert all(item["c"].startswith("rgba(") for item in items)
    assert all(item["tc"].startswith("#") for item in items if "t" in item)
