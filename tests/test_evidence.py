import numpy as np
import pytest
from drawn import T_MOV_WORLD, WALLS, drawn_map, flat_pair, poses, small_maps
from hypothesis import given, settings
from hypothesis import strategies as st

from algorithms import kernels
from algorithms.agreement import distance_to_walls, surface
from algorithms.evidence import (
    FLOOR,
    NEAR,
    NEAR_WALL,
    SAME,
    SAME_WALL,
    SLIP,
    _ground,
    _surface_cells,
    evidence,
)
from algorithms.gridmap import FREE, OCCUPIED, UNKNOWN, GridMap
from algorithms.pose import Pose2, rotation

REF, MOV, SEEN, T = flat_pair()


def hall(walls, side=16.0, cell=0.05):
    """Free floor with walls on it: (x0, y0, x1, y1) boxes in metres."""
    cells = np.full((round(side / cell),) * 2, FREE, dtype=np.int8)
    for x0, y0, x1, y1 in walls:
        cells[round(y0 / cell) : round(y1 / cell), round(x0 / cell) : round(x1 / cell)] = OCCUPIED
    return GridMap(cells, cell)


def test_at_the_known_pose_nothing_contradicts_and_beside_it_much_does():
    right, wrong = evidence(REF, MOV, T), evidence(REF, MOV, Pose2(1.5, 1.0, 0.0) @ T)
    assert right.contradiction < 0.02
    assert wrong.contradiction > 0.3
    assert right.agreeing > 3 * wrong.agreeing


@settings(max_examples=15)
@given(poses, poses)
def test_what_the_walls_say_does_not_depend_on_the_frames(frame_1, frame_2):
    ref, mov, _, T_ref_mov = flat_pair(frame_1, frame_2)
    found = evidence(ref, mov, T_ref_mov)
    assert found.contradiction < 0.06
    assert found.agreeing == pytest.approx(evidence(REF, MOV, T).agreeing, rel=0.15)


@given(st.floats(-1, 1), st.floats(-1, 1), st.floats(-0.5, 0.5))
def test_swapping_the_maps_changes_nothing(x, y, turn):
    beside = T @ Pose2(x, y, turn)
    there, back = evidence(REF, MOV, beside), evidence(MOV, REF, beside.inverse())
    assert (there.rigid_agreeing, there.rigid_contradicting) == pytest.approx(
        (back.rigid_agreeing, back.rigid_contradicting)
    )
    # patches lie on the raster of the map that is looked at
    assert there.contradiction == pytest.approx(back.contradiction, abs=0.12)


@given(st.floats(-2, 2), st.floats(-2, 2), st.floats(-1, 1))
def test_letting_patches_slip_never_speaks_against_a_transform(x, y, turn):
    found = evidence(REF, MOV, T @ Pose2(x, y, turn))
    slipped = found.agreeing - found.contradicting
    assert slipped >= found.rigid_agreeing - found.rigid_contradicting - 1e-9
    assert 0 <= found.bent <= 1


def test_agreeing_wall_is_counted_in_metres_from_both_maps():
    wall = [(2.0, 8.0, 12.0, 8.1)]  # 10 m, two sides and two ends, in both maps
    found = evidence(hall(wall), hall(wall), Pose2())
    assert found.agreeing == pytest.approx(2 * (2 * 10.0), rel=0.02)
    assert found.contradicting == 0


def test_the_resolution_does_not_change_the_metres():
    walls = [(2.0, 8.0, 12.0, 8.2), (4.0, 2.0, 4.2, 6.0)]
    fine = evidence(hall(walls), hall(walls), Pose2())
    coarse = evidence(hall(walls, cell=0.1), hall(walls, cell=0.1), Pose2())
    assert coarse.agreeing == pytest.approx(fine.agreeing, rel=0.05)


def test_a_box_in_the_others_free_floor_contradicts_however_patches_slip():
    found = evidence(hall([(7, 7, 8, 8), (1, 1, 15, 1.1)]), hall([(1, 1, 15, 1.1)]), Pose2())
    assert found.contradicting == pytest.approx(3.9, abs=0.2)  # its 4 m of edge, a corner counted once
    assert found.bent == 0


