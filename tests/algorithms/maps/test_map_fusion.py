from dataclasses import replace

import numpy as np
import pytest
from drawn import T_REF_MOV, drawn_map, flat_pair, poses
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from algorithms.common.errors import TooLargeError
from algorithms.common.pose import Pose2
from algorithms.maps.grid_map import FREE, OCCUPIED, UNKNOWN, GridMap
from algorithms.maps.map_fusion import ConflictRule, fuse
from algorithms.maps.robots import Robots

classes = st.sampled_from([UNKNOWN, FREE, OCCUPIED])
near = st.builds(Pose2, st.floats(-2, 2), st.floats(-2, 2), st.floats(-np.pi, np.pi))


def grids(resolution=0.1):
    shape = st.tuples(st.integers(1, 12), st.integers(1, 12))
    return st.builds(
        lambda cells, origin: GridMap(cells, resolution, origin),
        shape.flatmap(lambda s: arrays(np.int8, s, elements=classes)),
        near,
    )


@settings(deadline=None)
@given(grids(), grids(), near)
def test_the_cells_of_the_first_map_are_not_resampled(ref, mov, T):
    fusion = fuse((ref, mov), (Pose2(), T))
    rows, cols = np.indices(ref.cells.shape)
    centres = ref.centres(rows.ravel(), cols.ravel())
    at = np.floor(fusion.merged.grid_coordinates(centres)).astype(int)
    assert np.array_equal(fusion.ref_cells[at[:, 1], at[:, 0]], ref.cells.ravel())
    assert np.count_nonzero(fusion.ref_cells != UNKNOWN) == np.count_nonzero(ref.cells != UNKNOWN)


@settings(deadline=None)
@given(grids(), grids(0.07), near)
def test_no_wall_of_either_map_is_lost(ref, mov, T):
    merged = fuse((ref, mov), (Pose2(), T)).merged
    for points in (ref.points, T.apply(mov.points)):
        for point in points:
            assert merged.value_at(point) == OCCUPIED


@settings(deadline=None)
@given(grids(), grids(), near, st.sampled_from(list(ConflictRule)))
def test_a_cell_is_free_only_where_a_map_knows_it_to_be_free(ref, mov, T, rule):
    fusion = fuse((ref, mov), (Pose2(), T), rule)
    free = fusion.merged.cells == FREE
    assert np.all((fusion.ref_cells[free] == FREE) | (fusion.mov_cells[free] == FREE))
    known = fusion.merged.cells != UNKNOWN
    assert np.array_equal(known, (fusion.ref_cells != UNKNOWN) | (fusion.mov_cells != UNKNOWN))
    rows, cols = np.nonzero(fusion.mov_cells == FREE)
    around = np.array([(x, y) for x in (0, -1, 1) for y in (0, -1, 1)]) * 1e-9  # it may lie on an edge
    for centre in T.inverse().apply(fusion.merged.centres(rows, cols)):
        assert any(mov.value_at(centre + nudge) == FREE for nudge in around)


@settings(deadline=None)
@given(grids(), grids(), near)
def test_the_merged_grid_is_the_bounding_box_of_both_and_no_more(ref, mov, T):
    merged = fuse((ref, mov), (Pose2(), T)).merged
    corners = np.concatenate([ref.corners(), T.apply(mov.corners())])
    at = merged.grid_coordinates(corners)
    size = np.array([merged.width, merged.height])
    assert np.all(at > -1e-3)
    assert np.all(at < size + 1e-3)
    assert np.all(at.min(axis=0) < 1)
    assert np.all(at.max(axis=0) > size - 1)


@settings(deadline=None)
@given(grids())
def test_a_map_merged_with_itself_is_itself(ref):
    fusion = fuse((ref, ref), (Pose2(), Pose2()))
    assert np.array_equal(fusion.merged.cells, ref.cells)
    assert fusion.conflicting == 0
    assert fusion.agreed == np.count_nonzero(ref.cells != UNKNOWN)
    assert fusion.acceptance_index == (1.0 if fusion.agreed else 0.0)


def row(*cells):
    return GridMap(np.array([cells], dtype=np.int8), 1.0)


