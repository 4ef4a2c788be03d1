"""A robot's newest map: what is taken, what is refused, and when it is stale or gone."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from drawn import poses
from fake_link import FakeLink
from hypothesis import given, settings
from hypothesis import strategies as st

from algorithms.common.errors import InputFileError
from algorithms.common.pose import Pose2
from algorithms.maps.grid_map import GridMap
from app.live.live_frames import LiveFrames
from app.live.map_source import STALE_AFTER, FileSource, SourceState, TopicSource
from app.live.message_fields import grid_message, transforms_message
from app.live.ros_link import TF, Topic, map_topic

SECOND = 1_000_000_000
ROOM = GridMap(np.array([[0, 100, -1], [50, 0, 0]], dtype=np.int8), 0.05, Pose2(1.0, 2.0, 0.5))


class Robot:
    """A robot r1 that publishes, and the source that listens to it."""

    def __init__(self) -> None:
        link = FakeLink()
        self.maps = link.advertise(map_topic("/r1/map"))
        self.tf = link.advertise(Topic("/tf", TF))
        self.fixed = link.advertise(Topic("/tf_static", TF, latched=True))
        self.frames = LiveFrames(link)
        self.source = TopicSource("r1", link, "/r1/map", self.frames, "r1/base")

    def publish(self, frame: str = "r1/map", **changed: Any) -> None:
        fields = grid_message(ROOM, frame, 5 * SECOND)
        fields["info"] = {**fields["info"], **{k: v for k, v in changed.items() if k != "data"}}
        self.maps.send({**fields, **({"data": changed["data"]} if "data" in changed else {})})


@pytest.fixture
def robot():
    return Robot()


def test_the_newest_map_is_taken_and_those_before_it_are_skipped(robot):
    for value in (0, 50, 100):
        robot.publish(data=np.full(6, value))
    robot.source.poll(3.0)
    assert set(robot.source.newest.grid.cells.ravel()) == {100}
    assert (robot.source.newest.frame, robot.source.newest.at) == ("r1/map", 3.0)


def test_a_map_arrives_as_it_was_drawn(robot):
    robot.publish()
    robot.source.poll(0.0)
    grid = robot.source.newest.grid
    np.testing.assert_array_equal(grid.cells, ROOM.cells)
    assert grid.resolution == 0.05  # which no float32 is
    assert grid.origin.array() == pytest.approx(ROOM.origin.array())


@pytest.mark.parametrize(
    ("changed", "said"),
    [
        ({"width": 0, "height": 0, "data": []}, "0 × 0 cells"),
        ({"width": 31623, "height": 31623}, "31623 x 31623"),  # 10⁹ cells, that are not even sent
        ({"width": 4}, "has 6"),
        ({"origin": {"position": {"x": float("nan")}}}, "origin is (nan"),
        ({"origin": {"orientation": {"x": 0.7, "w": 0.7}}}, "tilted"),
        ({"data": [0, 1, 2, 3, 4, 127]}, "a cell of 127"),
        ({"resolution": 0.0}, "resolution is 0"),
        ({"resolution": float("inf")}, "resolution is inf"),
        ({"frame": "r1\x1b[2J"}, "[U+001B]"),
        ({"frame": ""}, "frame is called ''"),
        ({"frame": "m" * 5000}, "frame is called"),
    ],
)
def test_a_message_that_no_file_could_be_is_refused_and_the_map_before_it_stays(robot, changed, said):
    robot.publish()
    robot.source.poll(0.0)
    good = robot.source.newest
    robot.publish(**changed)
    robot.source.poll(1.0)
    assert said in robot.source.refused
    assert robot.source.refused.isprintable()
    assert len(robot.source.refused) < 400
    assert robot.source.newest is good
    robot.publish()
    robot.source.poll(2.0)
    assert robot.source.refused == ""
    assert robot.source.newest.at == 2.0


def test_a_damaged_message_costs_nothing_but_itself(robot):
    robot.publish()
    robot.maps.put(InputFileError("/r1/map", "its message is damaged", "record it again"))
    robot.source.poll(0.0)
    assert robot.source.newest is None  # the newest alone is kept
    assert "damaged" in robot.source.refused


def test_a_robot_waits_lives_is_stale_lives_again_and_goes(robot):
    assert robot.source.state(0.0) == SourceState.WAITING
    robot.publish()
    robot.source.poll(1.0)
    assert robot.source.state(1.0 + STALE_AFTER) == SourceState.LIVE
    assert robot.source.state(1.1 + STALE_AFTER) == SourceState.STALE
    robot.publish()
    robot.source.poll(20.0)
    assert robot.source.state(20.0) == SourceState.LIVE
    robot.maps.leave()
    assert robot.source.state(20.0) == SourceState.GONE
    assert robot.source.newest is not None  # what it has mapped is still there


@given(T_map_odom=poses, T_odom_base=poses)
@settings(max_examples=20, deadline=None)
def test_where_a_robot_is_comes_from_the_transforms_of_its_map(T_map_odom, T_odom_base):
    robot = Robot()
    robot.publish()
    robot.source.poll(0.0)
    robot.fixed.send(transforms_message([("r1/map", "r1/odom", T_map_odom)], 0))
    robot.tf.send(transforms_message([("r1/odom", "r1/base", T_odom_base)], 7 * SECOND))
    robot.frames.poll()
    T = T_map_odom @ T_odom_base
    for found in (robot.source.pose(), robot.source.pose(7 * SECOND)):
        np.testing.assert_allclose(found.xy, T.xy, atol=1e-6)
    with pytest.raises(InputFileError, match="missing at this time"):
        robot.source.pose(20 * SECOND)


@given(stamps=st.lists(st.integers(0, 2**31 - 1), min_size=1, max_size=40))
@settings(max_examples=20, deadline=None)
def test_a_robot_whose_clock_is_wrong_takes_no_transform_from_another(stamps):
    robot = Robot()
    robot.publish()
    robot.source.poll(0.0)
    robot.tf.send(transforms_message([("r1/map", "r1/base", Pose2(1.0, 2.0))], 7 * SECOND))
    for stamp in stamps:
        robot.tf.send(transforms_message([("r2/map", "r2/base", Pose2())], stamp * SECOND))
    robot.frames.poll()
    assert robot.source.pose(7 * SECOND).x == pytest.approx(1.0)


def test_before_its_first_map_a_robot_is_nowhere(robot):
    with pytest.raises(InputFileError, match="no map yet"):
        robot.source.pose()


def test_a_map_of_a_file_is_there_from_the_beginning():
    source = FileSource("r2", ROOM, "r2/map")
    source.poll(0.0)
    assert source.newest.grid is ROOM
    assert source.state(1e6) == SourceState.LIVE
    with pytest.raises(InputFileError, match="from a file"):
        source.pose()
