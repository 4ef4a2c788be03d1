"""The folder "By hand": what is typed arrives in metres and radians; what is shown is not taken for it."""

from __future__ import annotations

from dataclasses import replace
from math import degrees, radians
from queue import Empty, Queue

import numpy as np
import pytest
from controls import Controls
from strangers import PATIENCE, Visitor

from algorithms.common.pose import Pose2
from algorithms.common.robot_names import RobotNames
from algorithms.methods.registry import DEFAULT_METHOD, METHODS
from algorithms.verdict.decision import Outcome
from app.page.editing.transform_panel import TransformPanel, weighed_html

DEFAULTS = METHODS[DEFAULT_METHOD].defaults
BEGIN, REFINE, SNAP = "Move map 2 by hand", "Refine from here", "Snap to proven optimum"
TAKE, LEAVE = "Take this as the answer", "Leave it as it was"
ABOUT = "Numbers are of"
FIELDS = ("x in map 1 (m)", "y in map 1 (m)", "turn Δθ (°)")
OF_ORIGIN = ("T: Δx (m)", "T: Δy (m)", "T: Δθ (°)")
SEEN, MIDDLE, ORIGIN = "robot 2, where it was seen", "the middle of map 2", "the origin of map 2"


class Hand:
    """A panel, its controls, and what was asked for with them."""

    def __init__(self, gui) -> None:
        self.asked: Queue[tuple[object, ...]] = Queue()
        self.controls = Controls(gui)
        self.panel = TransformPanel(self.controls)
        ask = lambda name: lambda *value: self.asked.put((name, *value))  # noqa: E731
        self.panel.connect(
            ask("toggle"),
            lambda *typed: self.asked.put(typed),
            *(ask(each) for each in ("refine", "snap", "take", "about")),
        )

    def shown(self) -> set[str]:
        """Labels of the controls that can be seen."""
        begin = self.controls.find(BEGIN)
        others = {name for name in (ABOUT, *FIELDS, REFINE, SNAP, TAKE) if self.controls.find(name).visible}
        return others | {begin.label}

    def field(self, name: str) -> float:
        return self.controls.find(name).value


@pytest.fixture
def hand(stock):
    return Hand(stock.server.gui)


def test_it_is_offered_only_where_there_is_something_to_move(hand):
    (folder,) = hand.controls.of_kind("folder")
    assert not folder.visible
    hand.panel.offer(True)
    assert folder.visible
    hand.panel.offer(False)
    assert not folder.visible


@pytest.mark.parametrize("refine", [False, True])
@pytest.mark.parametrize("prove", [False, True])
def test_what_a_method_cannot_do_has_no_button(hand, refine, prove):
    assert hand.shown() == {BEGIN}
    hand.panel.open(True, refine, prove)
    usual = {LEAVE, TAKE, ABOUT, *FIELDS}
    assert hand.shown() == usual | ({REFINE} if refine else set()) | ({SNAP} if prove else set())
    hand.panel.open(False, refine, prove)
    assert hand.shown() == {BEGIN}


def test_each_button_asks_for_its_own(hand):
    for label, wanted in ((BEGIN, "toggle"), (REFINE, "refine"), (SNAP, "snap"), (TAKE, "take")):
        hand.controls.press(label)
        assert hand.asked.get(timeout=PATIENCE) == (wanted,)
    assert hand.asked.empty()


def test_a_transform_is_shown_in_metres_and_degrees_and_not_taken_for_what_was_typed(hand):
    hand.panel.show(Pose2(1.23456, -2.0, radians(33.3)), np.array([7.0, 8.12349]))
    assert [hand.field(name) for name in FIELDS] == [7.0, 8.123, pytest.approx(33.3)]
    with pytest.raises(Empty):
        hand.asked.get(timeout=0.3)


