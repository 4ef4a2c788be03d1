"""A map made ready to be held against others: which walls count, and what is near them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from drawn import drawn_map, small_maps
from hypothesis import given
from hypothesis import strategies as st

from algorithms.common.pose import Pose2
from algorithms.maps.grid_map import FREE, OCCUPIED, UNKNOWN, GridMap
from algorithms.maps.wall_distance import distance_to_walls, surface
from algorithms.verdict.wall_map import (
    ANOTHER_WALL,
    ANY_SIDE,
    LEVELS,
    NEAR,
    NEAR_WALL,
    NOTHING,
    SAME_WALL,
    SECTORS,
    make_wall_map,
    pooled,
    sectors,
)

usual_maps = small_maps(side=60).map(lambda grid: replace(grid, resolution=0.05))


def cells_of(wall_map) -> set[tuple[int, int]]:
    col, row = np.floor(wall_map.points / wall_map.grid.resolution).astype(int).T
    return set(zip(row.tolist(), col.tolist(), strict=True))


@given(usual_maps)
def test_the_walls_that_count_have_floor_beside_them_and_are_no_specks(grid):
    found = cells_of(make_wall_map(grid))
    seen = surface(grid.occupied, grid.free)
    assert found <= set(zip(*(axis.tolist() for axis in np.nonzero(seen)), strict=True))
    for row, col in zip(*np.nonzero(seen), strict=True):
        around = grid.occupied[max(0, row - 2) : row + 3, max(0, col - 2) : col + 3]
        assert ((row, col) in found) == (np.count_nonzero(around) > 1)


@given(usual_maps)
def test_levels_fall_with_the_distance_from_the_nearest_wall_that_counts(grid):
    ready = make_wall_map(grid)
    counted = np.zeros(grid.cells.shape, dtype=bool)
    for row, col in cells_of(ready):
        counted[row, col] = True
    metres = distance_to_walls(counted).astype(float) * grid.resolution
    top = LEVELS - 1
    assert (ready.level[metres <= SAME_WALL] == top).all()
    assert (ready.level[metres > max(NEAR_WALL, ANOTHER_WALL) + 1e-6] == NOTHING).all()
    step = (ANOTHER_WALL - SAME_WALL) / (top - NEAR)
    between = (metres > SAME_WALL + step) & (metres < ANOTHER_WALL - 1e-6)
    assert ((ready.level[between] > NEAR) & (ready.level[between] < top)).all()
    order = np.argsort(metres, axis=None)
    assert (np.diff(ready.level.ravel()[order].astype(int)) <= 0).all()


@given(st.floats(-np.pi, np.pi), st.floats(-np.pi, np.pi))
def test_a_direction_and_its_opposite_are_half_the_sectors_apart(facing, turn):
    there, back = sectors(np.array([facing, facing + np.pi]), turn).tolist()
    assert (back - there) % SECTORS == SECTORS // 2
    assert sectors(np.array([np.nan]), turn).tolist() == [ANY_SIDE]


def test_a_wall_is_seen_from_where_the_floor_is():
    cells = np.full((40, 40), UNKNOWN, dtype=np.int8)
    cells[20:], cells[20] = FREE, OCCUPIED
    above = make_wall_map(GridMap(cells, 0.05))
    assert np.allclose(above.facing[5:-5], np.pi / 2, atol=0.01)
    cells = cells.copy()
    cells[:20] = FREE
    assert np.isnan(make_wall_map(GridMap(cells, 0.05)).facing[5:-5]).all()


@given(small_maps(), st.integers(2, 5))
def test_a_coarser_map_loses_no_wall_and_invents_no_floor(grid, factor):
    coarse = pooled(grid, factor)
    for row, col in np.argwhere(grid.occupied).tolist():
        assert coarse.occupied[row // factor, col // factor]
    for row, col in np.argwhere(coarse.free).tolist():
        part = grid.cells[row * factor : (row + 1) * factor, col * factor : (col + 1) * factor]
        assert (part == FREE).any()
        assert not (part == OCCUPIED).any()
    assert coarse.origin == grid.origin
    assert coarse.resolution == pytest.approx(grid.resolution * factor)


def test_very_fine_cells_are_taken_together():
    fine = drawn_map(Pose2(), resolution=0.01)
    ready = make_wall_map(fine)
    assert ready.grid.resolution == pytest.approx(0.04)
    usual = make_wall_map(drawn_map(Pose2()))
    assert len(ready.points) * ready.metres == pytest.approx(len(usual.points) * usual.metres, rel=0.1)


def test_floor_is_sampled_where_there_is_much_of_it(monkeypatch):
    grid = drawn_map(Pose2())
    area = np.count_nonzero(grid.free) * grid.resolution**2
    all_of_it = make_wall_map(grid)
    assert len(all_of_it.floor) * all_of_it.floor_area == pytest.approx(area)
    monkeypatch.setattr("algorithms.verdict.wall_map.MOST_FLOOR", 2_000)
    part = make_wall_map(grid)
    assert len(part.floor) < 2_000
    assert len(part.floor) * part.floor_area == pytest.approx(area, rel=0.1)
