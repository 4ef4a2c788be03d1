"""How robots that run do, in words."""

from __future__ import annotations

import pytest

from app.model.live.robot_state import RobotState, clock


@pytest.mark.parametrize(
    ("state", "said", "mood"),
    [
        (RobotState("waiting"), "no map yet", "idle"),
        (RobotState("live", 1.04, 0.4), "live, 1.0 maps/s, the last 0 s ago", "accepted"),
        (RobotState("stale", 0.0, 12.3), "stale for 12 s; its last map stays", "bent"),
        (RobotState("gone", 0.0, 40.0), "gone; its last map, 40 s old, stays", "refused"),
        (RobotState("file"), "its map is from a file", "idle"),
    ],
)
def test_a_robot_says_how_it_does(state, said, mood):
    assert (state.told, state.mood) == (said, mood)


def test_times_are_told_in_minutes_and_seconds():
    assert [clock(each) for each in (0.0, 9.9, 65.0, 3600.0)] == ["0:00", "0:09", "1:05", "60:00"]