def test_what_the_other_map_does_not_know_says_nothing():
    ref = hall([(7, 7, 8, 8), (1, 1, 15, 1.1)])
    blind = GridMap(np.full(ref.cells.shape, UNKNOWN, dtype=np.int8), 0.05)
    found = evidence(ref, blind, Pose2())
    assert (found.agreeing, found.contradicting, found.contradiction) == (0, 0, 1)


def test_a_wall_that_is_a_little_off_is_bent_and_one_far_off_is_wrong():
    straight = hall([(1, 8, 15, 8.1)])
    little = evidence(straight, hall([(1, 8 + 0.75 * SLIP, 15, 8.1 + 0.75 * SLIP)]), Pose2())
    far = evidence(straight, hall([(1, 8 + 3 * SLIP, 15, 8.1 + 3 * SLIP)]), Pose2())
    assert little.rigid_contradiction > 0.9
    assert little.contradiction < 0.02
    assert little.bent > 0.95
    assert far.contradiction > 0.9
    assert far.bent < 0.05


def test_a_bent_map_of_the_same_flat_is_told_from_another_building():
    def bent(grid, curvature=0.025):
        """The map of a robot whose heading has drifted: the farther right, the more turned."""
        rows, cols = np.indices(grid.cells.shape)
        at = grid.origin.inverse().apply(grid.centres(rows.ravel(), cols.ravel()))
        swung = at.copy()
        swung[:, 1] += curvature * (at[:, 0] - at[:, 0].mean()) ** 2
        col, row = np.floor(swung / grid.resolution).astype(int).T
        inside = (row >= 0) & (row < grid.height) & (col >= 0) & (col < grid.width)
        cells = np.full(grid.cells.size, UNKNOWN, dtype=np.int8)
        cells[inside] = grid.cells[row[inside], col[inside]]
        return GridMap(cells.reshape(grid.cells.shape), grid.resolution, grid.origin)

    whole = drawn_map(Pose2())
    same = evidence(whole, bent(whole), Pose2())
    mirrored = GridMap(np.ascontiguousarray(whole.cells[:, ::-1]), whole.resolution, whole.origin)
    other = evidence(whole, mirrored, Pose2())
    assert same.rigid_contradiction > 0.15
    assert same.bent > 0.6
    assert same.contradiction < 0.5 * other.contradiction


def test_the_answer_does_not_depend_on_the_number_of_threads(monkeypatch):
    beside = T @ Pose2(0.2, 0.1, 0.05)
    found = evidence(REF, MOV, beside)
    monkeypatch.setattr(kernels, "cores", lambda: 1)
    assert evidence(REF, MOV, beside) == found


def test_maps_that_do_not_touch_say_nothing():
    found = evidence(REF, MOV, Pose2(500.0, 0.0, 0.0) @ T)
    assert found.agreeing + found.contradicting == 0


def test_every_wall_of_the_flat_is_there_to_be_counted():
    whole = drawn_map(T_MOV_WORLD)
    length = sum(np.hypot(x1 - x0, y1 - y0) for x0, y0, x1, y1 in WALLS)
    found = evidence(whole, whole, Pose2())
    assert length < found.agreeing / 2 < 2.2 * length  # the outer walls show one side, inner ones two


def test_a_turn_of_the_whole_by_a_patch_turn_is_bent_not_wrong():
    walls = [(3, 8, 13, 8.1), (8, 3, 8.1, 13)]
    turned = hall(walls)
    centre = np.array([8.0, 8.0])
    angle = 0.05
    shift = centre - rotation(angle) @ centre
    found = evidence(turned, turned, Pose2(*shift.tolist(), angle))
    assert found.contradiction < found.rigid_contradiction
    assert found.contradiction < 0.1


@given(small_maps(side=60))
def test_the_ground_around_walls_is_what_their_distances_say(grid):
    ground = _ground(grid.occupied, grid.free, grid.resolution)
    metres = distance_to_walls(grid.occupied) * np.float32(grid.resolution)
    assert np.array_equal(ground & FLOOR > 0, grid.free)
    assert np.array_equal(ground & NEAR > 0, metres <= np.float32(NEAR_WALL))
    assert np.array_equal(ground & SAME > 0, metres.astype(float) <= SAME_WALL)


@given(small_maps())
def test_the_walls_that_count_are_those_with_free_floor_beside_them(grid):
    assert np.array_equal(_surface_cells(grid), np.nonzero(surface(grid.occupied, grid.free)))
