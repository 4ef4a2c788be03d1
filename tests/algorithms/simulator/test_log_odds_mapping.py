"""Scans become cells: what a beam crossed is free, where it ended is a wall, and the rest stays unknown."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from algorithms.maps.grid_map import FREE, OCCUPIED, UNKNOWN
from algorithms.simulator.lidar import Lidar
from algorithms.simulator.log_odds_mapping import USUAL, OddsModel, build_map
from algorithms.simulator.path_planning import Track
from algorithms.simulator.portable_random import TURN

CELL = 0.05
LIDAR = Lidar(beams=360, field=360.0, reach=3.0)
QUARTER = TURN // 4


def mapped(ranges, x=0.025, y=0.025, heading=0, scans=10, model=USUAL, cell=CELL, lidar=LIDAR):
    """The map of a robot that stands in one place and measures the same again and again.

    ranges : one for all beams, or (beams,)
    """
    track = Track(np.tile([x, y], (scans, 1)).astype(float), np.full(scans, heading, dtype=np.int64))
    found = np.broadcast_to(np.asarray(ranges, dtype=float), (scans, lidar.beams))
    return build_map(track, found.copy(), lidar, cell, "m", model)


def at(grid, x, y):
    """The cell at a place of the map's frame."""
    col, row = np.floor(grid.grid_coordinates(np.array([x, y]))).astype(int)
    return grid.cells[row, col]


def one_beam(metres, **named):
    """A robot that looks along x with a single beam."""
    return mapped(metres, lidar=Lidar(beams=1, field=0.0, reach=3.0), **named)


def test_a_round_wall_is_drawn_where_the_beams_ended_and_free_up_to_it():
    grid = mapped(2.0)
    rows, cols = np.indices(grid.cells.shape)
    away = np.hypot(*(grid.centres(rows.ravel(), cols.ravel()) - 0.025).T).reshape(grid.cells.shape)
    assert (grid.cells[away < 1.9] == FREE).all()
    assert np.abs(away[grid.cells == OCCUPIED] - 2.0).max() < CELL
    assert (grid.cells == OCCUPIED).sum() > 200
    assert (grid.cells[away > 2.1] == UNKNOWN).all()


@pytest.mark.parametrize(
    ("heading", "x", "y"),
    [(0, 1.0, 0.0), (QUARTER, 0.0, 1.0), (2 * QUARTER, -1.0, 0.0), (-QUARTER, 0.0, -1.0)],
)
def test_a_beam_goes_where_the_robot_looks_counter_clockwise(heading, x, y):
    grid = one_beam(1.0, heading=heading)
    assert at(grid, 0.025 + x, 0.025 + y) == OCCUPIED
    assert at(grid, 0.025 + x / 2, 0.025 + y / 2) == FREE
    assert at(grid, 0.025 - x / 5, 0.025 - y / 5) == UNKNOWN


@settings(max_examples=20)
@given(st.floats(-30, 30), st.floats(-30, 30), st.sampled_from([0.02, 0.05, 0.1]), st.integers(0, TURN - 1))
def test_a_wall_lies_where_it_was_measured_whatever_the_place_the_turn_and_the_cells(x, y, cell, heading):
    grid = one_beam(2.0, x=x, y=y, heading=heading, cell=cell)
    turn = heading * 2 * np.pi / TURN
    (wall,) = grid.centres(*np.nonzero(grid.cells == OCCUPIED))
    assert np.abs(wall - (x + 2 * np.cos(turn), y + 2 * np.sin(turn))).max() <= cell / 2 + 1e-6
    assert grid.resolution == cell


def test_a_beam_that_met_nothing_frees_its_reach_and_draws_no_wall():
    grid = one_beam(np.inf)
    assert at(grid, 2.9, 0.025) == FREE
    assert not (grid.cells == OCCUPIED).any()


def test_a_beam_that_came_back_with_nothing_useful_says_nothing():
    both = mapped([np.nan if k % 2 else 1.0 for k in range(4)], lidar=Lidar(beams=4, field=360.0, reach=3.0))
    assert (both.cells == OCCUPIED).sum() == 2


def test_one_look_is_not_enough_to_call_a_cell_free_but_several_are():
    """One miss takes 0.4 of a log-odds unit, and free begins at 1.41."""
    assert at(one_beam(1.0, scans=4), 0.5, 0.025) == FREE
    assert not (one_beam(1.0, scans=3).cells == FREE).any()


def test_a_scan_counts_once_for_a_cell_and_its_hit_silences_its_misses():
    """Many beams pass beside the end of another: a wall that is seen at a slant must not be rubbed out."""
    lidar = Lidar(beams=2000, field=20.0, reach=3.0)
    ranges = np.full(2000, 1.0)
    ranges[1::2] = 1.5  # every other beam passes through what the others hit
    grid = mapped(ranges, lidar=lidar)
    assert at(grid, 1.025, 0.025) == OCCUPIED
    few = mapped(2.0, scans=3, lidar=lidar)  # however many of its beams cross a cell
    assert not (few.cells == FREE).any()


def test_evidence_has_an_end_so_that_what_has_changed_is_learned_anew():
    """A door that was open for long is drawn shut after as many looks as evidence can be kept of."""
    lidar = Lidar(beams=1, field=0.0, reach=3.0)
    looks = np.concatenate([np.full(500, 2.0), np.full(5, 1.0)])[:, None]
    track = Track(np.tile([0.025, 0.025], (len(looks), 1)), np.zeros(len(looks), dtype=np.int64))
    assert at(build_map(track, looks, lidar, CELL, "m"), 1.025, 0.025) == OCCUPIED
    forgetful = OddsModel(least=-10_000)
    assert at(build_map(track, looks, lidar, CELL, "m", forgetful), 1.025, 0.025) == FREE


def test_the_map_is_cropped_to_what_was_seen_and_a_margin_and_stays_in_its_frame():
    grid = one_beam(1.0, x=5.025, y=-7.025)
    seen = np.argwhere(grid.cells != UNKNOWN)
    assert seen.min(axis=0).tolist() == [8, 8]
    assert (np.array(grid.cells.shape) - seen.max(axis=0)).tolist() == [9, 9]
    assert at(grid, 6.025, -7.025) == OCCUPIED
