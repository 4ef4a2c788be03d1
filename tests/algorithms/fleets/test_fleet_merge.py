"""A fleet becomes one map: lies are left out, who is not tied stands alone, two robots merge as a pair."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from repository import ROOT

from algorithms.common.errors import SettingError
from algorithms.common.pose import Pose2, pose_error
from algorithms.files.case_folder import Case
from algorithms.files.fleet_file import read_fleet
from algorithms.files.fleet_truth_file import read_fleet_truth
from algorithms.fleets.fleet_merge import FleetResult, PairStep, merge_fleet, poses_so_far, run_fleet
from algorithms.fleets.pair_hypotheses import find_pair, known_of, pair_orders
from algorithms.maps.grid_map import GridMap
from algorithms.methods.registry import merge
from algorithms.observations.fleet import Fleet, FleetPrior, FleetSighting
from algorithms.observations.observation import Observation
from algorithms.observations.pair_problem import Known
from algorithms.observations.priors import InitialPose, NearPlace, TurnPrior

MOVED = Pose2(31.0, -7.0, 1.9)


def reframed(grid: GridMap, T: Pose2) -> GridMap:
    """The same map in another frame, whose points T takes to the old one's."""
    return replace(grid, origin=T.inverse() @ grid.origin)


def seen_in(o: Observation, T: Pose2) -> Observation:
    """The same sighting where the observed robot's map has that other frame."""
    x, y = T.inverse().apply(np.array([o.observed_x, o.observed_y])).tolist()
    return replace(o, observed_x=x, observed_y=y, observed_heading=None, bearing_back=None)


@pytest.fixture(scope="module")
def three(small_case: Case) -> Fleet:
    """Ann saw Bob and Cid; Cid's map is Bob's, in a frame of its own."""
    (o,) = small_case.observations
    maps = {"ann": small_case.ref, "bob": small_case.mov, "cid": reframed(small_case.mov, MOVED)}
    seen = (FleetSighting("ann", "bob", o), FleetSighting("ann", "cid", seen_in(o, MOVED)))
    return Fleet(maps, seen)


@pytest.fixture(scope="module")
def merged(three: Fleet) -> FleetResult:
    return merge_fleet(three)


def near(a: Pose2, b: Pose2, at: np.ndarray) -> bool:
    distance, angle = pose_error(a, b, at)
    return distance < 0.05 and angle < 0.01


def test_every_robot_is_placed_where_it_truly_lies(merged, small_case):
    T, at = small_case.truth.T_ref_mov, small_case.observations[0]
    pivot = np.array([at.observed_x, at.observed_y])
    assert merged.whole
    assert near(merged.placed["bob"], T, pivot)
    assert near(merged.placed["cid"], T @ MOVED, MOVED.inverse().apply(pivot))
    assert min(merged.islands[0].probability.values()) > 0.9


def test_two_robots_and_one_sighting_merge_as_a_pair_to_the_last_digit(small_case):
    (o,) = small_case.observations
    fleet = Fleet({"a": small_case.ref, "b": small_case.mov}, (FleetSighting("a", "b", o),))
    alone = merge(small_case.ref, small_case.mov, o)
    result = merge_fleet(fleet)
    assert result.placed["b"] == alone.T_ref_mov
    assert np.array_equal(result.islands[0].fusion.merged.cells, alone.fusion.merged.cells)
    assert result.islands[0].probability["b"] == pytest.approx(alone.verdict.probability, abs=1e-3)


def test_the_order_of_robots_and_sightings_changes_nothing(three, merged):
    again = merge_fleet(Fleet(dict(reversed(three.maps.items())), three.sightings[::-1], anchor="ann"))
    for name, T in merged.placed.items():
        assert again.placed[name].array() == pytest.approx(T.array(), abs=1e-9)
    assert np.array_equal(again.islands[0].fusion.merged.cells, merged.islands[0].fusion.merged.cells)


def test_another_anchor_gives_the_same_poses_moved(three, merged):
    other = merge_fleet(replace(three, anchor="cid"))
    for name, T in merged.placed.items():
        moved = merged.placed["cid"] @ other.placed[name]
        assert moved.array()[:2] == pytest.approx(T.array()[:2], abs=1e-3)


