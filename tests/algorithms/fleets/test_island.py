"""Each robot is held against the map of the others: who shows walls that they deny is taken out, and told."""

from __future__ import annotations

from dataclasses import replace
from math import log

import numpy as np
import pytest
from drawn import drawn_map, poses
from hypothesis import given, settings
from hypothesis import strategies as st

from algorithms.common.pose import Pose2
from algorithms.fleets.fleet_merge import FleetResult, joined
from algorithms.fleets.island import BESIDE, LEAST_WALL, Island
from algorithms.fleets.pair_hypotheses import Hypothesis, PairFinding, PairOrder
from algorithms.maps.grid_map import FREE, OCCUPIED, UNKNOWN, GridMap
from algorithms.maps.map_fusion import fuse
from algorithms.observations.fleet import Fleet

CELL = 0.1
COVARIANCE = np.diag([0.03, 0.03, 0.005]) ** 2
FRAMES = st.lists(poses, min_size=3, max_size=5)
"""The flat's frame in those of several robots."""
FAR = st.builds(Pose2, st.floats(1.0, 2.5), st.floats(1.0, 2.5), st.floats(0.5, 2.5))
"""So far a robot is placed from where it truly lies."""


def island(maps: dict[str, GridMap], at: dict[str, Pose2]) -> Island:
    fusion = fuse(list(maps.values()), [at[name] for name in maps])
    return Island(next(iter(maps)), at, {}, {}, fusion)


def flats(frames: list[Pose2]) -> tuple[dict[str, GridMap], dict[str, Pose2]]:
    """A map of the flat in each of these frames, and where they lie in the first one's."""
    maps = {f"r{k}": drawn_map(frame, CELL) for k, frame in enumerate(frames)}
    return maps, {f"r{k}": frames[0] @ frame.inverse() for k, frame in enumerate(frames)}


def worst(found: Island) -> str:
    denied = found.denied()
    return max(denied, key=lambda name: denied[name][1] - denied[name][0])


@settings(max_examples=20, deadline=None)
@given(FRAMES)
def test_nobody_is_denied_where_all_lie_as_they_truly_do(frames):
    assert island(*flats(frames)).denied() == {}


