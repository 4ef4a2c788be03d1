"""Map 2 in a person's hand: the page and the server hold it at one place, whatever overtakes what."""

from __future__ import annotations

from collections.abc import Iterator
from math import radians
from typing import Any

import pytest
import viser
from wire import WireTab, until

from algorithms.common.pose import Pose2
from algorithms.files.case_folder import Case
from app.drawing.scene_layout import SceneLayout, lay_out
from app.model.merge_inputs import MergeInputs
from app.page.application import make_server

X, Y, TURN = "x in map 1 (m)", "y in map 1 (m)", "turn Δθ (°)"
OF_ORIGIN = "T: Δx (m)", "T: Δy (m)", "T: Δθ (°)"


@pytest.fixture(scope="module")
def server(small_case: Case) -> Iterator[viser.ViserServer]:
    server = make_server(port=0, initial=small_case)
    yield server
    server.stop()


@pytest.fixture
def tab(server) -> Iterator[WireTab]:
    tab = WireTab(server.get_port())
    tab.press("Move map 2 by hand")
    until(lambda: tab.state.startswith("By hand"), "map 2 in the hand")
    yield tab
    tab.close()


def shown(tab: WireTab, labels: tuple[str, ...] = (X, Y, TURN)) -> tuple[float, ...]:
    """The numbers beside map 2."""
    return tuple(tab.props[tab.find(label)]["value"] for label in labels)


def numbers(layout: SceneLayout, at: Pose2) -> Any:
    """What the numbers are for map 2 at a place of the scene."""
    x, y = at.xy + layout.anchor_ref
    return pytest.approx((x, y, at.theta / radians(1)), abs=2e-3)


def told(tab: WireTab) -> Pose2:
    """Where the page was last told to put map 2."""
    word = tab.words["maps"]["2"]
    return Pose2(word["x"], word["y"], word["theta"])


@pytest.fixture
def layout(small_case) -> SceneLayout:
    return lay_out(small_case.ref, small_case.mov, MergeInputs.of(small_case).at)


def test_a_step_by_a_key_goes_from_where_the_page_shows_map_2_and_no_word_comes_back(tab, layout):
    before, knew = told(tab), tab.words["maps"]["2"]["placed"]
    for _ in range(3):
        tab.tell("nudge", x=0.5, y=-0.25, theta=radians(1), knew=knew)
    after = Pose2(before.x + 1.5, before.y - 0.75, before.theta + radians(3))
    until(lambda: shown(tab) == numbers(layout, after), "three steps")
    assert tab.words["maps"]["2"]["placed"] == knew


def test_a_step_that_overtakes_the_word_of_a_typed_number_is_added_to_it_and_the_page_put_right(tab, layout):
    x, y, _ = shown(tab)
    knew = tab.words["maps"]["2"]["placed"]
    tab.write(X, x + 20)
    tab.tell("nudge", x=0.0, y=0.5, theta=0.0, knew=knew)
    until(lambda: shown(tab)[:2] == pytest.approx((x + 20, y + 0.5), abs=2e-3), "both")
    until(lambda: shown(tab) == numbers(layout, told(tab)), "the page to be put right")


def test_a_drag_that_overtakes_the_word_of_a_typed_number_counts_and_the_page_is_put_right(tab, layout):
    x, _, _ = shown(tab)
    knew = tab.words["maps"]["2"]["placed"]
    tab.write(X, x + 20)
    tab.tell("put", x=3.0, y=4.0, theta=0.5, knew=knew)
    until(lambda: told(tab) == Pose2(3.0, 4.0, 0.5), "the page to be put right")
    until(lambda: shown(tab) == numbers(layout, Pose2(3.0, 4.0, 0.5)), "the numbers")


def test_a_drag_of_what_the_page_knew_brings_no_word_back(tab, layout):
    knew = tab.words["maps"]["2"]["placed"]
    tab.tell("put", x=3.0, y=4.0, theta=0.5, knew=knew)
    until(lambda: shown(tab) == numbers(layout, Pose2(3.0, 4.0, 0.5)), "the numbers")
    assert tab.words["maps"]["2"]["placed"] == knew


def test_a_typed_turn_leaves_the_two_other_numbers_whatever_they_are_of(tab, layout):
    x, y, _ = shown(tab)
    tab.write(TURN, 30.0)
    until(lambda: told(tab).theta == pytest.approx(radians(30)), "a turn about robot 2")
    assert shown(tab) == pytest.approx((x, y, 30.0))
    assert shown(tab) == numbers(layout, told(tab))

    tab.write("Numbers are of", "the origin of map 2")
    T = layout.transform(told(tab))
    until(lambda: OF_ORIGIN[0] in {props.get("label") for props in tab.props.values()}, "other numbers")
    until(lambda: shown(tab, OF_ORIGIN) == pytest.approx((T.x, T.y, 30.0), abs=2e-3), "where its origin is")
    tab.write(OF_ORIGIN[2], -60.0)
    until(lambda: told(tab).theta == pytest.approx(radians(-60)), "a turn about map 2's origin")
    after = layout.transform(told(tab))
    assert (after.x, after.y) == pytest.approx((T.x, T.y), abs=2e-3)
    assert shown(tab, OF_ORIGIN) == pytest.approx((T.x, T.y, -60.0), abs=2e-3)