def test_a_lie_is_named_and_moves_nobody(three, merged):
    (first, _) = three.sightings
    lie = replace(first.observation, observed_x=first.observation.observed_x + 3.0)
    result = merge_fleet(replace(three, sightings=(*three.sightings, FleetSighting("ann", "bob", lie))))
    assert [each.number for each in result.left_out] == [2]
    assert result.left_out[0].distance == pytest.approx(3.0, abs=0.2)
    assert "ann's sighting of bob" in result.left_out[0].reason
    for name, T in merged.placed.items():
        assert result.placed[name].array() == pytest.approx(T.array(), abs=0.02)


def test_a_robot_of_another_building_stands_alone(three, strangers):
    (o,) = strangers.observations
    maps = {**three.maps, "dan": strangers.mov}
    result = merge_fleet(Fleet(maps, (*three.sightings, FleetSighting("ann", "dan", o))))
    assert set(result.placed) == {"ann", "bob", "cid"}
    assert [set(island.poses) for island in result.islands[1:]] == [{"dan"}]
    assert not result.whole


def test_a_robot_that_nobody_saw_is_looked_for_without_a_sighting(three, merged):
    result = merge_fleet(replace(three, sightings=three.sightings[:1]))
    assert result.whole
    assert result.placed["cid"].array() == pytest.approx(merged.placed["cid"].array(), abs=0.1)


def test_a_robot_whose_pose_is_roughly_known_needs_no_sighting(three, merged):
    T = merged.placed["cid"]
    rough = InitialPose(Pose2(T.x + 0.5, T.y - 0.5, T.theta + 0.1))
    fleet = replace(three, sightings=three.sightings[:1], priors=(FleetPrior("ann", "cid", rough),))
    assert [(order.mov, order.sightings) for order in pair_orders(fleet)] == [("bob", (0,)), ("cid", ())]
    result = merge_fleet(fleet)
    assert result.placed["cid"].array() == pytest.approx(T.array(), abs=0.1)


def test_what_is_known_the_other_way_round_joins_the_sighting_and_is_no_second_merge(small_case):
    (o, _, turn, _) = rough_knowledge(small_case)["all"]
    maps = {"a": small_case.ref, "b": small_case.mov}
    for told in (FleetPrior("a", "b", turn), FleetPrior("b", "a", turn.inverse())):
        fleet = Fleet(maps, (FleetSighting("a", "b", o),), (told,))
        (order,) = pair_orders(fleet)
        assert (order.ref, order.mov) == ("a", "b")
        assert known_of(fleet, order) == (o, turn)


def rough_knowledge(small_case: Case) -> dict[str, tuple[Known, ...]]:
    """What may be known of the two maps, by what it is called."""
    T, (o,) = small_case.truth.T_ref_mov, small_case.observations
    turn = TurnPrior(T.theta + 0.05, 0.1)
    x, y = T.apply(np.array([o.observed_x, o.observed_y])).tolist()
    place = NearPlace(x + 0.3, y - 0.2, o.observed_x, o.observed_y, 1.0)
    pose = InitialPose(Pose2(T.x + 0.2, T.y - 0.2, T.theta + 0.05), 0.5, 0.5, 0.2)
    return {"turn": (turn,), "place": (place,), "pose": (pose,), "all": (o, pose, turn, place)}


@pytest.mark.parametrize("what", ["turn", "place", "pose", "all"])
def test_two_robots_of_which_something_else_is_known_merge_as_a_pair_to_the_last_digit(small_case, what):
    known = rough_knowledge(small_case)[what]
    seen = tuple(FleetSighting("a", "b", one) for one in known if isinstance(one, Observation))
    rough = tuple(FleetPrior("a", "b", one) for one in known if not isinstance(one, Observation))
    fleet = Fleet({"a": small_case.ref, "b": small_case.mov}, seen, rough)
    alone = merge(small_case.ref, small_case.mov, known)
    result = merge_fleet(fleet)
    assert result.placed["b"] == alone.T_ref_mov
    assert np.array_equal(result.islands[0].fusion.merged.cells, alone.fusion.merged.cells)
    assert result.islands[0].probability["b"] == pytest.approx(alone.verdict.probability, abs=1e-3)


