"""What a tab is told of two robots has their names in it, once, and only where it is news."""

from __future__ import annotations

from typing import Any

from algorithms.common.robot_names import UNNAMED, RobotNames
from app.drawing.browser_messages import BrowserMessages

SAW = "Robot 1 saw robot 2: this place is in both maps."
SWAPPED = RobotNames("robot 2", "robot 1")


class Kept(BrowserMessages):
    """Keeps what would be sent."""

    def __init__(self) -> None:
        super().__init__()
        self.sent: list[dict[str, Any]] = []

    def send(self, message: dict[str, Any]) -> None:
        self.sent.append(message)


def test_words_above_the_map_and_signs_on_it_name_the_robots():
    tab = Kept()
    tab.names = RobotNames("Bob", "Alice")
    tab.hud(state=SAW, case="robot 1 saw robot 2", legend=[{"s": "square", "t": "map 1"}, {"s": "scale"}])
    tab.layer("robots", [{"k": "mark", "t": "robot 2"}, {"k": "path"}])
    tab.flush()
    (message,) = tab.sent
    assert message["hud"]["state"] == "Bob saw Alice: this place is in both maps."
    assert message["hud"]["case"] == "robot 1 saw robot 2"  # is what a person calls it
    assert message["hud"]["legend"] == [{"s": "square", "t": "Bob's map"}, {"s": "scale"}]
    assert message["layers"]["robots"] == [{"k": "mark", "t": "Alice"}, {"k": "path"}]


def test_other_names_are_news_and_the_same_words_are_not():
    tab = Kept()
    for names in (UNNAMED, UNNAMED, RobotNames("Bob", "Alice"), UNNAMED):
        tab.names = names
        tab.hud(state=SAW)
        tab.flush()
    assert [each["hud"]["state"].split(":")[0] for each in tab.sent] == [
        "Robot 1 saw robot 2",
        "Bob saw Alice",
        "Robot 1 saw robot 2",
    ]


def test_what_was_said_can_be_said_again_though_robots_are_called_the_other_way_round():
    tab = Kept()
    tab.names = SWAPPED
    tab.hud(state=SAW)
    tab.hud(state="Reading a file.")
    tab.hud(state=SAW)
    shown = tab.said("state")
    tab.hud(state="Reading a file.")
    tab.hud(**shown)
    tab.flush()
    assert tab.sent[-1]["hud"]["state"] == "robot 2 saw robot 1: this place is in both maps."
