"""A fleet on the page: what a person changes, and what of the findings stays."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from algorithms.common.errors import SettingError
from algorithms.common.pose import Pose2
from algorithms.common.robot_names import LONGEST_NAME, NAME_RULE, RobotNames, is_name
from algorithms.files.case_folder import Case
from algorithms.fleets.fleet_merge import merge_fleet, run_fleet
from algorithms.fleets.pair_hypotheses import Hypothesis, PairFinding, PairOrder, pair_orders
from algorithms.observations.fleet import Fleet, FleetPrior, FleetSighting
from algorithms.observations.observation import Observation
from algorithms.observations.pair_problem import Known
from algorithms.observations.priors import InitialPose, NearPlace, Prior, TurnPrior
from app.model.fleet_state import ALONE, LEFT_OUT, PLACED, USED, WAITING, FleetState
from app.model.live.robot_state import RobotState

SOMEWHERE = Pose2(1.0, 2.0, 0.3)
ANN_BOB = PairOrder("ann", "bob", (0,))
PLACE = st.floats(-5.0, 5.0)
KNOWN = st.one_of(
    st.builds(Observation, st.builds(Pose2, PLACE, PLACE), PLACE, PLACE, st.just(2.0), st.just(0.0)),
    st.builds(TurnPrior, st.floats(-3.0, 3.0)),
    st.builds(NearPlace, PLACE, PLACE, PLACE, PLACE),
    st.builds(InitialPose, st.builds(Pose2, PLACE, PLACE)),
)


def rough_of(known: Sequence[Known]) -> tuple[Prior, ...]:
    return tuple(one for one in known if not isinstance(one, Observation))


@pytest.fixture(scope="module")
def state(small_case: Case) -> FleetState:
    """Ann saw Bob; nobody saw Cid, whose map is Ann's."""
    (o,) = small_case.observations
    maps = {"ann": small_case.ref, "bob": small_case.mov, "cid": replace(small_case.ref)}
    return FleetState(Fleet(maps, (FleetSighting("ann", "bob", o),)), "three")


def found(order: PairOrder) -> PairFinding:
    answer = Hypothesis(SOMEWHERE, np.eye(3), 0.99, 4.0)
    return PairFinding(order, np.zeros(2), (answer,), "they agree", True)


def names(state: FleetState) -> tuple[tuple[str, ...], list[tuple[str, str]], str]:
    f = state.fleet
    return tuple(f.maps), [(seen.observer, seen.observed) for seen in f.sightings], f.anchor


@given(st.sampled_from(["ann", "bob", "cid"]), st.text(min_size=1, max_size=70))
def test_a_robot_is_called_by_any_name_that_nobody_has_and_by_its_old_one_again(state, old, new):
    possible = is_name(new) and new not in state.robots
    if not possible:
        with pytest.raises(SettingError):
            state.renamed(old, new)
        return
    called = state.renamed(old, new)
    assert set(called.robots) == {new} | set(state.robots) - {old}
    assert called.fleet.maps[new] is state.fleet.maps[old]
    assert names(called.renamed(new, old)) == names(state)


def test_what_is_no_name_is_told_with_the_rule(state):
    with pytest.raises(SettingError, match=NAME_RULE):
        state.renamed("ann", "a/b")
    with pytest.raises(SettingError, match="there is a robot bob already"):
        state.renamed("ann", "bob")


def test_what_was_found_of_a_pair_is_found_under_new_names_and_lost_with_its_sighting(state):
    told = state.with_finding(found(ANN_BOB))
    assert told.finding(ANN_BOB).reason == "they agree"
    renamed = told.renamed("ann", "eve")
    assert renamed.finding(PairOrder("eve", "bob", (0,))).order == PairOrder("eve", "bob", (0,))
    assert told.with_robot("dan", state.fleet.maps["cid"]).finding(ANN_BOB) is not None
    (seen,) = state.fleet.sightings
    other = replace(seen, observation=replace(seen.observation, range=seen.observation.range + 0.5))
    assert told.with_fleet(replace(state.fleet, sightings=(other,))).finding(ANN_BOB) is None