@settings(max_examples=20, deadline=None)
@given(FRAMES, FAR, st.data())
def test_most_is_denied_of_the_robot_that_lies_wrong(frames, off, data):
    maps, at = flats(frames)
    wrong = data.draw(st.sampled_from(list(maps)[1:]))
    about = maps[wrong].centres(*(np.array([side // 2]) for side in maps[wrong].cells.shape))[0]
    there = Pose2(*about.tolist())
    at[wrong] = at[wrong] @ there @ off @ there.inverse()
    found = island(maps, at)
    assert worst(found) == wrong
    agree, deny = found.denied()[wrong]
    assert deny > max(agree, LEAST_WALL)


@settings(max_examples=10, deadline=None)
@given(FRAMES, FAR, st.data())
def test_the_order_of_the_robots_changes_nothing(frames, off, data):
    maps, at = flats(frames)
    at["r1"] = at["r1"] @ off
    root, *others = maps
    again = {name: maps[name] for name in (root, *data.draw(st.permutations(others)))}
    one, other = (island(each, {name: at[name] for name in each}).denied() for each in (maps, again))
    assert one == other


def test_of_two_robots_nobody_can_say_which_is_wrong():
    maps, at = flats([Pose2(), Pose2()])
    at["r1"] = Pose2(3.0, 2.0, 1.0)
    assert island(maps, at).denied() == {}


# --- rooms of which every metre is known ------------------------------------------------------------------


def hall(*walls: tuple[int, int, int], side: int = 80) -> GridMap:
    """A hall of floor between two long walls, with further walls: row, first and last column."""
    cells = np.full((side, side), FREE, dtype=np.int8)
    cells[0], cells[-1] = OCCUPIED, OCCUPIED
    for row, first, last in walls:
        cells[row, first:last] = OCCUPIED
    return GridMap(cells, CELL)


def together(*maps: GridMap) -> Island:
    named = {f"r{k}": grid for k, grid in enumerate(maps)}
    return island(named, dict.fromkeys(named, Pose2()))


@pytest.mark.parametrize("rows", [0, 1, round(BESIDE / CELL)])
def test_a_wall_that_lies_a_little_beside_that_of_the_others_is_the_same(rows):
    theirs, mine = hall((40, 5, 75)), hall((40 + rows, 5, 75))
    assert together(theirs, theirs, mine).denied() == {}


@pytest.mark.parametrize("wrong", [0, 1, 2])
def test_walls_that_the_others_saw_floor_at_are_told_in_metres_and_count_against_nobody_else(wrong):
    maps = [hall(), hall(), hall()]
    maps[wrong] = hall((30, 5, 75), (40, 5, 75), (50, 5, 75))
    assert together(*maps).denied() == {f"r{wrong}": (pytest.approx(16.0), pytest.approx(21.0))}


def test_walls_that_a_robot_has_not_though_it_saw_their_place_speak_against_it_too():
    theirs = hall((30, 5, 75), (40, 5, 75), (50, 5, 75))
    assert together(theirs, theirs, hall()).denied() == {"r2": (pytest.approx(16.0), pytest.approx(21.0))}


def test_of_little_wall_nothing_is_concluded():
    floor = GridMap(np.full((80, 80), FREE, dtype=np.int8), CELL)

    def lone(cells: int) -> dict[str, tuple[float, float]]:
        mine = floor.cells.copy()
        mine[40, 10 : 10 + cells] = OCCUPIED
        return together(floor, floor, replace(floor, cells=mine)).denied()

    least = round(LEAST_WALL / CELL)
    assert lone(least) == {}
    assert lone(least + 1) == {"r2": (0.0, pytest.approx(LEAST_WALL + CELL))}


def test_what_nobody_else_has_seen_is_neither_confirmed_nor_denied():
    elsewhere = hall((40, 5, 75))
    left = replace(hall(), cells=np.where(np.arange(80) < 3, hall().cells, UNKNOWN).astype(np.int8))
    assert together(left, left, elsewhere).denied() == {}


# --- and is taken out of the fleet ------------------------------------------------------------------------


def pair(number: int, ref: str, mov: str, T: Pose2, likely: float = 0.97) -> PairFinding:
    answer = Hypothesis(T, COVARIANCE, likely, log(likely / (1 - likely)))
    return PairFinding(PairOrder(ref, mov, (number,)), np.zeros(2), (answer,), "", True)


def star(wrong: Pose2 | None = None) -> FleetResult:
    """The first of five robots has seen all others; where the third of these lies is told wrongly."""
    frames = [Pose2(), Pose2(3.0, 1.0, 0.4), Pose2(-2.0, 5.0, -1.3), Pose2(0.0, -4.0, 2.2), Pose2(9.0, 9.0)]
    maps, at = flats(frames)
    if wrong is not None:
        at["r3"] = wrong
    found = [pair(k, "r0", f"r{k}", at[f"r{k}"]) for k in range(1, 5)]
    return joined(Fleet(maps), found)


def test_a_robot_whose_walls_the_rest_deny_is_taken_out_and_said_to_be_and_moves_nobody():
    right, found = star(), star(wrong=Pose2(4.0, 3.0, 0.9))
    assert set(right.placed) == {f"r{k}" for k in range(5)}
    assert right.refused == {}
    assert set(found.placed) == set(right.placed) - {"r3"}
    assert [tuple(island.poses) for island in found.islands[1:]] == [("r3",)]
    said = found.refused["r3"]
    assert said.startswith("the others' maps deny ")
    assert said.endswith(" m")
    for name, T in found.placed.items():
        assert right.placed[name] == T


def test_by_force_it_stays():
    maps, at = flats([Pose2(), Pose2(), Pose2()])
    found = [pair(1, "r0", "r1", at["r1"]), pair(2, "r0", "r2", Pose2(4.0, 3.0, 0.9))]
    assert set(joined(Fleet(maps), found).placed) == {"r0", "r1"}
    forced = joined(Fleet(maps), found, force=True)
    assert set(forced.placed) == set(maps)
    assert forced.refused == {}


def test_who_was_tied_through_it_alone_goes_with_it_and_is_not_said_to_be_denied():
    maps, at = flats([Pose2(), Pose2(), Pose2(), Pose2()])
    wrong = Pose2(4.0, 3.0, 0.9)
    chain = [pair(1, "r0", "r1", at["r1"]), pair(2, "r0", "r2", wrong), pair(3, "r2", "r3", wrong.inverse())]
    found = joined(Fleet(maps), chain)
    assert set(found.placed) == {"r0", "r1"}
    assert set(found.refused) == {"r2"}
