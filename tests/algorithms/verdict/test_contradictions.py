"""Contradictions gathered into places: each wall that the other map denies is in one of them, once."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from algorithms.common.pose import Pose2
from algorithms.files.case_folder import Case
from algorithms.maps.grid_map import FREE, OCCUPIED, UNKNOWN, GridMap
from algorithms.maps.map_fusion import fuse
from algorithms.maps.robots import NO_ROBOTS
from algorithms.verdict.contradictions import LEAST, find_conflicts
from algorithms.verdict.wall_evidence import evidence
from algorithms.verdict.wall_map import make_wall_map

CELL = 0.1


def hall(*walls: tuple[slice, slice]) -> GridMap:
    """A hall of 20 m x 10 m of free floor, with walls inside."""
    cells = np.full((100, 200), FREE, dtype=np.int8)
    cells[[0, -1], :], cells[:, [0, -1]] = OCCUPIED, OCCUPIED
    for wall in walls:
        cells[wall] = OCCUPIED
    return GridMap(cells, CELL)


def column(col: int, low: int, length: int) -> tuple[slice, slice]:
    """An upright wall, one cell thick."""
    return slice(low, low + length), slice(col, col + 1)


def found(ref: GridMap, mov: GridMap, T_ref_mov: Pose2 | None = None):
    return find_conflicts(fuse((ref, mov), (Pose2(), T_ref_mov or Pose2())))


def test_maps_that_say_the_same_have_no_place_of_contradiction():
    told = found(hall(column(50, 20, 30)), hall(column(50, 20, 30)))
    assert told.places == ()
    assert told.wall == 0


def test_a_wall_is_told_by_whose_it_is_where_it_stands_and_how_long_it_is():
    told = found(hall(column(50, 20, 30)), hall(column(150, 40, 20)))
    mine, other = told.places
    assert (mine.ref_wall, mine.mov_wall) == pytest.approx((3.0, 0.0))
    assert (other.ref_wall, other.mov_wall) == pytest.approx((0.0, 2.0))
    assert (mine.x, mine.y) == pytest.approx((5.05, 3.5))
    assert mine.radius == pytest.approx(1.5, abs=0.01)
    assert told.ref_only.sum() == 30
    assert told.mov_only.sum() == 20


@given(apart=st.integers(1, 12))
def test_two_walls_are_one_place_if_less_than_the_gap_lies_between_them(apart):
    told = found(hall(column(50, 20, 10), column(50, 30 + apart, 10)), hall())
    # from the middle of the last cell of one to the middle of the first of the other
    assert len(told.places) == (1 if (apart + 1) * CELL <= 0.4 + CELL else 2)
    assert told.wall == pytest.approx(2.0)


@given(
    lengths=st.lists(st.integers(1, 40), min_size=1, max_size=6),
    turn=st.floats(-3, 3),
    x=st.floats(-50, 50),
)
def test_most_wall_comes_first_and_no_wall_is_lost_whatever_the_frame(lengths, turn, x):
    plain = hall(*(column(20 + 25 * k, 10, length) for k, length in enumerate(lengths)))
    ref = GridMap(plain.cells.copy(), CELL, Pose2(x, -x, turn))
    mov = GridMap(hall().cells.copy(), CELL, Pose2(x, -x, turn))
    told = found(ref, mov)
    walls = [place.wall for place in told.places]
    assert walls == sorted(walls, reverse=True)
    assert told.wall == pytest.approx(sum(lengths) * CELL)
    assert told.small_parts == pytest.approx(sum(n for n in lengths if n * CELL < LEAST) * CELL)
    for place in told.places:  # each stands on a wall of map 1 that the other denies
        col = ref.grid_coordinates(np.array([place.x, place.y]))[0]
        assert (col - 20.5) % 25 == pytest.approx(0, abs=1e-6) or (col - 20.5) % 25 == pytest.approx(25)


def test_a_place_is_as_long_as_the_least_that_is_one_and_a_speck_is_shorter():
    """Five cells of 5 cm are a quarter of a metre to the bit."""
    places = []
    for length in (4, 5):
        ref, mov = (replace(grid, resolution=0.05) for grid in (hall(column(50, 20, length)), hall()))
        told = found(ref, mov)
        assert told.wall == pytest.approx(length * 0.05)
        places.append(len(told.places))
    assert LEAST == 0.25
    assert places == [0, 1]


def test_swapping_the_maps_swaps_whose_wall_it_is():
    one, two = hall(column(50, 20, 30)), hall(column(150, 40, 20))
    there, back = found(one, two), found(two, one)
    assert [(p.ref_wall, p.mov_wall) for p in there.places] == [(p.mov_wall, p.ref_wall) for p in back.places]


def test_what_the_other_map_does_not_know_is_no_contradiction():
    cells = hall().cells.copy()
    cells[:, 30:70] = UNKNOWN
    told = found(hall(column(50, 20, 30)), GridMap(cells, CELL))
    assert told.places == ()


def test_a_wall_drawn_one_cell_beside_itself_is_no_contradiction():
    assert found(hall(column(50, 20, 30)), hall(column(51, 20, 30))).wall == 0
    assert found(hall(column(50, 20, 30)), hall(column(53, 20, 30))).wall == pytest.approx(6.0)


def test_maps_that_do_not_touch_have_no_place_of_contradiction():
    told = found(hall(), hall(), Pose2(100.0, 0.0, 0.3))
    assert told.places == ()
    assert not told.ref_only.any()


def test_the_places_hold_the_wall_that_the_evidence_counts(small_case: Case):
    ref, mov, truth = small_case.ref, small_case.mov, small_case.truth.T_ref_mov
    wrong = Pose2(truth.x + 0.7, truth.y - 0.4, truth.theta + 0.1)
    told = find_conflicts(fuse((ref, mov), (Pose2(), wrong)))
    assert told.wall == pytest.approx(
        evidence(make_wall_map(ref), make_wall_map(mov), wrong, NO_ROBOTS).rigid_contradicting, rel=0.2
    )
    assert told.wall > 5