@given(st.data())
def test_names_and_order_change_nothing_of_what_each_pair_is_merged_from(small_case, data):
    (o,) = small_case.observations
    names, grid = ["ann", "bob", "cid", "dan"], small_case.ref
    pair = st.permutations(names).map(lambda order: tuple(order[:2]))
    priors = tuple(
        FleetPrior(*data.draw(pair), TurnPrior(0.1 * k)) for k in range(data.draw(st.integers(0, 5)))
    )
    seen = tuple(FleetSighting(*data.draw(pair), o) for _ in range(data.draw(st.integers(0, 3))))
    fleet = Fleet(dict.fromkeys(names, grid), seen, priors)
    called = dict(zip(names, data.draw(st.permutations(["a", "b", "c", "d"])), strict=True))
    other = Fleet(
        {called[name]: grid for name in data.draw(st.permutations(names))},
        tuple(
            FleetSighting(called[each.observer], called[each.observed], o)
            for each in data.draw(st.permutations(seen))
        ),
        tuple(
            FleetPrior(called[each.ref], called[each.mov], each.prior)
            for each in data.draw(st.permutations(priors))
        ),
    )

    def told(fleet: Fleet, called: Mapping[str, str]) -> set[tuple[str, str, frozenset[Known]]]:
        orders = pair_orders(fleet)
        return {(called[each.ref], called[each.mov], frozenset(known_of(fleet, each))) for each in orders}

    itself = {name: name for name in other.maps}
    assert told(fleet, called) == told(other, itself)
    assert len(pair_orders(fleet)) == len(pair_orders(other))


def test_the_order_of_what_is_known_moves_nobody(three, merged, small_case):
    pose, turn, place = rough_knowledge(small_case)["all"][1:]
    rough = tuple(FleetPrior("ann", "bob", one) for one in (pose, turn, place))
    one, other = (merge_fleet(replace(three, priors=order)) for order in (rough, rough[::-1]))
    for name, T in one.placed.items():
        assert other.placed[name].array() == pytest.approx(T.array(), abs=1e-9)
        assert near(T, merged.placed[name], np.zeros(2))


def test_sightings_that_cannot_be_true_together_are_merged_one_by_one(three):
    (first, _) = three.sightings
    other = replace(first.observation, observer=Pose2(first.observation.observer.x + 4.0, 2.0, 0.3))
    together = replace(three, sightings=(first, first))
    apart = replace(three, sightings=(first, FleetSighting("ann", "bob", other)))
    assert [order.sightings for order in pair_orders(together)] == [(0, 1)]
    assert [order.sightings for order in pair_orders(apart)] == [(0,), (1,)]


def test_each_pair_is_told_as_it_is_done(three):
    *pairs, last = run_fleet(three)
    assert all(isinstance(step, PairStep) for step in pairs)
    assert [step.done for step in pairs] == [1, 2]
    assert {step.total for step in pairs} == {2}
    assert isinstance(last, FleetResult)


@pytest.mark.parametrize(
    ("broken", "said"),
    [
        (lambda fleet: replace(fleet, anchor="eve"), "anchor names 'eve'"),
        (lambda fleet: replace(fleet, maps={"ann": fleet.maps["ann"]}), "2 to 50 robots, not 1"),
        (lambda fleet: replace(fleet, maps={f"r{k}": fleet.maps["ann"] for k in range(51)}), "not 51"),
        (
            lambda fleet: replace(fleet, sightings=(replace(fleet.sightings[0], observed="eve"),)),
            "sighting 1 names 'eve'",
        ),
        (
            lambda fleet: replace(fleet, sightings=(replace(fleet.sightings[0], observed="ann"),)),
            "cannot have seen itself",
        ),
        (
            lambda fleet: replace(fleet, priors=(FleetPrior("ann", "eve", TurnPrior(0.0)),)),
            "known 1 names 'eve'",
        ),
        (
            lambda fleet: replace(fleet, priors=(FleetPrior("ann", "ann", TurnPrior(0.0)),)),
            "known 1: ann is named twice",
        ),
        (
            lambda fleet: replace(fleet, priors=(FleetPrior("ann", "bob", TurnPrior(0.0)),) * 201),
            "at most 200 things",
        ),
        (
            lambda fleet: replace(fleet, maps={**fleet.maps, "a/b": fleet.maps["ann"]}),
            "'a/b' is no name for a robot",
        ),
    ],
)
def test_a_fleet_that_cannot_be_is_told_in_a_line(three, broken: Callable[[Fleet], Fleet], said):
    with pytest.raises(SettingError, match=said):
        broken(three)


