"""Recordings of every kind, message by message; damaged ones."""

from __future__ import annotations

from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory

import pytest
from bags import BEGIN, KINDS, SECOND, grid_message, transform_message, write_bag
from drawn import drawn_map
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from algorithms.common.errors import MapMergeError
from algorithms.common.pose import Pose2
from algorithms.files.bags.bag_path import BagPath
from algorithms.files.bags.bag_reader import GRID, TRANSFORMS, open_bag
from algorithms.files.bags.bag_summary import read_summary
from algorithms.files.bags.map_messages import read_bag_map

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


@cache
def whole(kind):
    """Suffix and bytes of a recording of one file."""
    with TemporaryDirectory() as folder:
        path = write_bag(Path(folder), kind, kind, [*frames([0.0, 1.0]), grid_message(SMALL, 2.0)])
        (file,) = [path] if path.is_file() else path.glob(f"*.{kind}")
        return file.suffix, file.read_bytes()


@pytest.mark.parametrize("kind", ["ros1", "db3", "mcap"])
@settings(max_examples=60, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(data=st.data())
def test_a_damaged_recording_is_read_or_refused_in_a_line(tmp_path, kind, data):
    """Cut off anywhere, or with bytes of it changed."""
    suffix, content = whole(kind)
    spoilt = bytearray(content[: data.draw(st.integers(16, len(content)))])
    for at, value in data.draw(
        st.lists(st.tuples(st.integers(9, len(spoilt) - 1), st.integers(0, 255)), max_size=8)
    ):
        spoilt[at] = value
    path = tmp_path / f"bag{suffix}"
    path.write_bytes(spoilt)
    for read in (read_summary, lambda path: read_bag_map(BagPath(path))):
        said = ""
        try:
            read(path)
        except MapMergeError as error:
            said = str(error)
        assert said.count("\n") == 0
        assert said == "" or path.name in said or said.startswith("bag: ")
