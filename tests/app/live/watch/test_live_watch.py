"""Simulated robots, as the page follows them: how they do, what stands, and what is taken back."""

from __future__ import annotations

from threading import Event

import pytest
from explorers import SearchNow, home

from algorithms.common.pose import pose_error
from algorithms.fleets.pair_hypotheses import pair_orders
from algorithms.simulator.fleets.exploration import Exploration
from app.live.map_source import STALE_AFTER
from app.live.message_fields import grid_message
from app.live.simulation import map_of
from app.live.watch import live_watch
from app.live.watch.live_watch import LivePicture, LiveWatch, pictures
from app.live.watch.running_robots import SimulatedRobots

STEP = 0.5  # seconds between two looks


class Drive:
    """The robots of a home, at a speed, on a clock of our own."""

    def __init__(self, speed: float = 2.0) -> None:
        self.speed, self.now = speed, 100.0
        self.robots = SimulatedRobots(lambda: self.speed, home)
        self.run = self.robots.begin(SearchNow())
        self.watch = LiveWatch(self.run, "home")
        self.pictures: list[LivePicture] = []

    def on(self, seconds: float) -> LivePicture:
        """So many seconds later."""
        end = self.now + seconds
        while self.now < end:
            self.robots.step(self.now)
            picture = self.watch.step(self.now)
            if picture is not None:
                self.pictures.append(picture)
            self.now += STEP
        return self.pictures[-1]


@pytest.fixture
def drive() -> Drive:
    return Drive()


def test_robots_that_explore_become_one_map_that_is_right_and_nobody_has_asked_for_it(drive):
    first = drive.on(1.0)
    assert first.state is not None
    assert set(first.state.result.placed) == {"r1"}
    last = drive.on(20.0)
    assert drive.robots.done
    truth = Exploration(home())
    assert last.state.result.whole
    for name, T in last.state.result.placed.items():
        metres, turn = pose_error(
            T, truth.true_transform(name, truth.scans), truth.pose(name, truth.scans).xy
        )
        assert metres < 0.3
        assert turn < 0.03
    assert not last.lost


def test_what_stands_can_be_gone_on_with_as_a_fleet_of_files(drive):
    state = drive.on(20.0).state
    assert state.name == "home"
    assert all(state.finding(order) is not None for order in pair_orders(state.fleet))


def test_a_robot_is_live_then_stale_then_gone_and_the_others_are_not_disturbed(drive):
    assert {each.state for each in drive.on(3.0).robots.values()} == {"live"}
    drive.on(20.0)
    stale = drive.on(STALE_AFTER + 2).robots
    assert {each.state for each in stale.values()} == {"stale"}
    assert f"stale for {stale['r2'].age:.0f} s" in stale["r2"].told
    drive.robots.leave("r2")
    after = drive.on(2.0)
    assert {name: each.state for name, each in after.robots.items()} == {
        "r1": "stale",
        "r2": "gone",
        "r3": "stale",
    }
    assert after.state.result.whole  # its last map stays


def test_a_rate_is_that_of_the_maps_that_come(drive):
    rates = [each.rate for each in drive.on(10.0).robots.values()]
    assert rates == pytest.approx([1.0] * 3, abs=0.2)
    assert {each.pose is not None for each in drive.pictures[-1].robots.values()} == {True}


def test_robots_that_are_held_stand_and_go_on_from_there(drive):
    drive.on(2.0)
    drive.speed = 0.0
    drive.on(5.0)
    assert not drive.robots.done
    drive.speed = 20.0
    drive.on(5.0)
    assert drive.robots.done


def test_what_no_longer_stands_is_told_as_lost_until_it_stands_again(drive):
    whole = drive.on(20.0)
    grid = whole.state.fleet.maps["r2"]
    other = drive.robots._link.advertise(map_of("r2"))
    other.send(grid_message(grid, "r2/another_map", 1))
    after = drive.on(2.0)
    assert "r2" in after.lost
    assert any(each.robot == "r2" and each.kind == "withdrawn" for p in drive.pictures for each in p.events)


def test_pictures_come_until_it_is_stopped_and_then_all_is_closed(monkeypatch):
    monkeypatch.setattr(live_watch, "EVERY", 0.0)
    stop, robots = Event(), SimulatedRobots(lambda: 1.0, home)
    closed = []
    monkeypatch.setattr(robots, "close", lambda: closed.append(True))
    seen = []
    for picture in pictures(robots, "home", stop):
        seen.append(picture)
        if len(seen) == 2:
            stop.set()
    assert len(seen) == 2
    assert closed == [True]
