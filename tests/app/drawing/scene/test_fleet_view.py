"""Who saw whom, as lines over a fleet's maps."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from algorithms.files.case_folder import Case
from algorithms.fleets.fleet_merge import merge_fleet
from algorithms.observations.fleet import Fleet, FleetSighting
from app.drawing.fleet_layout import lay_out_fleet
from app.drawing.scene.fleet_view import edges_of, nearest_edge
from app.model.fleet_state import LEFT_OUT, USED, FleetState

FARTHER = 5.0  # metres that the lie is off


@pytest.fixture(scope="module")
def merged(small_case: Case) -> FleetState:
    """Ann saw Bob truly, and once not."""
    (o,) = small_case.observations
    lie = replace(o, range=o.range + FARTHER)
    seen = FleetSighting("ann", "bob", o), FleetSighting("ann", "bob", lie)
    fleet = Fleet({"ann": small_case.ref, "bob": small_case.mov}, seen)
    return FleetState(fleet, result=merge_fleet(fleet))


def test_a_true_sighting_is_as_long_as_its_range_and_a_lie_as_long_as_it_claims(merged, small_case):
    (o,) = small_case.observations
    true, lie = edges_of(merged, lay_out_fleet(merged.fleet.maps, merged.groups()))
    assert (true.mood, lie.mood) == (USED, LEFT_OUT)
    assert np.hypot(*(true.ends[1] - true.ends[0])) == pytest.approx(o.range, abs=0.2)
    assert np.hypot(*(lie.ends[1] - lie.ends[0])) == pytest.approx(o.range + FARTHER, abs=1e-6)


def test_a_hidden_robot_takes_its_lines_along(merged):
    hidden = merged.toggled("bob")
    assert edges_of(hidden, lay_out_fleet(merged.fleet.maps, merged.groups())) == []


def test_a_click_finds_the_line_that_it_is_near_to(merged):
    edges = edges_of(merged, lay_out_fleet(merged.fleet.maps, merged.groups()))
    true, lie = edges
    assert nearest_edge(edges, lie.ends[1], within=0.5) is lie
    assert nearest_edge(edges, true.ends.mean(axis=0), within=0.5) is true
    assert nearest_edge(edges, lie.ends[1] + 3.0, within=0.5) is None
    assert nearest_edge([], np.zeros(2), within=9.0) is None
