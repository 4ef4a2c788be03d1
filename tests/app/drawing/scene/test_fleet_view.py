"""Who saw whom, as lines over a fleet's maps."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from algorithms.common.pose import Pose2
from algorithms.files.case_folder import Case
from algorithms.fleets.fleet_merge import merge_fleet
from algorithms.maps.map_corrections import cropped
from algorithms.observations.fleet import Fleet, FleetSighting
from app.drawing.browser_messages import BrowserMessages
from app.drawing.fleet_layout import lay_out_fleet
from app.drawing.palette import LIGHT
from app.drawing.scene.fleet_view import FleetView, edges_of, nearest_edge
from app.model.fleet_state import LEFT_OUT, USED, FleetState
from app.model.live.robot_state import RobotState
from app.report.replay.image_recorder import PictureScene

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


class Layers(BrowserMessages):
    """Keeps what is drawn over the maps."""

    def __init__(self) -> None:
        super().__init__()
        self.drawn = {}

    def send(self, message):
        self.drawn |= message.get("layers", {})


def show(view: FleetView, state: FleetState):
    """Draw it; where it lies."""
    layout = lay_out_fleet(state.fleet.maps, state.groups())
    view.show(state, layout, edges_of(state, layout), LIGHT)
    return layout


def test_a_map_that_has_grown_takes_the_place_of_the_last_one_without_its_picture_going(merged):
    scene, maps = PictureScene(), merged.fleet.maps
    small = Fleet({**maps, "bob": cropped(maps["bob"])}, merged.fleet.sightings)
    view = FleetView(scene, Layers())
    show(view, FleetState(small))
    handles = list(scene.shown)
    layout = show(view, merged)
    assert scene.shown == handles  # the same pictures, drawn anew
    grid = maps["bob"]
    middle = grid.origin.apply(np.array([grid.width, grid.height]) * grid.resolution / 2)
    walls = handles[-1]
    assert walls.position[:2] == pytest.approx((middle - layout.anchors["bob"]).tolist())
    size = walls.render_width, walls.render_height
    assert size == pytest.approx((grid.width * grid.resolution, grid.height * grid.resolution))


def test_a_robot_that_runs_is_drawn_where_it_drives(merged):
    messages, pose = Layers(), Pose2(1.0, 2.0, 0.5)
    view = FleetView(PictureScene(), messages)
    running = replace(merged, live={"ann": RobotState("live", 1.0, 0.0, pose), "bob": RobotState("waiting")})
    layout = show(view, running)
    messages.flush()
    ann, bob = messages.drawn["robots"]
    assert (ann["s"], ann["t"], bob["s"]) == ("robot", "ann", "none")
    at = layout.poses["ann"] @ pose
    assert ann["p"] == pytest.approx([at.x, at.y])
    assert ann["a"] == pytest.approx(at.theta)
