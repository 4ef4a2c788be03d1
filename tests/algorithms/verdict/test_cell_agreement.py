"""Walls that coincide are told as such, walls in the other map's free floor too, and nothing is made up."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from algorithms.common.pose import Pose2
from algorithms.maps.grid_map import FREE, OCCUPIED, UNKNOWN, GridMap
from algorithms.verdict.cell_agreement import AGREES, CONTRADICTS, SILENT, WallLookup
from algorithms.verdict.wall_map import SAME_WALL


def room(origin: Pose2 = Pose2()) -> GridMap:  # noqa: B008 - it is frozen
    cells = np.full((40, 60), UNKNOWN, dtype=np.int8)
    cells[5:35, 5:55] = FREE
    cells[5, 5:55] = cells[34, 5:55] = OCCUPIED
    cells[5:35, 5] = cells[5:35, 54] = OCCUPIED
    return GridMap(cells, 0.1, origin)


def test_a_map_agrees_with_itself_everywhere():
    walls = WallLookup(room())
    assert (walls.agreement_with(walls, Pose2()) == AGREES).all()


def test_a_wall_in_free_floor_is_contradicted_and_one_in_the_unknown_is_not():
    walls = WallLookup(room())
    told = walls.agreement_with(walls, Pose2(1.0, 0.0))
    rows, cols = walls.cells
    inside = (cols == 5) & (rows > 8) & (rows < 31)
    assert (told[inside] == CONTRADICTS).all()
    assert (told[cols == 54] == SILENT).all()


@given(st.floats(-20, 20), st.floats(-20, 20), st.floats(-3, 3))
def test_nothing_is_told_where_the_maps_do_not_meet_and_frames_do_not_matter(x, y, theta):
    far = WallLookup(room())
    assert (far.agreement_with(far, Pose2(x + 100, y, theta)) == SILENT).all()
    origin = Pose2(x, y, theta)
    moved = WallLookup(room(origin))
    assert (far.agreement_with(moved, origin) == AGREES).all()
    assert (moved.agreement_with(far, origin.inverse()) == AGREES).all()


@pytest.mark.parametrize("cell", [0.02, 0.05, 0.1])
def test_how_far_beside_another_a_wall_is_still_the_same_is_counted_in_metres(cell):
    cells = np.full((20, round(3.0 / cell)), FREE, dtype=np.int8)
    cells[:, round(1.5 / cell)] = OCCUPIED
    walls = WallLookup(GridMap(cells, cell))
    same, other = (np.floor(SAME_WALL / cell) + beside for beside in (0, 1))
    assert (walls.agreement_with(walls, Pose2(float(same) * cell, 0.0)) == AGREES).all()
    assert (walls.agreement_with(walls, Pose2(float(other) * cell, 0.0)) == CONTRADICTS).all()
