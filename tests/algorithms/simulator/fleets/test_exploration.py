"""Robots that drive at the same time: maps that grow, meetings, and a correction of SLAM."""

from __future__ import annotations

import numpy as np
import pytest
from explorers import exploration, home

from algorithms.common.pose import Pose2, pose_error
from algorithms.simulator.fleets.exploration import SlamCorrection


def test_maps_grow_into_those_of_the_whole_drive():
    drives = exploration()
    for name in drives.names:
        cells = [np.count_nonzero(drives.grid(name, n).cells >= 0) for n in range(0, drives.scans + 1, 11)]
        assert cells == sorted(cells)
        whole, made = drives.grid(name, drives.scans), home().fleet.maps[name]
        np.testing.assert_array_equal(whole.cells, made.cells)
        assert whole.origin == made.origin


def test_robots_that_met_meet_at_one_moment_and_see_each_other_seldom():
    drives = exploration()
    seen = {n: [(each.observer, each.observed) for each in drives.seen(n)] for n in range(drives.scans)}
    pairs = [pair for at in seen.values() for pair in at]
    assert {frozenset(pair) for pair in pairs} >= {frozenset(("r1", "r2")), frozenset(("r1", "r3"))}
    assert len(pairs) == len(set(pairs))  # for not all of them do so again within forty scans


def test_a_sighting_says_where_the_other_robot_is():
    drives = exploration()
    for n in range(drives.scans):
        for each in drives.seen(n):
            T = drives.true_transform(each.observer, n).inverse() @ drives.true_transform(each.observed, n)
            o = each.observation
            there = T.apply(np.array([o.observed_x, o.observed_y]))
            told = o.observer @ Pose2(o.range * np.cos(o.bearing), o.range * np.sin(o.bearing))
            assert np.linalg.norm(told.xy - there) < 0.6


@pytest.mark.parametrize("robot", ["r1", "r2"])
def test_a_correction_turns_a_map_and_the_poses_in_it_and_leaves_the_world_as_it_is(robot):
    drives, plain = exploration(SlamCorrection(robot, 20, 3.0)), exploration()
    before, after = drives.grid(robot, 19), drives.grid(robot, 20)
    np.testing.assert_array_equal(before.cells, plain.grid(robot, 19).cells)
    assert not np.array_equal(after.points, plain.grid(robot, 20).points)
    for name in drives.names:
        pose = drives.pose(name, 20)
        there = drives.true_transform(name, 20) @ pose
        expected = plain.true_transform(name, 20) @ plain.pose(name, 20)
        if robot == "r1":  # in whose frame, turned as well, all is told
            turned = drives.pose("r1", 20) @ plain.pose("r1", 20).inverse()
            expected = turned @ expected
        assert pose_error(there, expected, np.zeros(2)) == pytest.approx((0, 0), abs=1e-3)
