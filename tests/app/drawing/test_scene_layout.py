"""Where the two maps lie on the page."""

from __future__ import annotations

from math import pi

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from algorithms.common.pose import Pose2
from algorithms.maps.grid_map import FREE, UNKNOWN, GridMap
from algorithms.observations.observation import Observation, encounter
from app.drawing.scene_layout import SceneLayout, known_corners, lay_out, rect_of


def grid(rows: int, cols: int, origin: Pose2 = Pose2()) -> GridMap:  # noqa: B008 - frozen
    return GridMap(np.full((rows, cols), FREE, dtype=np.int8), 0.1, origin)


@pytest.mark.parametrize(
    ("first", "second"), [((50, 200), (60, 180)), ((200, 50), (180, 60)), ((9, 9), (90, 90))]
)
def test_maps_lie_apart_before_the_merge(first, second):
    layout = lay_out(grid(*first), grid(*second, Pose2(40, -70)), None)
    a, b = rect_of(layout.corners[0]), rect_of(layout.apart.apply(layout.corners[1]))
    gap = max(b[0] - a[2], a[0] - b[2], b[1] - a[3], a[1] - b[3])
    assert gap > 0


def test_the_meeting_place_is_the_middle_of_the_scene():
    seen = Observation(Pose2(1, 1, 0), 2.0, 3.0, 1.0, 0.0)
    layout = lay_out(grid(50, 50), grid(50, 50), encounter(seen))
    assert layout.anchor_ref.tolist() == [2.0, 1.0]
    assert layout.anchor_mov.tolist() == [2.0, 3.0]


def test_a_transform_places_map_2_so_that_its_points_land_where_the_transform_puts_them():
    seen = Observation(Pose2(1, 1, 0), 2.0, 3.0, 1.0, 0.0)
    layout = lay_out(grid(50, 50), grid(50, 50), encounter(seen))
    T, point = Pose2(7.0, -2.0, 2.0), np.array([4.0, 0.5])
    shown = layout.placed(T).apply(point - layout.anchor_mov)
    assert shown == pytest.approx(T.apply(point) - layout.anchor_ref)


def test_only_what_is_known_counts_for_the_size_of_a_map():
    cells = np.full((100, 100), UNKNOWN, dtype=np.int8)
    cells[20:30, 40:60] = FREE
    corners = known_corners(GridMap(cells, 0.1, Pose2(0, 0, pi / 2)))
    assert rect_of(corners) == pytest.approx((-3.0, 4.0, -2.0, 6.0))


@pytest.mark.parametrize(("ref", "mov"), [(None, None), (grid(10, 10), None), (None, grid(10, 10))])
def test_missing_maps_leave_a_view_all_the_same(ref, mov):
    x0, y0, x1, y1 = lay_out(ref, mov, None).view()
    assert x1 > x0
    assert y1 > y0


@given(st.floats(-30, 30), st.floats(-30, 30), st.floats(-3, 3))
def test_where_a_transform_puts_map_2_gives_the_transform_back(x, y, theta):
    at = SceneLayout((np.array([3.0, -2.0]), np.array([-7.0, 11.0])))
    T = at.transform(at.placed(Pose2(x, y, theta)))
    assert T.array() == pytest.approx([x, y, theta], abs=1e-9)


@given(st.floats(-9, 9), st.floats(-9, 9))
def test_the_frames_that_the_page_is_told_hold_what_is_known_of_each_map(x, y):
    second = grid(30, 60, Pose2(x, y, 0.4))
    layout = lay_out(grid(50, 50), second, None)
    ref, mov = layout.frames()
    assert ref[:2] == layout.anchor_ref.tolist()
    anchor, low, high = np.array(mov[:2]), np.array(mov[2:4]), np.array(mov[4:])
    assert (second.corners() - anchor >= low - 1e-9).all()
    assert (second.corners() - anchor <= high + 1e-9).all()
    assert lay_out(None, second, None).frames()[0] is None
