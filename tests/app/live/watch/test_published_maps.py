"""Which maps can be followed, and what is listened to for each."""

from __future__ import annotations

from dataclasses import replace

import pytest
from fake_link import FakeLink

from algorithms.common.errors import SettingError
from algorithms.files.bags.message_types import GRID
from app.live.live_fleet_file import LiveFleet, LiveRobot
from app.live.ros_link import TF, Topic, map_topic
from app.live.watch.inner_link import InnerLink
from app.live.watch.published_maps import (
    ReachedRobots,
    name_of,
    published_maps,
    usable,
    with_robot,
    with_sightings,
)
from app.live.watch.robot_network import RobotLinks, RobotNetwork

NOBODY = LiveFleet({}, (), (), "")
NETWORK = RobotNetwork(7, "lo", "ws://there:9090")


def test_maps_are_listed_by_name_and_what_cannot_be_written_in_a_list_is_not():
    topics = [map_topic("/r2/map"), map_topic("/r1/map"), Topic("/tf", TF)]
    odd = [Topic("/a\x1bmap", GRID), Topic("/" + "x" * 300, GRID)]
    assert usable([*topics, *odd]) == ("/r1/map", "/r2/map")


def test_looking_for_maps_leaves_no_link_open(monkeypatch):
    link, closed = InnerLink(), []
    link.advertise(map_topic("/r1/map"))
    monkeypatch.setattr(RobotLinks, "link", lambda self, address="": link)
    monkeypatch.setattr(RobotLinks, "close", lambda self: closed.append(True))
    assert published_maps(RobotNetwork(), patience=0.0) == ("/r1/map",)
    assert closed == [True]


@pytest.mark.parametrize(
    ("topic", "name"), [("/r1/map", "r1"), ("/site/r1/map", "site_r1"), ("/map", ""), ("map", "")]
)
def test_a_robot_is_called_by_its_topic(topic, name):
    assert name_of(topic) == name


def test_the_first_robot_is_the_anchor_and_one_topic_is_followed_once():
    fleet = with_robot(with_robot(NOBODY, "r1", "/r1/map", NETWORK), "r2", "/r2/map", NETWORK)
    assert fleet.anchor == "r1"
    assert {each.bridge for each in fleet.robots.values()} == {NETWORK.bridge}
    with pytest.raises(SettingError, match="listened to already"):
        with_robot(fleet, "r3", "/r1/map", NETWORK)
    with pytest.raises(SettingError):
        with_robot(fleet, "r/3", "/r3/map", NETWORK)


def test_robots_that_run_are_listened_to_where_they_say_whom_they_see(small_case):
    fleet = with_robot(with_robot(NOBODY, "r1", "/r1/map", NETWORK), "r2", "/r2/map", NETWORK)
    done = LiveRobot(grid=small_case.ref)
    found = with_sightings(replace(fleet, robots={**fleet.robots, "r3": done}))
    assert dict(found.robots["r1"].sees) == {"r2": "/r1/sees/r2"}
    assert dict(found.robots["r2"].sees) == {"r1": "/r2/sees/r1"}
    assert found.robots["r3"] is done


def test_robots_are_reached_by_links_that_are_closed_with_them(monkeypatch):
    link = FakeLink()
    monkeypatch.setattr(RobotLinks, "_bridge", lambda self, address: link)
    robots = ReachedRobots(NETWORK, with_robot(NOBODY, "r1", "/r1/map", NETWORK))
    run = robots.begin(search=None)
    assert run.names == ("r1",)
    assert "/r1/map" in link.topics
    robots.close()
    assert link.closed
