"""Robots by a rosbridge server, against a small one of ours."""

from __future__ import annotations

import socket
import time

import numpy as np
import pytest
from explorers import SearchNow, exploration
from rosbridge_server import rosbridge

from algorithms.common.errors import InputFileError, SettingError
from algorithms.common.pose import Pose2, pose_error
from algorithms.files.bags.frame_tree import stamp_of
from algorithms.maps.grid_map import GridMap
from app.live import rosbridge_link
from app.live.live_fleet_file import read_live_fleet
from app.live.live_frames import LiveFrames
from app.live.live_publisher import MAP, LivePublisher
from app.live.live_run import LiveRun
from app.live.map_source import SourceState, TopicSource
from app.live.message_fields import grid_message
from app.live.ros_link import map_topic
from app.live.simulation import fleet_text, messages_of

ROOM = GridMap(np.array([[0, 100, -1], [50, 0, 0]], dtype=np.int8), 0.05, Pose2(1.0, 2.0, 0.5))
JSON = rosbridge_link.as_json


def awaited(what):
    """What it says, once it says anything."""
    end = time.monotonic() + 30
    while not (found := what()) and time.monotonic() < end:
        time.sleep(0.01)
    return found


@pytest.fixture
def server():
    with rosbridge() as (made, address):
        link = rosbridge_link.RosbridgeLink(address)
        yield made, link
        link.close()


def test_a_map_of_ros_1_arrives_as_it_was_drawn(server):
    robots, link = server
    maps = link.subscribe(map_topic("/map"))
    fields = JSON(grid_message(ROOM, "map", 5_000_000_007))
    for stamp in (fields["header"]["stamp"], fields["info"]["map_load_time"]):
        del stamp["sec"], stamp["nanosec"]
    assert set(fields["header"]["stamp"]) == {"secs", "nsecs"}
    robots.publish("/map", fields)
    (message,) = awaited(maps.take)
    np.testing.assert_array_equal(message.data, ROOM.cells.ravel())
    assert stamp_of(message.header) == 5_000_000_007
    asked = awaited(lambda: robots.operations("subscribe"))[0]
    assert (asked["topic"], asked["type"]) == ("/map", "nav_msgs/OccupancyGrid")
    assert asked["throttle_rate"] == 1000


@pytest.mark.parametrize(
    "wrong",
    [
        {"info": {"width": 0}},
        {"info": {"width": -3, "height": 2}},
        {"info": {"width": 31623, "height": 31623}},
        {"data": "no numbers"},
        {"data": [1, None, 500]},
        {"info": {"origin": {"position": {"x": None}}}},
        {"header": 3},
        [1, 2, 3],
    ],
)
def test_a_message_that_no_file_could_be_is_refused_and_the_next_map_is_taken(server, wrong):
    robots, link = server
    source = TopicSource("r1", link, "/map", LiveFrames(link), "base")
    good = JSON(grid_message(ROOM, "map", 0))
    bad = (
        good | {k: good[k] | v if isinstance(v, dict) else v for k, v in dict(wrong).items()}
        if isinstance(wrong, dict)
        else wrong
    )
    robots.publish("/map", bad)

    def refused():
        source.poll(0.0)
        return source.refused

    if isinstance(wrong, dict):  # else the library itself throws it away
        assert awaited(refused)
    robots.publish("/map", good)

    def taken():
        source.poll(1.0)
        return source.newest

    assert awaited(taken)
    assert source.refused == ""


def test_a_server_that_goes_is_told_as_gone(server):
    robots, link = server
    source = TopicSource("r1", link, "/map", LiveFrames(link), "base")
    robots.publish("/map", JSON(grid_message(ROOM, "map", 0)))

    def taken():
        source.poll(1.0)
        return source.newest

    assert awaited(taken)
    assert source.state(1.0) == SourceState.LIVE
    for client in robots.connections:
        client.close()
    assert awaited(lambda: source.state(1.0) == SourceState.GONE)


def test_simulated_robots_by_rosbridge_end_in_one_map_that_is_published_there(server, tmp_path):
    robots, link = server
    drives = exploration()
    (tmp_path / "fleet.yaml").write_text(
        fleet_text(drives.names).replace("{topic", "{rosbridge: 'ws://r', topic")
    )
    fleet = read_live_fleet(tmp_path)
    assert {robot.bridge for robot in fleet.robots.values()} == {"ws://r"}
    run, publisher = LiveRun(fleet, lambda address: link, SearchNow()), LivePublisher(link)
    awaited(lambda: len(robots.operations("subscribe")) >= 3 + 2 + 6)
    for scan in range(drives.scans + 1):
        for topic, fields in messages_of(drives, scan, scan * 500_000_000):
            if "/scan" not in topic.name:
                robots.publish(topic.name, JSON(fields))
        time.sleep(0.02)
        publisher.publish(run, run.step(float(scan)).answer, float(scan))
    for extra in range(1, 50):
        publisher.publish(run, run.step(float(drives.scans + extra)).answer, float(drives.scans + extra))
        if len(run.answer.placed) == 3 and "/tf_static" in robots.sent:
            break
        time.sleep(0.05)
    assert set(run.answer.placed) == {"r1", "r2", "r3"}
    for name, T in run.answer.placed.items():
        truth = drives.true_transform(name, drives.scans)
        assert pose_error(T, truth, drives.pose(name, drives.scans).xy)[0] < 0.3
    assert awaited(lambda: len(robots.sent["/tf_static"][-1]["transforms"]) == 2)
    assert awaited(lambda: MAP in robots.sent)
    (latched,) = {each["latch"] for each in robots.operations("advertise") if each["topic"] == MAP}
    assert latched


@pytest.mark.parametrize("address", ["http://robot:9090", "robot", "ws://"])
def test_an_address_that_is_none_is_told(address):
    with pytest.raises(SettingError, match="is no address"):
        rosbridge_link.RosbridgeLink(address)


def test_a_server_that_is_not_there_is_told_in_a_line(monkeypatch):
    monkeypatch.setattr(rosbridge_link, "ANSWER_WITHIN", 0.5)
    with socket.create_server(("127.0.0.1", 0)) as nobody:
        port = nobody.getsockname()[1]
    with pytest.raises(SettingError, match="nobody answers"):
        rosbridge_link.RosbridgeLink(f"ws://127.0.0.1:{port}")


def test_a_damaged_message_names_its_topic(server):
    robots, link = server
    maps = link.subscribe(map_topic("/map"))
    awaited(lambda: robots.operations("subscribe"))
    robots.publish("/map", {"data": [None]})
    (found,) = awaited(maps.take)
    assert isinstance(found, InputFileError)
    assert "/map" in str(found)


@pytest.mark.parametrize("kind", ["nav_msgs/OccupancyGrid", "nav_msgs/msg/OccupancyGrid"])
def test_the_topics_of_either_ros_are_listed(server, kind):
    robots, link = server
    robots.topics = {"/r1/map": kind, "/odd\x1b": "std_msgs/String"}
    found = {each.name: each.type for each in link.published()}
    assert found["/r1/map"] == "nav_msgs/msg/OccupancyGrid"
    assert not any("\x1b" in name for name in found)


def test_a_server_that_tells_no_topics_is_told_with_what_is_missing(server):
    _, link = server
    with pytest.raises(SettingError, match="rosapi"):
        link.published()
