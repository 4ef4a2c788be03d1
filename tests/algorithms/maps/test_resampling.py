"""Maps in other cells: no wall is lost, none is made up, and the counts of what changed are true."""

import cv2
import numpy as np
import pytest
from drawn import drawn_map
from hypothesis import assume, given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from algorithms.common.errors import SettingError, TooLargeError
from algorithms.common.pose import Pose2
from algorithms.maps.grid_map import FREE, FREE_UP_TO, OCCUPIED, OCCUPIED_FROM, UNKNOWN, GridMap
from algorithms.maps.resampling import resampled

values = st.sampled_from([UNKNOWN, FREE, 13, 40, 70, OCCUPIED])
shapes = st.tuples(st.integers(1, 14), st.integers(1, 14))
origins = st.builds(Pose2, st.floats(-9, 9), st.floats(-9, 9), st.floats(-np.pi, np.pi))
grids = st.builds(
    lambda cells, cell, origin: GridMap(cells, cell, origin),
    shapes.flatmap(lambda shape: arrays(np.int8, shape, elements=values)),
    st.sampled_from([0.05, 0.1]),
    origins,
)
sizes = st.one_of(st.none(), st.floats(0.02, 0.4))


def kinds(cells):
    """2 of a wall, 1 of free floor, else 0."""
    return np.where(cells >= OCCUPIED_FROM, 2, (cells >= FREE) & (cells <= FREE_UP_TO))


def centres(grid):
    rows, cols = np.indices(grid.cells.shape)
    return grid.centres(rows.ravel(), cols.ravel())


def distances(points, others):
    return np.hypot(*(points[:, None] - others[None]).transpose(2, 0, 1))


@given(grids, sizes, st.booleans())
def test_every_wall_has_a_wall_within_a_cells_diagonal_and_no_wall_is_made_up(grid, size, yaw):
    new = resampled(grid, size, yaw).grid
    reach = np.sqrt(0.5) * max(grid.resolution, new.resolution) + 1e-9
    if len(grid.points):
        apart = distances(grid.points, new.points)
        assert apart.min(axis=1).max() <= reach
        assert apart.min(axis=0).max() <= reach
    else:
        assert not new.occupied.any()


@given(grids, sizes, st.booleans())
def test_the_new_map_covers_the_old_one_in_the_cells_that_were_asked_for(grid, size, yaw):
    new = resampled(grid, size, yaw).grid
    assert new.resolution == (size or grid.resolution)
    assert new.origin.theta == (grid.origin.theta if yaw else 0.0)
    at = new.grid_coordinates(grid.corners())
    shape = np.array([new.width, new.height])
    assert (at > -1e-3).all()
    assert (at < shape + 1e-3).all()
    assert (at.min(axis=0) < 1e-3).all()
    assert (at.max(axis=0) > shape - 1 - 1e-3).all()


@given(grids, sizes, st.booleans())
def test_the_counts_that_are_told_are_those_of_the_cells_that_say_something_else_now(grid, size, yaw):
    told = resampled(grid, size, yaw)
    at = told.grid.grid_coordinates(centres(grid))
    assume((np.abs(at - np.round(at)) > 1e-6).all())  # not on an edge, where rounding decides
    cols, rows = np.floor(at).astype(int).T
    before, now = kinds(grid.cells).ravel(), kinds(told.grid.cells)[rows, cols]
    assert told.changed == np.count_nonzero(before != now)
    assert told.now_wall == np.count_nonzero((before != now) & (now == 2))
    assert told.now_free == np.count_nonzero((before != now) & (now == 1))
    assert told.of == grid.cells.size
    assert (now >= before).all()  # a wall wins over free floor, and that over what is neither


@given(grids)
def test_a_turn_by_nothing_at_the_same_resolution_is_the_map_itself(grid):
    upright = GridMap(grid.cells, grid.resolution, Pose2(grid.origin.x, grid.origin.y))
    for same in (resampled(grid), resampled(grid, grid.resolution), resampled(upright, yaw=False)):
        assert np.array_equal(same.grid.cells, grid.cells)
        assert same.changed == 0


@given(grids, st.sampled_from([-1, 1, 2]))
def test_a_quarter_turn_moves_the_cells_and_changes_none(grid, quarters):
    turned = GridMap(grid.cells, grid.resolution, Pose2(1.0, 2.0, quarters * np.pi / 2))
    told = resampled(turned, yaw=False)
    assert np.array_equal(told.grid.cells, np.rot90(grid.cells, -quarters))
    assert told.changed == 0
    assert np.allclose(np.sort(told.grid.points, axis=0), np.sort(turned.points, axis=0), atol=1e-9)


@given(grids, st.integers(2, 4))
def test_finer_cells_say_what_the_coarse_ones_said(grid, parts):
    told = resampled(grid, grid.resolution / parts)
    assert np.array_equal(told.grid.cells, grid.cells.repeat(parts, axis=0).repeat(parts, axis=1))
    assert told.changed == 0


def test_a_coarse_cell_is_a_wall_where_a_part_of_it_is_and_free_where_a_part_of_it_is_known():
    cells = np.full((4, 4), UNKNOWN, dtype=np.int8)
    cells[:2], cells[0, 0], cells[3, 3] = FREE, OCCUPIED, FREE
    told = resampled(GridMap(cells, 0.05), 0.1)
    assert told.grid.cells.tolist() == [[OCCUPIED, FREE], [UNKNOWN, FREE]]
    assert (told.now_wall, told.now_free, told.of) == (3, 3, 16)


@given(st.floats(-np.pi, np.pi), st.sampled_from([0.05, 0.08]))
def test_a_thin_wall_still_parts_two_rooms_whatever_it_is_turned_by(turn, size):
    cells = np.zeros((60, 60), dtype=np.int8)
    cells[30] = OCCUPIED
    new = resampled(GridMap(cells, 0.05, Pose2(theta=turn)), size, yaw=False).grid
    parts, _ = cv2.connectedComponents(new.free.astype(np.uint8), connectivity=4)
    assert parts == 1 + 2  # what is not free, and the rooms


def test_a_drawn_flat_keeps_its_walls_and_tells_how_few_cells_changed():
    flat = drawn_map(Pose2(1.0, -2.0, 0.3), origin_yaw=0.2)
    told = resampled(flat, yaw=False)
    assert told.grid.origin.theta == 0.0
    assert 0 < told.changed < 0.05 * flat.cells.size


@pytest.mark.parametrize(("size", "error"), [(0.0, SettingError), (1e4, SettingError), (1e-4, TooLargeError)])
def test_cells_that_no_map_can_have_are_refused(size, error):
    with pytest.raises(error):
        resampled(GridMap(np.zeros((2000, 2000), dtype=np.int8), 0.05), size)