def test_a_robot_goes_with_all_that_it_saw_and_that_saw_it(state):
    assert names(state.without_robot("bob")) == (("ann", "cid"), [], "ann")
    assert names(state.without_robot("ann")) == (("bob", "cid"), [], "bob")
    with pytest.raises(SettingError, match="2 to 50"):
        state.without_robot("cid").without_robot("bob")


def test_a_robot_of_a_name_that_is_taken_gets_a_number(state):
    grid = state.fleet.maps["cid"]
    more = state.with_robot("cid", grid).with_robot("cid", grid).with_robot("dan", grid)
    assert more.robots == ("ann", "bob", "cid", "cid_2", "cid_3", "dan")


@given(st.text(max_size=90))
def test_a_file_may_be_called_anything_and_its_robot_has_a_name(state, name):
    grid = state.fleet.maps["cid"]
    *_, one, other = state.with_robot(name, grid).with_robot(name, grid).robots
    assert is_name(one)
    assert is_name(other)
    assert one == name or not (is_name(name) and len(name) <= LONGEST_NAME - 3) or name in state.robots


def test_another_anchor_leaves_what_is_known_as_it_is(state):
    rough = state.with_fleet(replace(state.fleet, priors=(FleetPrior("ann", "cid", TurnPrior(0.2)),)))
    turned = rough.anchored("bob")
    assert turned.fleet.anchor == "bob"
    assert turned.fleet.priors == rough.fleet.priors
    assert pair_orders(turned.fleet) == pair_orders(rough.fleet)


def test_a_pair_that_is_opened_and_closed_as_it_was_leaves_the_fleet_as_it_was(state):
    opened = state.with_finding(found(ANN_BOB)).open(ANN_BOB)
    pair = opened.pair(ANN_BOB)
    assert (pair.ref, pair.mov) == (state.fleet.maps["ann"], state.fleet.maps["bob"])
    assert pair.names == RobotNames("ann", "bob")
    closed = opened.closed(pair.known, None)
    assert closed.fleet is state.fleet
    assert closed.finding(ANN_BOB) is not None


def test_what_is_known_of_a_pair_that_is_closed_goes_into_the_fleet(state):
    (seen,) = state.fleet.sightings
    moved = replace(seen.observation, range=seen.observation.range + 0.4)
    rough = InitialPose(Pose2(1.0, 0.0, 0.2)), TurnPrior(0.2), NearPlace(1.0, 2.0, 3.0, 4.0)
    closed = state.open(ANN_BOB).closed((moved, *rough), found(ANN_BOB))
    assert [each.observation for each in closed.fleet.sightings] == [moved]
    assert closed.fleet.priors == tuple(FleetPrior("ann", "bob", each) for each in rough)
    (order,) = pair_orders(closed.fleet)
    assert closed.finding(order).reason == "they agree"
    assert closed.opened is None
    assert closed.pair(order).known == (moved, *rough)
    assert state.open(ANN_BOB).closed((), None).fleet.sightings == ()
    assert closed.open(order).closed((moved,), None).fleet.priors == ()


@given(st.lists(KNOWN, max_size=4))
def test_what_is_known_of_two_robots_outlives_the_coming_and_going_of_others(small_case, known):
    known = (*(one for one in known if isinstance(one, Observation)), *rough_of(known))
    order = PairOrder("ann", "bob", ())
    two = FleetState(Fleet({"ann": small_case.ref, "bob": small_case.mov}))
    told = two.open(order).closed(known, None)
    left = told.with_robot("cid", small_case.ref).anchored("cid").renamed("ann", "eve").without_robot("cid")
    assert left.fleet.anchor == "eve"
    kept = {each for one in pair_orders(left.fleet) for each in left.pair(one).known}
    assert kept == set(known)
    assert {(one.ref, one.mov) for one in pair_orders(left.fleet)} <= {("eve", "bob")}
    assert left.renamed("eve", "ann").fleet.priors == told.fleet.priors


