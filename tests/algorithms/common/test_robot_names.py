"""Sentences on two robots tell them by their names, whatever these are; without names they stay."""

from __future__ import annotations

from html import unescape

import pytest
from hypothesis import given
from hypothesis import strategies as st

from algorithms.common.robot_names import UNNAMED, WORDS, RobotNames

BOTH = RobotNames("Bob", "Alice")


@pytest.mark.parametrize(
    ("ours", "told"),
    [
        ("Robot 1 saw robot 2: this place is in both maps.", "Bob saw Alice: this place is in both maps."),
        ("robot 2 would stand 2.1 m away", "Alice would stand 2.1 m away"),
        ("in robot 1's heading", "in Bob's heading"),
        ("Where map 2 lies in map 1.", "Where Alice's map lies in Bob's map."),
        ("map 2's wall, in map 1's frame", "Alice's wall, in Bob's frame"),
        ("map 1: x (m)", "Bob's map: x (m)"),
        ("of the robots' maps, map1 and map2", "of the robots' maps, map1 and map2"),
        ("robot 12, map 1b and bigmap 1", "robot 12, map 1b and bigmap 1"),
    ],
)
def test_the_words_for_two_robots_become_their_names(ours, told):
    assert BOTH.told(ours) == told
    assert UNNAMED.told(ours) == ours


@pytest.mark.parametrize("file", ["'map 1'", '"robot 2"', "(map 2)", "map 1.yaml", "a/map 2.pgm", "map 1-2"])
def test_what_a_file_is_called_stays(file):
    assert BOTH.told(f"It is {file}.") == f"It is {file}."


@given(st.text(max_size=20), st.text(max_size=20))
def test_any_name_stands_there_as_it_is(ref, mov):
    told = RobotNames(ref, mov).told("Robot 1, then robot 2 in map 1.")
    if (ref, mov) == (UNNAMED.ref, UNNAMED.mov):
        assert told == "Robot 1, then robot 2 in map 1."
    else:
        assert told == f"{ref}, then {mov} in {ref}'s map."


@given(st.text(st.characters(exclude_categories=["C", "Z"]), max_size=20))
def test_in_html_a_name_is_a_word_and_no_tag(name):
    told = RobotNames(name, "Alice").told_in_html("<text>robot 1</text>")
    assert unescape(told) == f"<text>{name}</text>"
    assert not set("<>\"'*_`{}[]\\|~").intersection(told.removeprefix("<text>").removesuffix("</text>"))


@given(st.text().filter(lambda text: not WORDS.search(text)))
def test_nothing_else_is_changed(text):
    assert BOTH.told(text) == text


def test_robots_that_are_called_the_other_way_round_change_places_once():
    assert RobotNames("robot 2", "robot 1").told("robot 1 saw robot 2") == "robot 2 saw robot 1"
