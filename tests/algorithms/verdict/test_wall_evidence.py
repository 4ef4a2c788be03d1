"""What the walls of two maps say for a transform: laws of counting, of slipping, and of sides."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from drawn import T_MOV_WORLD, WALLS, bent, drawn_map, flat_pair, poses
from hypothesis import given, settings
from hypothesis import strategies as st

from algorithms.common import parallel_kernels as kernels
from algorithms.common.pose import Pose2, rotation
from algorithms.maps.grid_map import FREE, OCCUPIED, UNKNOWN, GridMap
from algorithms.maps.robots import NO_ROBOTS, Robots
from algorithms.verdict.slipping_patches import PATCH, SLIP
from algorithms.verdict.wall_evidence import Evidence, evidence
from algorithms.verdict.wall_map import make_wall_map

REF, MOV, SEEN, T = flat_pair()


def hall(walls, side=16.0, cell=0.05):
    """Free floor with walls on it: (x0, y0, x1, y1) boxes in metres."""
    cells = np.full((round(side / cell),) * 2, FREE, dtype=np.int8)
    for x0, y0, x1, y1 in walls:
        cells[round(y0 / cell) : round(y1 / cell), round(x0 / cell) : round(x1 / cell)] = OCCUPIED
    return GridMap(cells, cell)


def weighed(ref, mov, T_ref_mov, robots=NO_ROBOTS) -> Evidence:
    return evidence(make_wall_map(ref), make_wall_map(mov), T_ref_mov, robots)


def mended(found: Evidence) -> float:
    """Share of the walls whose contradiction goes away when patches slip."""
    return found.rigid_contradiction - found.contradiction


def test_at_the_known_pose_nothing_contradicts_and_beside_it_much_does():
    right, wrong = weighed(REF, MOV, T), weighed(REF, MOV, Pose2(1.5, 1.0, 0.0) @ T)
    assert right.contradiction < 0.02
    assert wrong.contradiction > 0.3
    assert right.agreeing > 3 * wrong.agreeing


@settings(max_examples=15)
@given(poses, poses)
def test_what_the_walls_say_does_not_depend_on_the_frames(frame_1, frame_2):
    ref, mov, _, T_ref_mov = flat_pair(frame_1, frame_2)
    found, usual = weighed(ref, mov, T_ref_mov), weighed(REF, MOV, T)
    assert found.contradiction < 0.06
    assert found.agreeing == pytest.approx(usual.agreeing, rel=0.15)
    assert found.across == pytest.approx(usual.across, rel=0.4)  # a thin wall faces here or there
    assert found.floor == pytest.approx(usual.floor, rel=0.05)


@settings(max_examples=40)
@given(st.floats(-1, 1), st.floats(-1, 1), st.floats(-0.5, 0.5))
def test_swapping_the_maps_changes_nothing(x, y, turn):
    beside = T @ Pose2(x, y, turn)
    there, back = weighed(REF, MOV, beside), weighed(MOV, REF, beside.inverse())
    for name in ("rigid_agreeing", "rigid_contradicting", "floor", "across", "agreeing"):
        assert getattr(there, name) == pytest.approx(getattr(back, name), rel=1e-3, abs=0.2), name


@settings(max_examples=40)
@given(st.floats(-2, 2), st.floats(-2, 2), st.floats(-1, 1))
def test_letting_patches_slip_never_speaks_against_a_transform(x, y, turn):
    found = weighed(REF, MOV, T @ Pose2(x, y, turn))
    slipped = found.agreeing - found.contradicting
    assert slipped >= found.rigid_agreeing - found.rigid_contradicting - 1e-9


def test_agreeing_wall_is_counted_in_metres_from_both_maps():
    wall = [(2.0, 8.0, 12.0, 8.1)]  # 10 m, two sides and two ends, in both maps
    found = weighed(hall(wall), hall(wall), Pose2())
    assert found.agreeing == pytest.approx(2 * (2 * 10.0), rel=0.02)
    assert found.contradicting == 0
    assert found.floor == pytest.approx(16.0**2 - 1.0, rel=0.01)


def test_the_resolution_does_not_change_the_metres():
    walls = [(2.0, 8.0, 12.0, 8.2), (4.0, 2.0, 4.2, 6.0)]
    usual = weighed(hall(walls), hall(walls), Pose2())
    for cell in (0.1, 0.025, 0.01):
        other = weighed(hall(walls, cell=cell), hall(walls, cell=cell), Pose2())
        assert other.agreeing == pytest.approx(usual.agreeing, rel=0.06), cell
        assert other.floor == pytest.approx(usual.floor, rel=0.02), cell


def test_a_box_in_the_others_free_floor_contradicts_however_patches_slip():
    found = weighed(hall([(7, 7, 8, 8), (1, 1, 15, 1.1)]), hall([(1, 1, 15, 1.1)]), Pose2())
    assert found.contradicting == pytest.approx(3.9, abs=0.2)  # its 4 m of edge, a corner counted once
    assert mended(found) == pytest.approx(0)


def test_what_the_other_map_does_not_know_says_nothing():
    ref = hall([(7, 7, 8, 8), (1, 1, 15, 1.1)])
    blind = GridMap(np.full(ref.cells.shape, UNKNOWN, dtype=np.int8), 0.05)
    found = weighed(ref, blind, Pose2())
    assert (found.agreeing, found.contradicting, found.contradiction, found.floor) == (0, 0, 1, 0)


def one_sided(above: bool) -> GridMap:
    """A wall of 10 m seen from one side: the floor behind it is unknown."""
    grid = hall([(2.0, 8.0, 12.0, 8.1)])
    cells = grid.cells.copy()
    behind = slice(0, round(8.0 / 0.05)) if above else slice(round(8.1 / 0.05), None)
    cells[behind] = UNKNOWN
    return GridMap(cells, 0.05)


def test_a_wall_that_was_seen_from_opposite_sides_neither_agrees_nor_contradicts():
    same = weighed(one_sided(True), one_sided(True), Pose2())
    back = weighed(one_sided(True), one_sided(False), Pose2())
    assert same.agreeing == pytest.approx(20.0, rel=0.05)
    assert back.agreeing < 0.1 * same.agreeing
    assert back.contradicting == 0


@settings(max_examples=40)
@given(st.floats(-np.pi, np.pi))
def test_a_turned_wall_is_still_seen_from_the_side_it_was_seen_from(turn):
    ref, mov = one_sided(True), one_sided(True)
    turned = replace(mov, origin=Pose2(theta=turn) @ mov.origin)
    found = weighed(ref, turned, Pose2(theta=-turn))
    assert found.agreeing == pytest.approx(20.0, rel=0.05)


def test_what_runs_across_a_corridor_is_what_keeps_it_from_sliding():
    corridor = [(1, 7, 15, 7.1), (1, 9, 15, 9.1)]
    along = weighed(hall(corridor), hall(corridor), Pose2())
    stopped = [*corridor, (8, 7, 8.1, 9)]
    crossed = weighed(hall(stopped), hall(stopped), Pose2())
    assert along.across < 2.0  # the ends
    assert crossed.across == pytest.approx(along.across + 2 * 2 * 2.0, abs=1.0)  # two sides, two maps
    slid = weighed(hall(stopped), hall(stopped), Pose2(1.0))
    assert slid.across < 2.0


@pytest.mark.parametrize("turn", [0.5, -1.2, 2.9])
def test_how_a_maps_raster_is_turned_in_its_frame_does_not_change_what_runs_across(turn):
    stopped = hall([(1, 7, 15, 7.1), (1, 9, 15, 9.1), (8, 7, 8.1, 9)])
    turned = replace(stopped, origin=Pose2(theta=turn))
    crossed = weighed(stopped, stopped, Pose2()).across
    assert weighed(stopped, turned, Pose2(theta=-turn)).across == pytest.approx(crossed, rel=0.02)
    assert weighed(turned, stopped, Pose2(theta=turn)).across == pytest.approx(crossed, rel=0.02)


def test_a_speck_is_no_wall():
    cells = hall([(1, 1, 15, 1.1)]).cells.copy()
    cells[100::20, 50::20] = OCCUPIED  # far apart, a cell each
    noisy, clean = GridMap(cells, 0.05), hall([(1, 1, 15, 1.1)])
    assert weighed(noisy, clean, Pose2()).rigid_contradicting == 0


def test_what_lies_around_a_robot_says_nothing():
    ring = hall([(1, 1, 15, 1.1)]).cells.copy()
    rows, cols = np.indices(ring.shape)
    away = np.hypot(rows - 160, cols - 160) * 0.05
    ring[(away > 0.25) & (away < 0.35)] = OCCUPIED
    seen, clean = GridMap(ring, 0.05), hall([(1, 1, 15, 1.1)])
    here = np.array([[8.0, 8.0]])
    robots = Robots(np.zeros((0, 2)), here, 0.4)
    assert weighed(seen, clean, Pose2()).rigid_contradicting > 2
    assert weighed(seen, clean, Pose2(), robots).rigid_contradicting == 0
    far = replace(robots, in_mov=here + 3.0)
    assert weighed(seen, clean, Pose2(), far).rigid_contradicting > 2
    # whatever the frames of the maps: the ring stands in map 1, and in map 2
    turned, T_turned = replace(clean, origin=Pose2(20.0, -9.0, 1.0)), Pose2(20.0, -9.0, 1.0)
    in_mov = replace(robots, in_mov=T_turned.apply(here))
    assert weighed(seen, turned, T_turned.inverse(), in_mov).rigid_contradicting == 0
    in_ref = Robots(T_turned.apply(here), np.zeros((0, 2)), 0.4)
    assert weighed(turned, seen, T_turned, in_ref).rigid_contradicting == 0


def test_a_wall_that_is_a_little_off_is_bent_and_one_far_off_is_wrong():
    straight = hall([(1, 8, 15, 8.1)])
    little = weighed(straight, hall([(1, 8 + 0.75 * SLIP, 15, 8.1 + 0.75 * SLIP)]), Pose2())
    far = weighed(straight, hall([(1, 8 + 3 * SLIP, 15, 8.1 + 3 * SLIP)]), Pose2())
    assert little.rigid_contradiction > 0.9
    assert little.contradiction < 0.02
    assert far.contradiction > 0.9
    assert mended(far) < 0.05
    assert 0.5 * SLIP < little.slip < 0.8 * SLIP  # it stops as soon as the walls are near enough
    assert weighed(straight, straight, Pose2()).slip == 0


def test_where_bent_maps_lie_beside_each_other_is_told_with_how_far():
    straight = hall([(1, 8, 15, 8.1)])
    bent = hall([(1, 8, 8, 8.1), (8, 8.45, 15, 8.55)])
    worst = weighed(straight, bent, Pose2()).apart[0]
    assert worst.metres == pytest.approx(0.45, abs=0.16)
    assert 8 < worst.x < 15
    assert abs(worst.y - 8) < PATCH / 2
    assert weighed(straight, straight, Pose2()).apart == ()
    twice = hall([(1, 8.3, 8, 8.4), (8, 8.5, 15, 8.6)])
    slips = [place.metres for place in weighed(straight, twice, Pose2()).apart]
    assert len(set(slips)) > 1
    assert slips == sorted(slips, reverse=True)


def test_a_bent_map_of_the_same_flat_is_told_from_another_building():
    whole = drawn_map(Pose2())
    same, other = weighed(whole, bent(whole), Pose2()), weighed(whole, whole.mirrored(), Pose2(9.0))
    assert same.rigid_contradiction > 0.08
    assert mended(same) > 0.5 * same.rigid_contradiction
    assert same.contradiction < 0.5 * other.contradiction


def test_the_answer_does_not_depend_on_the_number_of_threads(monkeypatch):
    beside = T @ Pose2(0.2, 0.1, 0.05)
    found = weighed(REF, MOV, beside)
    monkeypatch.setattr(kernels, "cores", lambda: 1)
    assert weighed(REF, MOV, beside) == found


def test_maps_that_do_not_touch_say_nothing():
    found = weighed(REF, MOV, Pose2(500.0, 0.0, 0.0) @ T)
    assert found.shared_wall == 0
    assert found.floor == 0


def test_every_wall_of_the_flat_is_there_to_be_counted():
    whole = drawn_map(T_MOV_WORLD)
    length = sum(np.hypot(x1 - x0, y1 - y0) for x0, y0, x1, y1 in WALLS)
    found = weighed(whole, whole, Pose2())
    assert length < found.agreeing / 2 < 2.2 * length  # the outer walls show one side, inner ones two


def test_a_turn_of_the_whole_by_a_patch_turn_is_bent_not_wrong():
    turned = hall([(3, 8, 13, 8.1), (8, 3, 8.1, 13)])
    centre, angle = np.array([8.0, 8.0]), 0.05
    shift = centre - rotation(angle) @ centre
    found = weighed(turned, turned, Pose2(*shift.tolist(), angle))
    assert found.contradiction < found.rigid_contradiction
    assert found.contradiction < 0.1


def test_of_a_map_with_very_much_wall_a_part_stands_for_all(monkeypatch):
    whole = weighed(REF, MOV, T)
    for name in (
        "algorithms.verdict.wall_map.MOST_POINTS",
        "algorithms.verdict.slipping_patches.MOST_SLIPPING",
    ):
        monkeypatch.setattr(name, 300)
    part = weighed(REF, MOV, T)
    assert len(make_wall_map(REF).points) <= 300
    assert part.agreeing == pytest.approx(whole.agreeing, rel=0.1)
    assert part.contradiction == pytest.approx(whole.contradiction, abs=0.02)
