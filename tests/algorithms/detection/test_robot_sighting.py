"""Box and laser together: what both show is a robot, what one of them denies is refused with the reason."""

from __future__ import annotations

from dataclasses import replace
from math import atan2, cos, hypot, pi, sin

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from robot_scans import hits, scan_of

from algorithms.common.pose import Pose2
from algorithms.detection.detection import Detection
from algorithms.detection.footprint import Footprint
from algorithms.detection.map_walls import MapWalls
from algorithms.detection.robot_sighting import observation_of, sight
from algorithms.maps.grid_map import FREE, OCCUPIED, GridMap
from algorithms.sensors.camera import Camera
from algorithms.sensors.laser_scan import LaserScan

BODY = Footprint()
CAMERA = Camera(640, 480, (500.0, 500.0), (319.5, 239.5), mounting=Pose2(0.1, 0.02, 0.03))
LASER = Pose2(0.05, 0.0, -0.02)


def box_of(at, camera=CAMERA, body=BODY, probability=0.99):
    """The box that a perfect detector draws around a robot at a pose in the observer's frame."""
    half = np.array([[1, 1], [1, -1], [-1, -1], [-1, 1]]) * [body.length / 2, body.width / 2]
    corners = camera.mounting.inverse().apply(at.apply(half))
    columns = camera.columns(np.arctan2(corners[:, 1], corners[:, 0]))
    high = 250.0 / hypot(at.x, at.y)
    return Detection(float(columns.min()), 240.0, float(columns.max()), 240.0 + high, probability, "robot")


def scan(*at, body=BODY, wall=8.0, noise=0.015, seed=1):
    """A scan of robots at poses in the observer's frame."""
    in_laser = [LASER.inverse() @ pose for pose in at]
    return scan_of(
        body, *in_laser, wall=wall, noise=noise, seed=seed, mounting=LASER, beams=720, field=2 * pi
    )


def place(distance, bearing, turn=0.0):
    return Pose2(distance * cos(bearing), distance * sin(bearing), turn)


@settings(max_examples=30)
@given(
    st.floats(1.0, 5.5), st.floats(-0.4, 0.4), st.floats(-pi, pi), st.integers(0, 99), st.floats(-0.15, 0.15)
)
def test_a_robot_in_the_open_is_found_however_roughly_its_box_lies(distance, bearing, turn, seed, off):
    at = place(distance, bearing, turn)
    box = box_of(at)
    moved = replace(box, left=box.left + off * box.width, right=box.right + off * box.width)
    seen = sight([moved], scan(at, seed=seed), CAMERA, BODY).position
    assert abs(seen.range - distance) < 5 * seen.sigma_range
    assert abs(seen.bearing - bearing) < 5 * seen.sigma_bearing


def test_without_calibration_a_box_still_finds_its_points():
    counting = Camera.counting_pixels(640, 480, 2 * atan2(320, 500), CAMERA.mounting)
    at = place(3.0, 0.3, 0.5)
    seen = sight([box_of(at)], scan(at), counting, BODY).position
    assert seen.range == pytest.approx(3.0, abs=0.05)


def test_nothing_found_is_told_with_what_would_help():
    refused = sight([], scan(), CAMERA, BODY)
    assert refused.position is None
    assert "come nearer" in refused.reason


def test_a_poster_has_no_step_in_depth():
    refused = sight([box_of(place(3.0, 0.1))], scan(wall=3.0), CAMERA, BODY)
    assert refused.position is None
    assert "no step in depth" in refused.reason


@pytest.mark.parametrize("size", [Footprint.disc(0.08), Footprint(1.2, 0.9)])
def test_a_thing_of_another_size_is_no_robot(size):
    at = place(2.5, 0.0)
    refused = sight([box_of(at)], scan(at, body=size), CAMERA, BODY)
    assert refused.position is None


def test_a_robot_against_a_wall_is_refused_and_found_again_with_the_map():
    """The wall is 2.4 m ahead, and the robot's back stands against it."""
    at = Pose2(2.4 - BODY.length / 2, 0.0, 0.0)
    plain = scan(at, noise=0.005)
    angles = plain.angles + LASER.theta
    with np.errstate(divide="ignore"):
        wall = np.where(np.cos(angles) > 0.05, (2.4 - LASER.x) / np.cos(angles), 8.0)
    ranges = np.minimum(plain.ranges, np.minimum(wall, 8.0))
    touching = LaserScan(plain.angle_min, plain.angle_increment, ranges, 0.05, 30.0, LASER)
    # the gap between side and wall is none: without the map the laser sees one thing, or a step that is small
    walls = MapWalls(room(2.4), Pose2())
    known = sight([box_of(at)], touching, CAMERA, BODY, walls).position
    assert known is not None
    assert known.range == pytest.approx(hypot(at.x, at.y), abs=0.05)


def room(ahead, beside=3.0, cell=0.05):
    """A map with a wall across the way ahead of the origin and walls on both sides; metres."""
    size = round(2 * 6 / cell)
    cells = np.full((size, size), FREE, np.int8)
    middle = size // 2
    cells[:, middle + round(ahead / cell)] = OCCUPIED
    cells[middle + round(beside / cell)] = OCCUPIED
    cells[middle - round(beside / cell)] = OCCUPIED
    return GridMap(cells, cell, Pose2(-6.0, -6.0, 0.0))