def test_every_pair_of_answers_is_counted_once():
    ref = row(0, 0, 0, 100, 100, 100, -1, -1, -1)
    mov = row(0, 100, -1, 0, 100, -1, 0, 100, -1)
    fusion = fuse((ref, mov), (Pose2(), Pose2()))
    assert (fusion.agreed, fusion.agreed_walls, fusion.conflicting, fusion.overlap) == (2, 1, 2, 4)
    assert fusion.acceptance_index == 0.5


@pytest.mark.parametrize(
    ("rule", "expected"),
    [
        (ConflictRule.OCCUPIED_WINS, [100, 100]),
        (ConflictRule.REF_WINS, [0, 100]),
        (ConflictRule.MOV_WINS, [100, 0]),
    ],
)
def test_a_conflict_is_settled_by_the_rule(rule, expected):
    assert fuse((row(0, 100), row(100, 0)), (Pose2(), Pose2()), rule).merged.cells.tolist() == [expected]


def test_the_newer_map_counts_by_the_dates_of_the_files_and_a_wall_where_they_do_not_tell():
    ref, mov = row(0, 100), row(100, 0)

    def merged(first, second):
        dated = replace(ref, made=first), replace(mov, made=second)
        return fuse(dated, (Pose2(), Pose2()), ConflictRule.NEWER_WINS).merged.cells.tolist()

    assert merged(1000.0, 9000.0) == [[100, 0]]  # map 2's
    assert merged(9000.0, 1000.0) == [[0, 100]]  # map 1's
    assert merged(1000.0, 1020.0) == merged(None, 9000.0) == [[100, 100]]  # copied together; not known


def test_the_map_that_saw_a_cell_more_often_counts_and_of_two_alike_the_wall():
    ref, mov = row(2, 70, 0, 25), row(80, 3, 100, 75)
    merged = fuse((ref, mov), (Pose2(), Pose2()), ConflictRule.SURER_WINS).merged
    assert merged.cells.tolist() == [[2, 3, 100, 75]]


@settings(deadline=None)
@given(grids(), grids(), near, st.sampled_from(list(ConflictRule)), st.sampled_from(list(ConflictRule)))
def test_a_merged_map_by_another_rule_is_that_of_a_merge_by_that_rule(ref, mov, T, rule, other):
    fusion, again = (fuse((ref, mov), (Pose2(), T), each) for each in (rule, other))
    assert np.array_equal(fusion.merged_by(other), again.merged.cells)


def test_a_decided_cell_beats_an_undecided_one():
    assert fuse((row(50, 0, 40), row(0, 50, -1)), (Pose2(), Pose2())).merged.cells.tolist() == [[0, 0, 40]]


def test_the_finer_resolution_is_kept():
    coarse, fine = drawn_map(Pose2(), 0.1), drawn_map(Pose2(), 0.05)
    assert fuse((coarse, fine), (Pose2(), Pose2())).merged.resolution == 0.05
    assert fuse((fine, coarse), (Pose2(), Pose2())).merged.resolution == 0.05


def test_which_map_was_resampled_is_told():
    coarse, fine = GridMap(np.zeros((2, 2), np.int8), 0.2), GridMap(np.zeros((8, 8), np.int8), 0.05)
    same = (Pose2(), Pose2())
    assert fuse((coarse, fine), same).resampled == {1: 0.2}
    assert fuse((fine, coarse), same).resampled == {2: 0.2}
    assert fuse((fine, fine), same).resampled == {}


def test_a_yawed_origin_stays_the_origin_of_the_merged_map():
    ref = drawn_map(Pose2(), origin_yaw=0.6)
    assert fuse((ref, drawn_map(Pose2())), (Pose2(), Pose2())).merged.origin.theta == pytest.approx(0.6)


def test_two_maps_of_one_flat_agree_at_the_known_pose_and_not_beside_it():
    ref, mov, _, T = flat_pair()
    right, wrong = fuse((ref, mov), (Pose2(), T)), fuse((ref, mov), (Pose2(), T @ Pose2(0.4, 0.3, 0.3)))
    assert right.acceptance_index > 0.98 > wrong.acceptance_index


