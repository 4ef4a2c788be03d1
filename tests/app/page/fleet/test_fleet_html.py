"""The lists of a fleet, as HTML."""

from __future__ import annotations

from dataclasses import replace

import pytest

from algorithms.files.case_folder import Case
from algorithms.fleets.fleet_merge import merge_fleet
from algorithms.fleets.pair_hypotheses import pair_orders
from algorithms.observations.fleet import Fleet, FleetSighting
from app.model.fleet_state import FleetState
from app.model.live.robot_state import RobotState
from app.page.fleet.fleet_html import pairs_html, poses_html, robots_html

EVIL = "<script>alert(1)<b>"


@pytest.fixture(scope="module")
def state(small_case: Case) -> FleetState:
    (o,) = small_case.observations
    lie = replace(o, range=o.range + 5)
    seen = FleetSighting("ann", EVIL, o), FleetSighting("ann", EVIL, lie)
    return FleetState(Fleet({"ann": small_case.ref, EVIL: small_case.mov}, seen))


@pytest.fixture(scope="module")
def merged(state: FleetState) -> FleetState:
    return replace(state, result=merge_fleet(state.fleet))


def test_a_name_is_shown_as_words_and_never_run(state, merged):
    for each in (state, merged):
        orders = pair_orders(each.fleet)
        for html in (robots_html(each, "ann"), pairs_html(each, orders), poses_html(each)):
            assert "<script" not in html


def test_a_robot_says_what_became_of_it_and_whether_it_is_shown(state, merged):
    assert "placed" not in robots_html(state, "ann")
    assert "placed" in robots_html(merged, "ann")
    assert robots_html(merged.toggled("ann"), "ann").count('aria-pressed="false" title="Show') == 1


def test_a_sighting_that_is_left_out_says_how_far_off_it_is(state, merged):
    orders = pair_orders(state.fleet)
    assert pairs_html(state, orders).count("not merged yet") == 2
    said = pairs_html(merged, orders)
    assert said.count('data-mood="accepted"') == 1
    assert said.count("left out: ") == 1
    assert " m off" in said


def test_without_a_sighting_one_is_told_what_a_merge_does(state):
    assert "looks for where their walls agree" in pairs_html(state, [])


def test_a_robot_that_runs_says_how_it_does_also_before_it_has_a_map(merged):
    how = {
        "ann": RobotState("stale", 0.0, 12.0),
        EVIL: RobotState("live", 1.0, 0.2),
        "new": RobotState("waiting"),
    }
    html = robots_html(replace(merged, live=how), "ann")
    assert "stale for 12 s" in html
    assert "live, 1.0 maps/s" in html
    assert "<b>new</b><em" in html
    assert "maps/s" not in robots_html(merged, "ann")