def test_what_stands_behind_a_wall_of_the_map_is_a_mirror_image():
    at = place(3.5, 0.05)
    box, seen = [box_of(at)], scan(at)
    assert sight(box, seen, CAMERA, BODY).position is not None
    refused = sight(box, seen, CAMERA, BODY, MapWalls(room(2.0), Pose2()))
    assert refused.position is None
    assert "mirror" in refused.reason


def test_a_map_with_the_wall_behind_the_robot_changes_nothing():
    at = place(2.0, 0.05)
    free, with_map = (
        sight([box_of(at)], scan(at), CAMERA, BODY, w) for w in (None, MapWalls(room(4.0), Pose2()))
    )
    assert with_map.position == free.position


def test_the_map_lies_where_the_robot_stands_in_it():
    """Turned and moved with the robot, it says the same."""
    at, stood = place(3.5, 0.05), Pose2(70.0, -30.0, 2.1)
    moved = replace(room(2.0), origin=stood @ Pose2(-6.0, -6.0, 0.0))
    assert sight([box_of(at)], scan(at), CAMERA, BODY, MapWalls(moved, stood)).position is None
    assert sight([box_of(at)], scan(at), CAMERA, BODY, MapWalls(moved, Pose2(0, 0, 0))).position is not None


def test_two_robots_in_view_are_refused_until_one_is_chosen():
    left, right = place(2.5, 0.25), place(3.0, -0.2, 0.7)
    boxes, seen = [box_of(left), box_of(right, probability=0.8)], scan(left, right)
    refused = sight(boxes, seen, CAMERA, BODY)
    assert refused.position is None
    assert "2 robots are in view" in refused.reason
    chosen = sight(boxes, seen, CAMERA, BODY, pick=1)
    assert chosen.position.range == pytest.approx(3.0, abs=0.05)


def test_two_boxes_on_one_robot_are_one_sighting():
    at = place(2.5, 0.1)
    box = box_of(at)
    other = replace(box, left=box.left + 8, probability=0.7)
    seen = sight([box, other], scan(at), CAMERA, BODY)
    assert seen.chosen == 0


def test_a_box_that_is_chosen_and_refused_is_no_sighting():
    refused = sight([box_of(place(3.0, 0.1))], scan(wall=3.0), CAMERA, BODY, pick=0)
    assert refused.chosen is None
    assert refused.reason


@settings(max_examples=30)
@given(st.floats(2.5, 5), st.floats(-pi, pi), st.floats(0.2, 0.45), st.integers(0, 99))
def test_of_a_robot_that_is_partly_hidden_nothing_false_is_said(distance, turn, beside, seed):
    at, before = place(distance, 0.0, turn), Pose2(1.3, beside, 0.0)
    seen = sight([box_of(at)], scan(at, before, seed=seed), CAMERA, BODY).position
    if seen is not None:
        assert abs(seen.bearing) < 5 * seen.sigma_bearing
        assert abs(seen.range - distance) < 5 * seen.sigma_range


def test_a_chair_leg_beside_the_robot_is_not_taken_for_it():
    at, leg = place(2.5, 0.0), Footprint.disc(0.03)
    plain = scan(at, noise=0.0)
    beside = LASER.inverse() @ Pose2(2.0, 0.3, 0.0)
    ranges = np.minimum(plain.ranges, hits(leg, beside, plain.angles))
    both = LaserScan(plain.angle_min, plain.angle_increment, ranges, 0.05, 30.0, LASER)
    box = box_of(at)
    wide = replace(box, left=box.left - 40)
    assert sight([wide], both, CAMERA, BODY).position.range == pytest.approx(2.5, abs=0.05)


def test_an_observation_holds_what_was_measured_and_where_the_robots_stood():
    at = place(2.5, 0.1)
    seen = sight([box_of(at)], scan(at), CAMERA, BODY).position
    made = observation_of(seen, Pose2(1.0, 2.0, 0.5), np.array([3.0, 4.0]), 0.7)
    numbers = made.range, made.bearing, made.sigma_range, made.sigma_bearing
    measured = seen.range, seen.bearing, seen.sigma_range, seen.sigma_bearing
    assert numbers == pytest.approx(measured, abs=1e-6)
    assert (made.observer, made.observed_x, made.observed_heading) == (Pose2(1.0, 2.0, 0.5), 3.0, 0.7)


def test_a_small_box_before_a_thing_of_a_robot_size_is_not_that_thing():
    """A picture above a carton: the laser sees the carton, the camera something far smaller."""
    at = place(2.5, 0.1)
    box = box_of(at)
    small = replace(box, right=box.left + 0.3 * box.width)
    refused = sight([small], scan(at), CAMERA, BODY)
    assert refused.position is None
    assert "not as wide as the box" in refused.reason


def test_a_tag_is_narrower_than_its_robot():
    at = place(2.5, 0.1)
    box = box_of(at)
    tag = replace(box, left=box.left + 0.1 * box.width, right=box.left + 0.3 * box.width, is_part=True)
    assert sight([tag], scan(at), CAMERA, BODY).position.range == pytest.approx(2.5, abs=0.05)
    beside = replace(tag, left=box.right + 0.02 * box.width, right=box.right + 0.25 * box.width)
    assert sight([beside], scan(at), CAMERA, BODY).position is None
