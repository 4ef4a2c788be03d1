"""Recordings of every kind, message by message. Damaged ones: test_fuzz."""

from __future__ import annotations

import pytest
from bags import BEGIN, KINDS, SECOND, grid_message, transform_message, write_bag
from drawn import drawn_map

from algorithms.common.pose import Pose2
from algorithms.files.bags.bag_reader import open_bag
from algorithms.files.bags.bag_summary import read_summary
from algorithms.files.bags.message_types import GRID, TRANSFORMS

SMALL = drawn_map(Pose2(), resolution=0.5)


def frames(times):
    return [transform_message("map", "odom", time, (time, 0.0, 0.0)) for time in times]


@pytest.mark.parametrize("kind", KINDS)
def test_the_last_message_before_a_time_is_found_however_long_ago_it_was(tmp_path, kind):
    """A map that was sent once is followed by an hour of other messages."""
    times = [0.5, 100.0, 3600.0]
    path = write_bag(tmp_path, "bag", kind, [grid_message(SMALL, 0.0), *frames(times)])
    with open_bag(path) as bag:
        (grids,), (moves,) = bag.of_type(GRID), bag.of_type(*TRANSFORMS)
        assert (grids.count, moves.count, bag.message_count) == (1, 3, 4)
        assert bag.last(grids, bag.end)[0] == BEGIN
        for until, time in ((3599.0, 100.0), (100.0, 100.0), (99.9, 0.5), (1e6, 3600.0)):
            found, message = bag.last(moves, BEGIN + round(until * SECOND))
            assert found == BEGIN + round(time * SECOND)
            assert message.transforms[0].transform.translation.x == time
        assert bag.last(moves, BEGIN + SECOND // 4) is None
        assert bag.first(moves)[0] == BEGIN + SECOND // 2


def test_messages_come_by_time_within_what_is_asked(tmp_path):
    path = write_bag(tmp_path, "bag", "db3", frames([0.0, 1.0, 2.0, 3.0]))
    with open_bag(path) as bag:
        topics = bag.of_type(*TRANSFORMS)
        got = [time for _, time, _ in bag.messages(topics, BEGIN + SECOND, BEGIN + 3 * SECOND)]
        assert got == [BEGIN + SECOND, BEGIN + 2 * SECOND]
        assert list(bag.messages(())) == []


def test_a_recording_without_messages_is_told_as_one(tmp_path):
    summary = read_summary(write_bag(tmp_path, "bag", "mcap", []))
    assert (summary.messages, summary.topics, summary.length) == (0, (), 0.0)
