"""Corrections of a merged map: they change what they are about, and nothing else."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise
from math import hypot

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from algorithms.common.errors import SettingError
from algorithms.common.pose import Pose2
from algorithms.maps.grid_map import FREE, OCCUPIED, UNKNOWN, GridMap
from algorithms.maps.map_corrections import (
    MOST_EDITS,
    NO_CORRECTIONS,
    Corrections,
    Edit,
    corrected,
    cropped,
    ghosts,
)
from algorithms.maps.map_fusion import ConflictRule, fuse

SHAPE = (14, 17)
classes = st.sampled_from([UNKNOWN, FREE, OCCUPIED, 40])
origins = st.builds(Pose2, st.floats(-3, 3), st.floats(-3, 3), st.floats(-3, 3))
places = st.tuples(st.floats(-4, 4), st.floats(-4, 4))
cells = arrays(np.int8, SHAPE, elements=classes)


@st.composite
def fusions(draw):
    """Two maps on one grid."""
    origin = draw(origins)
    maps = [GridMap(draw(cells), 0.25, origin) for _ in range(2)]
    return fuse(maps, (Pose2(), Pose2()))


@st.composite
def edits(draw, does=("map1", "map2", "unknown", "erase", "keep-out")):
    box = draw(st.booleans())
    points = draw(st.lists(places, min_size=2 if box else 1, max_size=2 if box else 4))
    return Edit(draw(st.sampled_from(does)), tuple(points), draw(st.floats(0, 2)), box)


def off_line(point, points):
    """Metres from a line of points."""
    if len(points) == 1:
        return hypot(*(point - points[0]))
    best = np.inf
    for a, b in pairwise(points):
        along = float((b - a) @ (b - a))
        share = np.clip((point - a) @ (b - a) / along, 0, 1) if along > 0 else 0.0
        best = min(best, hypot(*(point - a - share * (b - a))))
    return best


def reached(edit, grid):
    """(H, W) which cells an edit reaches, a cell at a time; None where rounding may decide."""
    inside = np.zeros(grid.cells.shape, bool)
    for row, col in np.ndindex(grid.cells.shape):
        point = grid.centres(np.array([row]), np.array([col]))[0]
        if edit.box:
            low, high = np.min(edit.points, axis=0), np.max(edit.points, axis=0)
            off = max(*(low - point), *(point - high))
        else:
            off = off_line(point, np.array(edit.points)) - max(edit.radius, grid.resolution / 2**0.5)
        if abs(off) < 1e-6:
            return None
        inside[row, col] = off < 0
    return inside


@settings(deadline=None, max_examples=60)
@given(fusions(), edits())
def test_an_edit_changes_the_cells_that_it_reaches_as_it_says_and_no_others(fusion, edit):
    made, inside = corrected(fusion, Corrections(edits=(edit,))), reached(edit, fusion.merged)
    if inside is None:
        return
    before, after = fusion.merged.cells, made.grid.cells
    ref, mov = fusion.ref_cells, fusion.mov_cells
    denied = ((ref == OCCUPIED) & (mov == FREE)) | ((mov == OCCUPIED) & (ref == FREE))
    chosen = {"map1": ref, "map2": mov, "unknown": np.full_like(ref, UNKNOWN)}
    if edit.does in chosen:
        expected = np.where(inside & denied, chosen[edit.does], before)
    elif edit.does == "erase":
        expected = np.where(inside & (before > FREE), FREE, before)
    else:
        expected = np.where(inside, OCCUPIED, before)
    assert np.array_equal(after, expected)
    assert made.changed == np.count_nonzero(after != before)


@settings(deadline=None, max_examples=40)
@given(fusions(), st.lists(edits(), max_size=4), st.sampled_from([None, *ConflictRule]), st.booleans())
def test_what_was_merged_stays_as_it_is_and_the_same_corrections_give_the_same_map(fusion, made, rule, crop):
    before = [fusion.merged.cells.copy(), *(layer.copy() for layer in fusion.layers)]
    corrections = Corrections(rule, tuple(made), crop)
    first, second = corrected(fusion, corrections), corrected(fusion, corrections)
    assert np.array_equal(first.grid.cells, second.grid.cells)
    assert all(
        np.array_equal(a, b) for a, b in zip(before, (fusion.merged.cells, *fusion.layers), strict=True)
    )
    assert corrected(fusion, NO_CORRECTIONS).grid is fusion.merged


@settings(deadline=None)
@given(cells, origins)
def test_a_cropped_map_holds_all_that_is_known_where_it_was_and_ends_there(values, origin):
    grid = GridMap(values, 0.25, origin)
    small = cropped(grid)
    rows, cols = np.nonzero(values != UNKNOWN)
    if len(rows):
        assert np.array_equal(np.array(small.cells.shape), [np.ptp(rows) + 1, np.ptp(cols) + 1])
    for point, value in zip(grid.centres(rows, cols), values[rows, cols], strict=True):
        assert small.value_at(point) == value


def test_no_way_from_cell_to_cell_leads_through_a_keep_out_line():
    floor = GridMap(np.zeros((40, 40), np.int8), 0.1, Pose2(0.3, -0.2, 0.4))
    fusion = fuse((floor, floor), (Pose2(), Pose2()))
    ends = floor.origin.apply(np.array([[-1.0, 0.7], [5.0, 3.1]]))
    line = Edit("keep-out", tuple(map(tuple, ends.tolist())))
    after = corrected(fusion, Corrections(edits=(line,))).grid.cells
    reach = {(0, 0)}
    while True:  # all eight neighbours, as planners step
        more = {
            (r + i, c + j)
            for r, c in reach
            for i in (-1, 0, 1)
            for j in (-1, 0, 1)
            if 0 <= r + i < 40 and 0 <= c + j < 40 and after[r + i, c + j] == FREE
        }
        if more <= reach:
            break
        reach |= more
    assert (39, 0) not in reach


def test_a_choice_for_a_place_takes_the_place_of_the_one_before():
    once = NO_CORRECTIONS.choosing("map1", (1.0, 2.0), 0.5)
    brushed = replace(once, edits=(*once.edits, Edit("erase", ((1.0, 2.0),), 0.3)))
    again = brushed.choosing("unknown", (1.0, 2.0), 0.5)
    assert again.chosen_at((1.0, 2.0)) == "unknown"
    assert again.chosen_at((1.5, 2.0)) is None
    assert [edit.does for edit in again.edits] == ["erase", "unknown"]
    assert again.choosing(None, (1.0, 2.0), 0.5).chosen_at((1.0, 2.0)) is None


def test_walls_within_reach_of_a_robot_are_offered_and_each_is_counted_once():
    cells = np.zeros((30, 30), np.int8)
    cells[15, 12:18] = OCCUPIED
    grid = GridMap(cells, 0.1)
    edits, count = ghosts(grid, np.array([[1.5, 1.5], [1.5, 1.55]]))
    assert count == 6
    fusion = fuse((grid, grid), (Pose2(), Pose2()))
    assert corrected(fusion, Corrections(edits=edits)).changed == count
    assert ghosts(grid, np.zeros((0, 2))) == ((), 0)


@pytest.mark.parametrize(
    ("points", "more"),
    [
        ((), {}),
        (((0.0, float("nan")),), {}),
        (((0.0, 1e9),), {}),
        (((0.0, 0.0),), {"radius": -1.0}),
        (((0.0, 0.0),), {"box": True}),
        (((0.0, 0.0),) * 1000, {}),
    ],
)
def test_a_correction_that_cannot_be_is_refused(points, more):
    with pytest.raises(SettingError, match="correction"):
        Edit("erase", points, **more)


def test_there_is_an_end_of_corrections():
    edit = Edit("erase", ((0.0, 0.0),))
    with pytest.raises(SettingError, match="corrections"):
        Corrections(edits=(edit,) * (MOST_EDITS + 1))
