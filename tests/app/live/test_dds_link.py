"""ROS 2 over bare DDS, on the loopback interface: what ours publishes, ours receives."""

from __future__ import annotations

import time

import numpy as np
import pytest
from dds_domains import new_domain

from algorithms.common.errors import InputFileError, SettingError
from algorithms.common.pose import Pose2
from algorithms.files.bags.map_messages import grid_of
from algorithms.files.bags.message_types import DIAGNOSTICS, GRID, SCAN, SEEN
from algorithms.maps.grid_map import GridMap
from app.live import dds_types
from app.live.dds_link import DdsLink, configuration
from app.live.message_fields import (
    diagnostics_message,
    grid_message,
    scan_message,
    seen_message,
    transforms_message,
)
from app.live.ros_link import TF, Topic, map_topic

GRID_MAP = GridMap(np.arange(100, dtype=np.int8).reshape(5, 20), 0.05, Pose2(1.5, -2.0, 0.3))


@pytest.fixture
def links():
    domain = new_domain()
    made = [DdsLink(domain, "lo") for _ in range(2)]
    yield made
    for link in made:
        link.close()


def awaited(subscription, count=1):
    """The first messages that come."""
    found = []
    end = time.monotonic() + 30
    while len(found) < count and time.monotonic() < end:
        found += subscription.take()
        time.sleep(0.01)
    return found


def test_who_comes_late_is_sent_the_newest_map_alone(links):
    here, there = links
    maps = there.advertise(map_topic("/r1/map"))
    for value in (1, 2, 3):
        maps.send(grid_message(GridMap(np.full((2, 3), value, np.int8), 0.05), "map", 0))
    (message,) = awaited(here.subscribe(map_topic("r1/map")))
    assert set(message.data) == {3}


def test_a_map_arrives_as_it_was_sent(links):
    here, there = links
    maps = here.subscribe(map_topic("/map"))
    there.advertise(map_topic("/map")).send(grid_message(GRID_MAP, "r1/map", 12_345_678_901))
    (message,) = awaited(maps)
    grid = grid_of("r1", "r1", message)
    np.testing.assert_array_equal(grid.cells, GRID_MAP.cells)
    assert (grid.resolution, message.header.frame_id) == (0.05, "r1/map")
    assert (message.header.stamp.sec, message.header.stamp.nanosec) == (12, 345_678_901)
    assert grid.origin.array() == pytest.approx(GRID_MAP.origin.array())


@pytest.mark.parametrize(
    ("kind", "fields", "read"),
    [
        (
            TF,
            transforms_message([("map", "odom", Pose2(1.0, 2.0, 3.0)), ("odom", "é", Pose2())], 0),
            lambda m: [each.child_frame_id for each in m.transforms] == ["odom", "é"],
        ),
        (
            SEEN,
            seen_message("base", 0, 1.0, 2.0, np.array([[0.1, 0.2], [0.2, 0.3]])),
            lambda m: m.pose.covariance[7] == 0.3,
        ),
        (
            SCAN,
            scan_message("laser", 0, -1.0, 0.1, 8.0, np.array([1.0, np.inf])),
            lambda m: len(m.ranges) == 2,
        ),
        (
            DIAGNOSTICS,
            diagnostics_message([("r1", 2, "withdrawn", {"probability": "0.1"})], 0),
            lambda m: (m.status[0].level, m.status[0].values[0].value) == (2, "0.1"),
        ),
    ],
)
def test_every_kind_of_message_goes_there_and_back(links, kind, fields, read):
    here, there = links
    topic = Topic("/it", kind, latched=True)
    there.advertise(topic).send(fields)
    (message,) = awaited(here.subscribe(topic))
    assert read(message)


def test_who_publishes_is_counted(links):
    here, there = links
    maps = here.subscribe(map_topic("/map"))
    assert maps.publishers == 0
    publication = there.advertise(map_topic("/map"))
    publication.send(grid_message(GRID_MAP, "map", 0))
    awaited(maps)
    assert maps.publishers == 1
    del publication
    there.close()
    end = time.monotonic() + 30
    while maps.publishers and time.monotonic() < end:
        time.sleep(0.01)
    assert maps.publishers == 0


def test_what_is_published_is_found_with_its_type_and_whether_it_is_latched(links):
    here, there = links
    there.advertise(map_topic("/r1/map"))
    there.advertise(Topic("/tf", TF))
    expected = {("/r1/map", GRID, True): 1, ("/tf", TF, False): 1}
    end = time.monotonic() + 30
    found = {}
    while found != expected and time.monotonic() < end:
        found = {(t.name, t.type, t.latched): count for t, count in here.published().items()}
        time.sleep(0.02)
    assert found == expected


def test_a_map_that_is_published_in_a_way_that_does_not_fit_is_told_once(links):
    here, there = links
    maps = here.subscribe(map_topic("/map"))
    there.advertise(Topic("/map", GRID, latched=False))
    (found,) = awaited(maps)
    assert "volatile" in str(found)
    assert maps.take() == []


def test_bytes_that_are_no_map_cost_nothing_but_themselves(links, monkeypatch):
    here, there = links
    topic = map_topic("/map")
    maps, publication = here.subscribe(topic), there.advertise(topic)
    made, fields = dds_types.dds_message, grid_message(GRID_MAP, "map", 0)
    monkeypatch.setattr(dds_types, "dds_message", lambda kind, data: made(kind, data[:40]))
    publication.send(fields)  # which DDS itself throws away
    no_text = b"\xff\xfe\xfd\x00"
    monkeypatch.setattr(
        dds_types, "dds_message", lambda kind, data: made(kind, data.replace(b"map\0", no_text))
    )
    publication.send(fields)
    (found,) = awaited(maps)
    assert isinstance(found, InputFileError)
    monkeypatch.undo()
    publication.send(fields)
    (message,) = awaited(maps)
    assert len(message.data) == 100


def test_types_are_called_as_ros_2_calls_them():
    assert dds_types.dds_type(GRID).__idl__.idl_transformed_typename == "nav_msgs::msg::dds_::OccupancyGrid_"
    assert dds_types.dds_type(TF).__idl__.idl_transformed_typename == "tf2_msgs::msg::dds_::TFMessage_"


def test_a_loopback_interface_keeps_participants_on_this_machine_and_what_a_person_set_stays(monkeypatch):
    alone = configuration("lo")
    assert 'address="127.0.0.1"' in alone
    assert "<AllowMulticast>false" in alone
    assert 'name="wlan0"' in configuration("wlan0")
    assert 'address="10.0.0.7"' in configuration("10.0.0.7")
    assert "Interfaces" not in configuration("")
    assert '"><evil' not in configuration('"><evil/>')
    monkeypatch.setenv("CYCLONEDDS_URI", "file:///etc/dds.xml")
    assert configuration("lo").startswith("file:///etc/dds.xml,<CycloneDDS>")


@pytest.mark.parametrize("wrong", [{"domain": 233}, {"domain": -1}, {"domain": 231, "interface": "nosuch0"}])
def test_a_domain_or_an_interface_that_is_none_is_told_in_a_line(wrong):
    with pytest.raises(SettingError, match=r"give 0 to 232|check the interface"):
        DdsLink(**wrong)
