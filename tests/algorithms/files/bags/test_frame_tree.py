"""Where frames were at a time: chains, interpolation, gaps, clocks."""

from __future__ import annotations

import numpy as np
import pytest
from bags import BEGIN, SECOND, level, transform_message, write_bag
from drawn import poses
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from algorithms.common.errors import InputFileError
from algorithms.common.pose import Pose2, pose_error
from algorithms.files.bags.bag_reader import open_bag
from algorithms.files.bags.frame_tree import frames_around


def tree(folder, messages, at, kind="mcap"):
    """The frames of a recording at so many seconds."""
    with open_bag(write_bag(folder, "bag", kind, messages)) as bag:
        return frames_around(bag, BEGIN + round(at * SECOND))


def now(at):
    return BEGIN + round(at * SECOND)


@settings(max_examples=12, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(first=poses, second=poses, third=poses)
def test_a_chain_of_transforms_is_their_product_in_any_direction(tmp_path_factory, first, second, third):
    messages = [
        transform_message("map", "odom", 0.0, *level(first)),
        transform_message("odom", "base_link", 0.0, *level(second)),
        transform_message("base_link", "laser", 0.0, *level(third), topic="/tf_static"),
    ]
    frames = tree(tmp_path_factory.mktemp("bag"), messages, 0.0)
    found = frames.pose("map", "laser", now(0.0))
    assert pose_error(found, first @ second @ third, np.array([1.0, 2.0])) == pytest.approx((0, 0), abs=1e-6)
    back = frames.pose("laser", "map", now(0.0))
    assert pose_error(found @ back, Pose2(), np.array([1.0, 2.0])) == pytest.approx((0, 0), abs=1e-6)
    beside = frames.pose("odom", "base_link", now(0.0))
    assert pose_error(beside, second, np.array([1.0, 2.0])) == pytest.approx((0, 0), abs=1e-6)


@given(share=st.floats(0, 1), turn=st.floats(-3.1, 3.1))
@settings(max_examples=12, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
def test_between_two_transforms_a_robot_moves_and_turns_evenly(tmp_path_factory, share, turn):
    start, end = Pose2(1.0, 2.0, 3.0), Pose2(2.0, 0.0, 3.0 + turn)
    messages = [
        transform_message("map", "base_link", at, *level(pose)) for at, pose in ((1.0, start), (2.0, end))
    ]
    found = tree(tmp_path_factory.mktemp("bag"), messages, 1.5).pose("map", "base_link", now(1 + share))
    expected = Pose2.from_array([1.0 + share, 2.0 - 2 * share, 3.0 + share * turn])
    assert pose_error(found, expected, np.zeros(2)) == pytest.approx((0, 0), abs=1e-6)


def test_a_gap_and_a_frame_that_is_not_there_are_named(tmp_path):
    messages = [transform_message("map", "odom", at, (0, 0, 0)) for at in (0.0, 1.0, 4.0)] + [
        transform_message("odom", "base_link", at / 10, (0, 0, 0)) for at in range(50)
    ]
    frames = tree(tmp_path, sorted(messages, key=lambda each: each.at), 2.5)
    assert frames.pose("map", "base_link", now(0.5)) == Pose2()
    assert frames.pose("map", "base_link", now(1.4)) == Pose2()  # a moment after the last one still holds
    with pytest.raises(InputFileError, match=r"map → odom is missing at this time: .* 1\.5 s"):
        frames.pose("map", "base_link", now(2.5))
    with pytest.raises(InputFileError, match=r"no frame robot1/map .* its frames: base_link, map, odom"):
        frames.pose("robot1/map", "base_link", now(0.5))


def test_frames_that_nothing_ties_together_are_named_with_their_roots(tmp_path):
    messages = [transform_message("map", "odom", 0.0, (0, 0, 0)), transform_message("b", "c", 0.0, (0, 0, 0))]
    with pytest.raises(InputFileError, match=r"no transform ties c \(below b\) to map \(below map\)"):
        tree(tmp_path, messages, 0.0).pose("map", "c", now(0.0))


def test_a_robot_that_lies_on_its_side_has_no_place_in_a_map(tmp_path):
    side = (0.7071, 0.0, 0.0, 0.7071)
    messages = [transform_message("map", "base_link", 0.0, (0, 0, 0), side)]
    with pytest.raises(InputFileError, match="tilted"):
        tree(tmp_path, messages, 0.0).pose("map", "base_link", now(0.0))


def test_transforms_that_are_none_and_circles_do_no_harm(tmp_path):
    messages = [
        transform_message("a", "b", 0.0, (0, 0, 0)),
        transform_message("b", "a", 0.1, (0, 0, 0)),
        transform_message("a", "a", 0.2, (0, 0, 0)),
        transform_message("a", "c", 0.3, (float("nan"), 0, 0)),
        transform_message("a", "c", 0.4, (1, 0, 0), (0, 0, 0, 0)),
    ]
    frames = tree(tmp_path, messages, 0.0)
    assert frames.frames == ("a", "b")
    assert frames.pose("a", "b", now(0.0)) == Pose2()


def test_a_robots_clock_that_began_at_0_and_runs_at_half_speed_is_followed(tmp_path):
    """A simulation: half a second of it each second of the recorder's."""
    messages = [
        transform_message("map", "base_link", float(at), (float(at), 0.0, 0.0), stamp=at / 2 - BEGIN / SECOND)
        for at in range(200)
    ]
    with open_bag(write_bag(tmp_path, "bag", "db3", messages)) as bag:
        time = round(60.25 * SECOND)
        pose = frames_around(bag, time).pose("map", "base_link", time)
    assert pose.x == pytest.approx(120.5)
