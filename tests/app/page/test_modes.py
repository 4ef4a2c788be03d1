"""Of the modes of a page at most one is on, and what ends is told so once."""

from __future__ import annotations

from unittest.mock import Mock

import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.page.modes import Mode, ModeSwitch


@given(st.lists(st.integers(-1, 2), max_size=30))
def test_every_mode_that_was_entered_is_ended_once_before_another_is_on(steps):
    switch, ended = ModeSwitch(), []
    modes = [switch.add(Mode(lambda k=k: ended.append(k))) for k in range(3)]
    entered = []
    for step in steps:
        if step < 0:
            switch.close()
        elif switch.current is not modes[step]:
            switch.enter(modes[step])
            entered.append(step)
    on = [] if switch.current is None else [modes.index(switch.current)]
    assert ended + on == entered


def test_leaving_puts_back_what_was_there_and_closing_does_not():
    switch, back = ModeSwitch(), Mock()
    mode = switch.add(Mode(Mock(), leave=back))
    switch.enter(mode)
    assert switch.close() is mode
    back.assert_not_called()
    switch.enter(mode)
    switch.enter(switch.add(Mode(Mock())))
    back.assert_called_once_with()


@pytest.mark.parametrize("asked", [True, False])
def test_a_snapshot_switches_on_the_mode_that_it_asks_for(asked):
    switch, seen = ModeSwitch(), []

    def resume(snapshot, was_on):
        seen.append((snapshot, was_on))
        return asked

    mode = switch.add(Mode(Mock(), resume=resume))
    assert switch.resume("snapshot", mode) is asked
    assert seen == [("snapshot", True)]
