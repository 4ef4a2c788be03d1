import pickle

import numpy as np
import pytest
from drawn import poses
from hypothesis import given
from hypothesis import strategies as st

from algorithms.common.errors import SettingError, TooLargeError
from algorithms.common.pose import Pose2
from algorithms.maps.grid_map import FREE, UNKNOWN, GridMap, check_size


def grid(cells, **kw):
    return GridMap(np.array(cells, dtype=np.int8), kw.pop("resolution", 0.5), **kw)


@given(poses, st.integers(0, 3), st.integers(0, 4))
def test_the_centre_of_a_cell_lies_in_that_cell(origin, row, col):
    numbered = grid(np.arange(20).reshape(4, 5), origin=origin)
    centre = numbered.centres(np.array([row]), np.array([col]))[0]
    assert numbered.value_at(centre) == row * 5 + col
    assert np.allclose(numbered.grid_coordinates(centre), (col + 0.5, row + 0.5), atol=1e-9)


def test_row_zero_is_the_bottom_and_the_origin_its_lower_left_corner():
    lower_left = grid([[100, 0], [0, 0]], origin=Pose2(10.0, 20.0))
    assert np.allclose(lower_left.points, [[10.25, 20.25]])


def test_a_yawed_origin_turns_the_cells_about_the_lower_left_corner():
    turned = grid([[0, 100]], origin=Pose2(10.0, 20.0, np.pi / 2))
    assert np.allclose(turned.points, [[9.75, 20.75]])


def test_what_lies_between_the_thresholds_is_neither_wall_nor_free():
    values = grid([[-1, 0, 25, 26, 64, 65, 100]])
    assert values.free.tolist() == [[False, True, True, False, False, False, False]]
    assert values.occupied.tolist() == [[False, False, False, False, False, True, True]]


def test_outside_the_grid_nothing_is_known():
    assert grid([[100]]).value_at(np.array([0.6, 0.1])) == UNKNOWN
    assert not grid([[100]]).contains(np.array([-0.1, 0.1]))


def test_a_map_cannot_be_changed_behind_ones_back():
    with pytest.raises(ValueError, match="read-only"):
        grid([[0]]).cells[0, 0] = 100


@pytest.mark.parametrize("resolution", [0.0, -1.0, float("nan"), float("inf"), 1e308, 1e-320])
def test_a_resolution_must_be_a_positive_number(resolution):
    with pytest.raises(SettingError, match="resolution"):
        grid([[0]], resolution=resolution)


def test_too_many_cells_are_refused_before_they_are_made():
    with pytest.raises(TooLargeError, match="coarser resolution"):
        check_size(100_000, 100_000, "the merged map")


def test_a_map_travels_to_another_process_as_it_was_made_and_cannot_be_written_there():
    made = GridMap(np.full((40, 30), FREE, dtype=np.int8), 0.05, Pose2(1.0, 2.0, 0.3), "mine")
    plain = pickle.dumps(made)
    assert not made.occupied.any()  # it keeps what it has worked out; that stays at home
    assert pickle.dumps(made) == plain
    copy = pickle.loads(plain)
    assert (copy.cells == made.cells).all()
    assert not copy.cells.flags.writeable
    assert (copy.resolution, copy.origin, copy.name) == (made.resolution, made.origin, made.name)
