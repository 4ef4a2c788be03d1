"""A merge that goes on while maps grow: right at every moment or taken back, on simulated robots."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from explorers import SearchNow, exploration

from algorithms.common.errors import SettingError
from algorithms.common.pose import Pose2, pose_error
from algorithms.fleets import living_merge
from algorithms.fleets.live_answer import CORRECTED, PLACED, RESTARTED, WITHDRAWN, LiveAnswer
from algorithms.fleets.live_sightings import MOST_SEEN
from algorithms.fleets.living_merge import LivingMerge
from algorithms.fleets.pair_recheck import recheck
from algorithms.maps.grid_map import UNKNOWN, GridMap
from algorithms.simulator.fleets.exploration import Exploration, SlamCorrection

CLOSE = 0.3, 0.03  # metres at the robot, radians: a map that lies so near to the truth is right


class Drive:
    """Robots and the merge that they feed; a scan a second."""

    def __init__(self, correction: SlamCorrection | None = None) -> None:
        self.robots: Exploration = exploration(correction)
        self.search = SearchNow()
        self.merge = LivingMerge(self.robots.names, self.search)
        self.scan = -1
        self.events: list[tuple[int, str, str]] = []
        self.answer: LiveAnswer | None = None

    def until(self, scan: int) -> Drive:
        """Go on until then; all that is placed on the way must be right."""
        while self.scan < scan:
            self.scan += 1
            for seen in self.robots.seen(self.scan):
                self.merge.see(seen)
            for name in self.robots.names:
                self.merge.take(name, self.robots.grid(name, self.scan))
            self.step()
            for name, T in self.answer.placed.items():
                truth = self.robots.true_transform(name, self.scan)
                off = pose_error(T, truth, self.robots.pose(name, self.scan).xy)
                assert off[0] < CLOSE[0], (self.scan, name)
                assert off[1] < CLOSE[1], (self.scan, name)
        return self

    def step(self) -> LiveAnswer | None:
        self.answer = self.merge.step(float(self.scan))
        self.events += [(self.scan, e.robot, e.kind) for e in (self.answer.events if self.answer else ())]
        return self.answer


def test_three_robots_that_explore_become_one_map_by_themselves():
    drive = Drive().until(20)
    assert set(drive.answer.placed) == {"r1"}  # nobody has seen anybody yet
    drive.until(34)
    assert set(drive.answer.placed) == {"r1", "r2", "r3"}
    assert {(robot, kind) for _, robot, kind in drive.events} == {("r2", PLACED), ("r3", PLACED)}


def test_a_map_that_slam_turns_is_corrected_or_withdrawn_within_two_updates():
    drive = Drive(SlamCorrection("r2", 30, 3.0)).until(34)  # where all that is placed is right at every scan
    assert (30, "r2", CORRECTED) in drive.events
    assert "r2" in drive.answer.placed


def test_a_correction_of_the_anchor_itself_moves_all_others():
    drive = Drive(SlamCorrection("r1", 30, 3.0)).until(34)
    assert set(drive.answer.placed) == {"r1", "r2", "r3"}


def test_a_robot_that_begins_anew_is_withdrawn_at_once_and_the_others_stay():
    drive = Drive().until(30)
    tiny = np.full((80, 80), UNKNOWN, dtype=np.int8)
    tiny[20:60, 20:60] = 0
    tiny[20, 20:60] = tiny[20:60, 20] = 100
    drive.merge.take("r3", GridMap(tiny, 0.05, drive.robots.grid("r3", 30).origin, "r3"))
    drive.scan += 1
    drive.step()
    assert set(drive.answer.placed) == {"r1", "r2"}
    kinds = [(robot, kind) for at, robot, kind in drive.events if at == 31]
    assert ("r3", WITHDRAWN) in kinds
    assert ("r3", RESTARTED) in kinds


def test_a_frame_that_is_another_gives_up_what_was_known_of_its_robot_alone():
    drive = Drive().until(30)
    drive.merge.restart("r2")
    answer = drive.step()
    assert set(answer.placed) == {"r1", "r3"}
    assert {seen.observed for seen in answer.fleet.sightings} | {
        seen.observer for seen in answer.fleet.sightings
    } == {"r1", "r3"}


def test_maps_that_come_faster_than_once_a_second_are_skipped():
    robots, search = exploration(), SearchNow()
    merge = LivingMerge(robots.names, search)
    for name in robots.names:
        merge.take(name, robots.grid(name, 5))
    assert merge.step(0.0) is not None
    for n in range(6, 12):
        merge.take("r1", robots.grid("r1", n))
        assert merge.step(0.1 * n) is None if n < 10 else True
    answer = merge.step(2.5)
    assert answer is None or np.array_equal(answer.fleet.maps["r1"].cells, robots.grid("r1", 11).cells)


def test_nothing_new_costs_nothing():
    drive = Drive().until(25)
    drive.step()
    asked = len(drive.search.asked)
    assert drive.step() is None
    assert len(drive.search.asked) == asked


def test_both_ways_of_a_sighting_do_not_make_it_twice_as_sure():
    drive = Drive().until(23)
    (orders,) = drive.search.asked
    assert len({frozenset((each.ref, each.mov)) for each in orders}) == len(orders) == 2


def test_sightings_are_bounded_and_those_of_strangers_refused():
    drive = Drive().until(25)
    (seen, *_) = drive.answer.fleet.sightings
    for k in range(3 * MOST_SEEN):
        moved = replace(seen.observation, sigma_range=0.1 + k / 1000)
        drive.merge.see(replace(seen, observation=moved))
    fleet = drive.step().fleet
    assert (
        sum((s.observer, s.observed) == (seen.observer, seen.observed) for s in fleet.sightings) == MOST_SEEN
    )
    with pytest.raises(SettingError, match="no robot"):
        drive.merge.see(replace(seen, observer="stranger"))


def test_a_sighting_that_lies_moves_nobody_and_is_named():
    drive = Drive().until(26)
    (seen, *_) = [each for each in drive.answer.fleet.sightings if "r2" in (each.observer, each.observed)]
    lie = replace(seen, observation=replace(seen.observation, range=seen.observation.range + 4.0))
    drive.merge.see(lie)
    drive.until(34)  # where all that is placed is right at every scan
    assert set(drive.answer.placed) == {"r1", "r2", "r3"}
    assert WITHDRAWN not in {kind for _, _, kind in drive.events}
    (left,) = drive.answer.result.left_out
    assert drive.answer.fleet.sightings[left.number] == lie


def test_an_answer_that_is_no_longer_likely_is_withdrawn_and_searched_anew(monkeypatch):
    drive = Drive().until(30)
    asked = len(drive.search.asked)

    def unlikely(fleet, order, answers):
        found = recheck(fleet, order, answers)
        if "r2" not in (order.ref, order.mov):
            return found
        less = [replace(each, probability=0.1, weight=-2.0) for each in found.hypotheses]
        return replace(found, hypotheses=tuple(less), accepted=False)

    monkeypatch.setattr(living_merge, "recheck", unlikely)
    drive.merge.take("r2", drive.robots.grid("r2", 31))
    drive.scan += 1
    assert set(drive.step().placed) == {"r1", "r3"}
    assert (31, "r2", WITHDRAWN) in drive.events
    assert {("r1", "r2")} == {(each.ref, each.mov) for each in drive.search.asked[asked]}
    monkeypatch.undo()
    drive.until(33)
    assert "r2" in drive.answer.placed


def test_a_search_that_ends_after_its_robot_began_anew_places_nobody():
    drive = Drive().until(23)  # the search of this scan's sightings is under way
    drive.merge.restart("r2")
    drive.merge.restart("r3")
    for name in drive.robots.names:
        drive.merge.take(name, drive.robots.grid(name, 24))
    drive.scan += 1
    assert set(drive.step().placed) == {"r1"}


def test_the_poses_are_in_the_frame_of_the_anchor_that_was_asked_for():
    drive = Drive()
    drive.merge = LivingMerge(drive.robots.names, drive.search, anchor="r3")
    for n in range(34):
        for seen in drive.robots.seen(n):
            drive.merge.see(seen)
        for name in drive.robots.names:
            drive.merge.take(name, drive.robots.grid(name, n))
        answer = drive.merge.step(float(n))
    assert answer.placed["r3"] == Pose2()
    T = drive.robots.true_transform("r3", 33).inverse() @ drive.robots.true_transform("r1", 33)
    off = pose_error(answer.placed["r1"], T, drive.robots.pose("r1", 33).xy)
    assert off[0] < CLOSE[0]
