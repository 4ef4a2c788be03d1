"""What a laser measures of robots, mirrors and posters."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from sights import LASER, OBSERVER, bare_room, scene_with

from algorithms.common.pose import Pose2
from algorithms.simulator.lidar import Lidar, scan
from algorithms.simulator.portable_random import stream
from algorithms.simulator.views.reflections import reflected_pose
from algorithms.simulator.views.robot_body import RobotBody
from algorithms.simulator.views.robot_scan import scan_of
from algorithms.simulator.views.solids import DRUM, Solid, ticks_of
from algorithms.simulator.views.surfaces.materials import Material
from algorithms.simulator.views.view_scene import Mirror, Poster, ViewScene

BODY, MOUNTING = RobotBody(), Pose2(0.05, 0.0, 0.0)


def measured(scene: ViewScene, observer: Pose2 = OBSERVER, lidar: Lidar = LASER, mounting: Pose2 = MOUNTING):
    return scan_of(scene, observer, mounting, lidar, stream(0, "scan"))


def off_footprint(points: np.ndarray, pose: Pose2) -> np.ndarray:
    """Distance of points from the outline of a robot, negative within it; metres."""
    local = np.abs(pose.inverse().apply(points)) - [BODY.length / 2, BODY.width / 2]
    outside = np.hypot(*np.maximum(local, 0).T)
    return np.where((local < 0).all(axis=1), local.max(axis=1), outside)


@settings(max_examples=40)
@given(st.floats(1.0, 5.0), st.floats(-2.0, 2.0), st.floats(-3.1, 3.1))
def test_points_on_a_robot_lie_on_its_footprint(far, off, turn):
    pose = OBSERVER @ Pose2(far * np.cos(off), far * np.sin(off), turn)
    if not (1.0 < pose.x < 11.0 and 1.0 < pose.y < 7.0):
        return
    alone, both = measured(scene_with()), measured(scene_with((pose, BODY)))
    nearer = both.ranges < alone.ranges - 0.15
    assert nearer.sum() >= 0.3 / far / both.angle_increment
    off_it = off_footprint(OBSERVER.apply(both.points()[nearer]), pose)
    assert np.abs(off_it).max() < 6 * LASER.noise
    assert np.abs(np.median(off_it)) < LASER.noise


def test_without_robots_it_is_what_the_lidar_of_a_drive_measures():
    here = Pose2(2.5, 3.0, 0.5)
    building, heading = bare_room((5.0, 2.0, 6.0, 3.0)), np.array([ticks_of(0.5)])
    drive = scan(building, here.xy[None], heading, LASER, stream(0, "scan"))[0]
    assert np.array_equal(measured(ViewScene(building), here, mounting=Pose2()).ranges, drive)


def test_a_robot_behind_a_wall_is_not_in_the_scan():
    pose, wall = Pose2(5.0, 4.0, 0.2), bare_room((3.4, 3.0, 3.6, 5.0))
    with_robot, without = (measured(scene_with(*robots, building=wall)) for robots in ([(pose, BODY)], []))
    assert np.array_equal(with_robot.ranges, without.ranges)


def test_a_mirror_puts_a_robot_at_its_mirrored_place():
    mirror, pose = Mirror((4.0, 7.4), (7.0, 7.4)), Pose2(7.0, 5.2, 0.4)
    observer = Pose2(4.0, 5.4, 0.9)
    alone, both = (
        measured(scene_with(*robots, mirrors=(mirror,)), observer) for robots in ([], [(pose, BODY)])
    )
    image = reflected_pose(mirror, pose)
    assert image.x == pytest.approx(7.0)
    assert image.y == pytest.approx(2 * 7.38 - 5.2)
    assert image.theta == pytest.approx(-0.4)
    points = observer.apply(both.points()[both.ranges < alone.ranges - 0.1])
    seen_there = np.abs(off_footprint(points, image)) < 6 * LASER.noise
    assert seen_there.sum() > 5
    assert (seen_there | (np.abs(off_footprint(points, pose)) < 6 * LASER.noise)).all()


def test_a_mirror_does_not_end_what_lies_before_it_and_a_wall_before_it_hides_it():
    mirror = Mirror((11.4, 5.0), (11.4, 3.0))
    bare, seen_in = (measured(scene_with(mirrors=mirrors)) for mirrors in ((), (mirror,)))
    ahead = len(bare.ranges) // 2
    assert np.isinf(bare.ranges[ahead])  # the wall is 9.35 m away
    near = Pose2(8.0, 4.0, 0.0)
    ranges = measured(scene_with(mirrors=(mirror,)), near).ranges
    assert ranges[ahead] > 2 * 3.3  # there and back
    hidden = bare_room((9.0, 3.0, 9.2, 5.0))
    wall = measured(scene_with(building=hidden, mirrors=(mirror,)), near).ranges
    assert wall[ahead] == pytest.approx(0.95, abs=0.1)
    assert np.isinf(seen_in.ranges[ahead])


def test_a_poster_leaves_the_scan_as_if_it_were_not_there():
    poster = Poster((11.4, 4.5), (11.4, 3.5), 0.0, 1.0, BODY.board(0), robot=True)
    here = Pose2(8.0, 4.0, 0.0)
    plain, hung = (measured(scene_with(posters=posters), here) for posters in ((), (poster,)))
    assert np.array_equal(plain.ranges, hung.ranges)


def test_things_that_stand_about_are_hit_unless_they_are_too_low():
    bin_ = Solid(4.0, 4.0, 0.4, 0.4, 0.0, 0.6, (Material("plain"),), shape=DRUM)
    low = Solid(4.0, 4.0, 0.4, 0.4, 0.0, 0.2, (Material("plain"),))
    ahead = LASER.beams // 2
    assert measured(scene_with(things=(bin_,))).ranges[ahead] == pytest.approx(1.75, abs=0.1)
    assert not measured(scene_with(things=(low,))).ranges[ahead] < 8


def test_bearings_are_those_of_the_beams():
    pose = OBSERVER @ Pose2(0.0, 2.0, 0.0)
    lidar = Lidar(beams=360, field=360.0, reach=9.0, noise=0.0, lost=0.0)
    scanned = measured(scene_with((pose, BODY)), lidar=lidar, mounting=Pose2(0.0, 0.0, 0.3))
    on_it = np.abs(off_footprint(OBSERVER.apply(scanned.points()), pose)) < 0.01
    assert on_it.sum() > 8
    assert scanned.angles[on_it].mean() == pytest.approx(np.pi / 2 - 0.3, abs=0.03)
