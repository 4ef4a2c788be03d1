"""The view, the colours and what a click reads out."""

from __future__ import annotations

from types import SimpleNamespace
from unittest.mock import Mock

import numpy as np
import pytest
from tabs import event, noting_tab

from app.model.view_modes import HEIGHTS, MAP, SWARM
from app.page.modes import Mode
from app.page.view_controller import ViewController


@pytest.fixture
def tab(inputs):
    return noting_tab(inputs)


@pytest.fixture
def client():
    return Mock()


@pytest.fixture
def views(tab, client) -> ViewController:
    return ViewController(tab, client)


def click(client, origin, direction):
    """A click whose ray goes from there in this direction."""
    client.scene.on_click()
    read_out = client.scene.on_click.return_value.call_args.args[0]
    read_out(SimpleNamespace(ray_origin=origin, ray_direction=direction))


def test_a_click_reads_out_the_place_where_its_ray_meets_the_floor(views, tab, client):
    # viser's own scene is turned by half a turn about the y axis
    click(client, (-2.0, 3.0, 10.0), (0.1, 0.2, 1.0))
    (place, run), _ = tab.display.views.map.read_out.call_args
    assert place == pytest.approx([2.0 + 0.1 * 10, 3.0 - 0.2 * 10])
    assert run is tab.state.run


@pytest.mark.parametrize(
    ("view", "direction"),
    [(HEIGHTS, (0.0, 0.0, 1.0)), (MAP, (1.0, 0.0, 0.0)), (MAP, (1.0, 0.0, 1e-9)), (MAP, (np.nan, 0.0, 1.0))],
    ids=["another view", "along the floor", "far away", "nowhere"],
)
def test_a_click_that_meets_no_floor_of_the_map_reads_nothing(views, tab, client, view, direction):
    tab.state.view = view
    click(client, (0.0, 0.0, 10.0), direction)
    tab.display.views.map.read_out.assert_not_called()


def test_a_mode_draws_the_map_by_itself(views, tab):
    redraw = Mock()
    tab.modes.enter(tab.modes.add(Mode(Mock(), redraw=redraw)))
    views.choose(SWARM)
    assert tab.state.view == SWARM
    tab.display.show_view.assert_called_once_with(redraw)


def test_dark_colours_reach_what_is_drawn_and_who_subscribed(views, tab):
    seen = []
    tab.state.subscribe("palette", lambda: seen.append(tab.state.palette.dark))
    views.darken(True)
    views.darken(False)
    assert seen == [True, False]
    assert tab.display.recolour.call_count == 2


def test_maps_are_compared_in_the_map_alone_and_stay_in_the_hand(views, tab):
    compare = event(tab, "compare")
    compare(mode="blink")
    assert tab.display.views.run.show.called
    tab.display.views.run.show.reset_mock()
    tab.state.hand = Mock()
    compare(mode="curtain")
    tab.display.views.run.show.assert_not_called()
    tab.state.view = HEIGHTS
    tab.display.views.comparison.choose.reset_mock()
    compare(mode="blink")
    tab.display.views.comparison.choose.assert_not_called()
