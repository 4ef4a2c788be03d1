"""A trimmed map holds all that is known, where it was."""

from __future__ import annotations

import numpy as np

from algorithms.common.pose import Pose2
from algorithms.maps.coarse_grid import pooled, trimmed
from algorithms.maps.grid_map import GridMap


def test_a_trimmed_map_loses_unknown_ground_only_and_its_walls_stay_where_they_are():
    cells = np.full((30, 40), -1, dtype=np.int8)
    cells[5:11, 7:20], cells[8, 9:15] = 0, 100
    grid = GridMap(cells, 0.1, Pose2(2.0, -1.0, 0.6))
    small = trimmed(grid)
    assert small.cells.shape == (6, 13)
    assert np.allclose(small.points, grid.points)
    assert trimmed(small).cells.shape == small.cells.shape


def test_a_map_of_nothing_stays_as_it_is():
    empty = GridMap(np.full((3, 4), -1, dtype=np.int8), 0.1)
    assert trimmed(empty) is empty


def test_a_coarse_cell_is_a_wall_where_a_part_of_it_is():
    cells = np.zeros((4, 4), dtype=np.int8)
    cells[0, 0] = 100
    assert pooled(GridMap(cells, 0.05), 2).cells.tolist() == [[100, 0], [0, 0]]