def all_right(found: FleetResult, folder) -> bool:
    truth = read_fleet_truth(folder / "truth.yaml")
    off = [
        pose_error(T, truth.T_anchor_robot[name], np.array(truth.at[name]))
        for name, T in found.placed.items()
        if name in truth.T_anchor_robot
    ]
    return all(distance < truth.tolerance_m and angle < truth.tolerance_rad for distance, angle in off)


def test_a_twin_that_a_pair_leaves_open_is_decided_by_the_way_round():
    folder = ROOT / "sample_maps" / "corridor_fleet_loop"
    fleet = read_fleet(folder)
    open_pairs = [found for order in pair_orders(fleet) if not (found := find_pair(fleet, order)).accepted]
    assert [(found.order.ref, found.order.mov) for found in open_pairs] == [("r1", "r2")]
    likely, twin, *_ = (each.probability for each in open_pairs[0].hypotheses)
    assert likely < 2 * twin
    found = merge_fleet(fleet)
    assert found.whole
    assert not found.left_out
    assert all_right(found, folder)


def test_a_lie_and_an_island_are_told_in_the_sample_that_has_both():
    folder = ROOT / "sample_maps" / "home_fleet_island"
    truth = read_fleet_truth(folder / "truth.yaml")
    found = merge_fleet(read_fleet(folder))
    assert [each.number for each in found.left_out] == list(truth.lies)
    assert [tuple(island.poses) for island in found.islands[1:]] == list(truth.islands)
    assert all_right(found, folder)


def test_while_pairs_are_merged_each_answer_ties_its_robot_to_the_anchor(three, merged):
    findings = [find_pair(three, order) for order in pair_orders(three)]
    assert set(poses_so_far(three, ())) == {"ann"}
    assert set(poses_so_far(three, findings[:1])) == {"ann", "bob"}
    so_far = poses_so_far(three, findings)
    for name, T in merged.placed.items():
        assert near(so_far[name], T, np.zeros(2))


def test_by_force_the_likeliest_answer_is_taken_and_said_to_be_unlikely():
    fleet = read_fleet(ROOT / "sample_maps" / "corridor_fleet_loop")
    maps = {name: fleet.maps[name] for name in ("r1", "r2")}
    vague = Fleet(
        maps, tuple(seen for seen in fleet.sightings if {seen.observer, seen.observed} <= set(maps))
    )
    assert set(merge_fleet(vague).placed) == {"r1"}
    *_, forced = run_fleet(vague, force=True)
    assert set(forced.placed) == {"r1", "r2"}
    assert forced.forced == {"r2"}
    assert not forced.whole


@pytest.mark.parametrize("off", [0.0, 0.08])
def test_a_true_sighting_more_moves_no_robot_by_more_than_its_covariance_says(three, merged, small_case, off):
    """From another place, to where the first one puts Cid; ``off``: metres by which it is wrong."""
    (o,) = small_case.observations
    again = seen_in(replace(o, range=o.range + off), MOVED)
    more = merge_fleet(replace(three, sightings=(*three.sightings, FleetSighting("ann", "cid", again))))
    for name, T in more.placed.items():
        moved = T.array() - merged.placed[name].array()
        if name != "ann":
            assert moved @ np.linalg.solve(merged.islands[0].covariances[name], moved) < 9.0