def test_the_numbers_are_of_robot_2_or_of_map_2s_origin_and_say_so(stock, hand):
    hand.panel.open(True)
    about = hand.controls.find(ABOUT)
    assert (about.options, about.value) == ((SEEN, ORIGIN), SEEN)
    visitor = Visitor(stock)
    visitor.write(about, value=ORIGIN)
    assert hand.asked.get(timeout=PATIENCE) == ("about",)
    visitor.socket.close()
    assert hand.panel.of_origin
    hand.panel.show(Pose2(1.23456, -2.0, radians(33.3)), np.array([7.0, 8.12349]))
    assert [hand.field(name) for name in FIELDS] == [1.235, -2.0, pytest.approx(33.3)]
    assert tuple(hand.controls.find(name).label for name in FIELDS) == OF_ORIGIN
    hand.panel.offer(True, RobotNames("Bob", "Alice"))
    assert about.options == ("Alice, where it was seen", "the origin of Alice's map")
    assert about.value == about.options[1]
    visitor = Visitor(stock)
    visitor.write(about, value=about.options[0])
    assert hand.asked.get(timeout=PATIENCE) == ("about",)
    visitor.socket.close()
    hand.panel.show(Pose2(), np.zeros(2))
    assert hand.controls.find(FIELDS[0]).label == "x in Bob's map (m)"


def test_where_nobody_saw_robot_2_the_numbers_are_of_the_middle_of_its_map(hand):
    hand.panel.open(True, seen=False)
    about = hand.controls.find(ABOUT)
    assert (about.options, about.value) == ((MIDDLE, ORIGIN), MIDDLE)


def test_what_a_person_types_arrives_as_it_was_meant_in_metres_and_radians(stock, hand):
    hand.panel.open(True)
    visitor = Visitor(stock)
    for label, typed, wanted in (
        (FIELDS[0], 2.5, ("x", 2.5)),
        (FIELDS[1], -7.25, ("y", -7.25)),
        (FIELDS[2], 90.0, ("theta", radians(90.0))),
    ):
        visitor.write(hand.controls.find(label), value=typed)
        assert hand.asked.get(timeout=PATIENCE) == wanted
    visitor.socket.close()


def test_what_the_walls_say_is_shown_while_the_map_is_in_hand(hand):
    hand.panel.tell("<b>agrees</b>")
    assert "agrees" not in hand.controls.text()
    hand.panel.open(True)
    assert "<b>agrees</b>" in hand.controls.text()


def test_the_walls_are_told_in_the_numbers_of_the_verdict(result):
    told = weighed_html(result, DEFAULTS, None)
    verdict = result.verdict
    for number in (
        f"{result.value:.1f}",  # metres of wall that agree
        f"{verdict.rigid_contradiction:.1%}",
        f"{verdict.shared_wall:.1f} m",
        f"{verdict.deviation:.1f} σ",
    ):
        assert f">{number}<" in told, number
    refused = replace(verdict, accepted=False, outcome=Outcome.REFUSED, probability=0.02)
    other = weighed_html(replace(result, verdict=refused), DEFAULTS, None)
    assert "2.0%" in other
    assert other.split("<table")[0] != told.split("<table")[0]  # another sentence, another colour


def test_how_far_the_hand_is_from_what_the_method_found_is_measured_at_the_seen_robot(result):
    """Turned on the spot by 5° and put 0.3 m beside it: not what the frames' origins say."""
    at = Pose2(*result.pivot.tolist())
    turn = radians(5.0)
    moved = Pose2(0.3, 0.0) @ result.T_ref_mov @ at @ Pose2(theta=turn) @ at.inverse()
    told = weighed_html(result, DEFAULTS, moved)
    assert f"0.30 m, {degrees(turn):.1f}°" in told
    assert "off the method" not in weighed_html(result, DEFAULTS, None)


@pytest.mark.parametrize("value", [None, float("-inf")])
def test_a_method_whose_objective_says_nothing_has_no_line_for_it(result, value):
    without = weighed_html(replace(result, value=value), DEFAULTS, None)
    assert without.count("<tr") == weighed_html(result, DEFAULTS, None).count("<tr") - 1
    assert "inf" not in without