def test_maps_too_far_apart_are_refused_not_allocated():
    with pytest.raises(TooLargeError, match="merged map"):
        fuse((row(0), row(0)), (Pose2(), Pose2(30_000.0, 30_000.0)))


@given(poses)
@settings(deadline=None, max_examples=20)
def test_where_the_frames_lie_changes_nothing_in_the_counts(T_new_ref):
    ref, mov, _, _ = flat_pair()
    moved = GridMap(ref.cells, ref.resolution, T_new_ref @ ref.origin)
    here, there = fuse((ref, mov), (Pose2(), T_REF_MOV)), fuse((moved, mov), (Pose2(), T_new_ref @ T_REF_MOV))
    assert there.overlap == pytest.approx(here.overlap, rel=2e-3)
    assert there.conflicting == pytest.approx(here.conflicting, abs=0.002 * here.overlap)


# ---- the robots themselves


def room(*walls):
    """10 m by 10 m of floor in cells of 0.1 m; each wall is a row and a column."""
    cells = np.full((100, 100), FREE, dtype=np.int8)
    for row, col in walls:
        cells[row, col] = OCCUPIED
    return GridMap(cells, 0.1)


RING = [
    (row, col) for row in range(48, 53) for col in range(48, 53) if max(abs(row - 50), abs(col - 50)) == 2
]
AT = np.array([[5.05, 5.05]])  # the middle of the ring
NO_ONE = np.zeros((0, 2))


@pytest.mark.parametrize(("in_ref", "in_mov", "cleared"), [(NO_ONE, AT, 16), (AT, NO_ONE, 0)])
def test_the_ring_that_one_map_shows_around_the_maker_of_the_other_is_floor(in_ref, in_mov, cleared):
    fusion = fuse((room(*RING), room()), (Pose2(), Pose2()), robots=Robots(in_ref, in_mov, 0.4))
    assert fusion.cleared == cleared
    assert np.count_nonzero(fusion.merged.cells == OCCUPIED) == 16 - cleared


def test_a_wall_beside_a_robot_that_its_own_map_shows_too_stays():
    wall = [(50 + k, 53) for k in range(-2, 3)]
    fusion = fuse(
        (room(*wall), room(*[(row, col + 1) for row, col in wall])),
        (Pose2(), Pose2()),
        robots=Robots(NO_ONE, AT, 0.4),
    )
    assert fusion.cleared == 0
    assert (fusion.merged.cells[48:53, 53] == OCCUPIED).all()


def test_what_is_farther_from_a_robot_than_its_size_stays():
    fusion = fuse((room((50, 56), *RING), room()), (Pose2(), Pose2()), robots=Robots(NO_ONE, AT, 0.4))
    assert fusion.merged.cells[50, 56] == OCCUPIED
    assert fuse((room(*RING), room()), (Pose2(), Pose2()), robots=Robots(NO_ONE, AT, 0.0)).cleared == 0


@settings(deadline=None)
@given(grids(), grids(), near, st.floats(-1, 1), st.floats(-1, 1))
def test_clearing_robots_changes_no_cell_but_walls_near_them_into_floor(ref, mov, T, x, y):
    robots = Robots(np.array([[x, y]]), np.array([[y, x]]), 0.3)
    plain, cleared = fuse((ref, mov), (Pose2(), T)), fuse((ref, mov), (Pose2(), T), robots=robots)
    changed = plain.merged.cells != cleared.merged.cells
    assert np.count_nonzero(changed) <= cleared.cleared
    assert (plain.merged.cells[changed] == OCCUPIED).all()
    assert (cleared.merged.cells[changed] == FREE).all()
    rows, cols = np.nonzero(changed)
    centres = plain.merged.centres(rows, cols)
    for centre in centres:
        assert np.hypot(*(robots.places(T) - centre).T).min() <= 0.3 + 0.1


@settings(deadline=None)
@given(grids(), grids(), near)
def test_a_map_given_twice_changes_nothing_of_the_merged_map(ref, mov, T):
    two, three = fuse((ref, mov), (Pose2(), T)), fuse((ref, mov, mov), (Pose2(), T, T))
    assert np.array_equal(two.merged.cells, three.merged.cells)
    assert len(three.layers) == 3
    assert np.array_equal(three.layers[1], three.layers[2])