def test_what_was_found_of_a_pair_of_which_nothing_is_known_counts_until_something_is(state):
    order = PairOrder("ann", "cid", ())
    told = state.open(order).closed((), found(order))
    assert told.orders == [ANN_BOB, order]
    assert [each.order for each in told.further] == [order]
    assert {"ann", "cid"} in [set(group) for group in told.groups()]
    renamed = told.renamed("cid", "dan")
    assert [each.order for each in renamed.further] == [PairOrder("ann", "dan", ())]
    assert told.without_robot("cid").further == ()
    known = told.open(PairOrder("cid", "ann", ())).closed((TurnPrior(0.0),), None)
    assert known.further == ()
    assert known.orders == [ANN_BOB, PairOrder("cid", "ann", ())]
    assert state.open(order).closed((), replace(found(order), accepted=False)).further == ()


def test_two_maps_that_a_person_laid_on_each_other_stay_so_in_a_fleet(state):
    order = PairOrder("ann", "cid", ())
    sure = replace(found(order).hypotheses[0], T_ref_mov=Pose2(), weight=9.0)
    laid = state.open(order).closed((), replace(found(order), hypotheses=(sure,)))
    *_, result = run_fleet(laid.fleet, further=laid.further)
    assert result.placed["cid"].array() == pytest.approx([0.0, 0.0, 0.0])


def test_a_pair_is_called_after_what_is_known_of_it(state):
    assert state.pair(ANN_BOB).name == "ann saw bob"
    turned = state.open(PairOrder("cid", "bob", ())).closed((TurnPrior(0.1),), None)
    (order,) = (each for each in pair_orders(turned.fleet) if each.ref == "cid")
    assert turned.pair(order).name == "cid and bob"
    assert turned.pair(order).choice == "turn"
    assert turned.without_robot("bob").fleet.priors == ()


def test_a_new_sighting_of_a_pair_stands_beside_the_others(state):
    (seen,) = state.fleet.sightings
    order = PairOrder("cid", "bob", ())
    assert state.pair(order).choice == "sighting"
    assert not state.pair(order).complete
    closed = state.open(order).closed((seen.observation,), None)
    assert names(closed)[1] == [("ann", "bob"), ("cid", "bob")]


def test_robots_lie_together_as_far_as_pairs_are_found(state):
    assert [set(group) for group in state.groups()] == [{"ann"}, {"bob"}, {"cid"}]
    together, alone = state.with_finding(found(ANN_BOB)).groups()
    assert together == {"ann": Pose2(), "bob": SOMEWHERE}
    assert set(alone) == {"cid"}


def test_robots_and_sightings_are_told_once_all_is_merged(state, strangers):
    (seen,) = state.fleet.sightings
    maps = {**state.fleet.maps, "cid": strangers.mov}
    lie = FleetSighting("ann", "bob", replace(seen.observation, range=seen.observation.range + 5))
    fleet = Fleet(maps, (seen, lie))
    before = FleetState(fleet)
    assert {before.standing(name) for name in before.robots} == {WAITING}
    assert before.mood(0) == ""
    after = replace(before, result=merge_fleet(fleet))
    assert [after.standing(name) for name in after.robots] == [PLACED, PLACED, ALONE]
    assert [after.mood(number) for number in (0, 1)] == [USED, LEFT_OUT]
    assert after.together("ann", "bob")
    assert not after.together("ann", "cid")


def test_a_map_is_hidden_and_shown_again_and_goes_with_its_robot(state):
    hidden = state.toggled("bob")
    assert hidden.hidden == {"bob"}
    assert hidden.toggled("bob").hidden == set()
    assert hidden.renamed("bob", "eve").hidden == {"eve"}
    assert hidden.without_robot("bob").hidden == set()


def test_a_picture_that_follows_robots_stands_still_once_a_person_changes_it(state):
    running = replace(state, live={"ann": RobotState("live", 1.0, 0.2)})
    assert running.toggled("ann").live
    for changed in (
        running.renamed("cid", "dan"),
        running.anchored("bob"),
        running.without_robot("cid"),
        running.open(ANN_BOB),
    ):
        assert not changed.live
