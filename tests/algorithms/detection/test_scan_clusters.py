"""Things in a scan: what stands apart is a thing of its own, what touches is one."""

from __future__ import annotations

from math import cos, pi, sin

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from robot_scans import scan_of

from algorithms.common.pose import Pose2
from algorithms.detection.footprint import Footprint
from algorithms.detection.scan_clusters import BEFORE, BEHIND, BESIDE, clusters_of
from algorithms.sensors.laser_scan import LaserScan

BODY = Footprint()


def robots_in(scan, explained=None):
    """Clusters that are no wall: nearer than three quarters of it."""
    return [c for c in clusters_of(scan, explained) if np.hypot(*c.points.T).min() < 6.0]


@given(
    st.floats(0.8, 5.5), st.floats(-2.0, 2.0), st.floats(-pi, pi), st.integers(0, 1000), st.floats(0.0, 0.03)
)
def test_a_robot_in_the_open_is_one_thing_before_its_background(distance, bearing, turn, seed, noise):
    at = Pose2(distance * cos(bearing), distance * sin(bearing), turn)
    scan = scan_of(BODY, at, noise=noise, seed=seed, lost=0.01)
    most, *rest = sorted(robots_in(scan), key=lambda cluster: -len(cluster.beams))
    assert most.free
    assert most.whole
    # the far end of a side along which a beam grazes may lie too far off to be seen as the same
    assert sum(len(cluster.beams) for cluster in rest) <= 2


@given(st.floats(0.9, 5.0), st.integers(0, 719))
def test_a_robot_on_the_seam_of_a_whole_turn_is_one_thing(distance, first):
    """A scanner that looks all round begins somewhere; where, changes nothing."""
    angle = pi + first * pi / 360
    at = Pose2(distance * cos(angle), distance * sin(angle), 0.3)
    found = robots_in(scan_of(Footprint.disc(0.2), at, beams=720, field=2 * pi))
    assert len(found) == 1
    assert found[0].free


def test_two_robots_side_by_side_are_two_things():
    found = robots_in(scan_of(BODY, Pose2(2.0, 0.5, 0.0), Pose2(2.0, -0.5, 0.0)))
    assert len(found) == 2


def test_what_hides_a_part_of_a_robot_is_told_on_its_side():
    left = Pose2(1.0, 0.35, 0.0)  # nearer, it covers the left part of the other
    near, far = sorted(robots_in(scan_of(BODY, Pose2(2.5, 0.1, 0.0), left)), key=lambda c: c.points[0, 0])
    assert near.free
    assert (far.first, far.last) == (BEHIND, BEFORE)
    assert not far.whole


def test_a_thing_at_the_end_of_the_view_may_go_on_outside_of_it():
    bearing = 0.75 * pi
    (found,) = robots_in(scan_of(BODY, Pose2(2.0 * cos(bearing), 2.0 * sin(bearing), 0.0)))
    assert found.last == BEFORE


def test_beams_that_the_map_explains_belong_to_no_thing_and_stand_beside_it():
    scan = scan_of(BODY, Pose2(2.0, 0.0, 0.0), Pose2(2.0, 0.4, 0.0))  # two that touch are one thing
    (joined,) = robots_in(scan)
    left = np.zeros(len(scan.ranges), dtype=bool)
    left[joined.beams[joined.points[:, 1] > 0.2]] = True
    (alone,) = robots_in(scan, left)
    assert alone.points[:, 1].max() <= 0.2
    assert alone.last == BESIDE


def test_beams_that_are_lost_do_not_cut_a_robot_in_two():
    scan = scan_of(BODY, Pose2(2.0, 0.0, 0.0))
    ranges = scan.ranges.copy()
    ranges[268:271] = np.nan
    assert len(robots_in(LaserScan(scan.angle_min, scan.angle_increment, ranges))) == 1


def test_a_beam_into_the_open_does():
    scan = scan_of(BODY, Pose2(2.0, 0.0, 0.0))
    ranges = scan.ranges.copy()
    ranges[269] = np.inf
    assert len(robots_in(LaserScan(scan.angle_min, scan.angle_increment, ranges))) == 2


@pytest.mark.parametrize("value", [np.nan, np.inf])
def test_a_scan_without_points_has_no_things(value):
    assert clusters_of(LaserScan(-1.0, 0.01, np.full(200, value))) == []
