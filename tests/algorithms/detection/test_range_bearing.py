"""Range and bearing of a robot from its laser points, and whether the stated deviations are true."""

from __future__ import annotations

from math import cos, hypot, pi, sin

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from robot_scans import scan_of

from algorithms.common.pose import Pose2, wrap_angle
from algorithms.detection.footprint import Footprint
from algorithms.detection.range_bearing import mean_of_points, position_of
from algorithms.detection.scan_clusters import clusters_of

CHI2_95 = 5.991  # of two degrees of freedom
BODIES = (Footprint(), Footprint.disc(0.2), Footprint(0.6, 0.4))


def nearest(scan):
    return min(clusters_of(scan), key=distance_of)


def distance_of(cluster):
    return float(np.hypot(*cluster.points.T).min())


def measured(body, at, **how):
    """What is measured of a robot at a pose in the laser's frame, and the truth in the robot's own."""
    scan = scan_of(body, at, **how)
    x, y = scan.mounting.apply(at.xy)
    return position_of(nearest(scan), scan, body), hypot(x, y), np.arctan2(y, x)


poses = st.tuples(st.floats(0.9, 5.5), st.floats(-1.5, 1.5), st.floats(-pi, pi)).map(
    lambda p: Pose2(p[0] * cos(p[1]), p[0] * sin(p[1]), p[2])
)


@settings(max_examples=40)
@given(st.sampled_from(BODIES), poses)
def test_a_perfect_scan_gives_the_centre_to_less_than_a_beam(body, at):
    seen, distance, bearing = measured(body, at)
    assert abs(seen.range - distance) < 0.02
    assert abs(wrap_angle(seen.bearing - bearing)) < 1.5 * pi / 540
    assert seen.unexplained < 0.05


@settings(max_examples=25)
@given(st.floats(1.0, 2.5), st.floats(-1.5, 1.5), st.floats(-pi, pi), st.floats(-0.3, 0.3))
def test_the_outline_that_explains_the_beams_best_is_turned_as_the_robot_is(far, direction, turn, mounted):
    at = Pose2(far * cos(direction), far * sin(direction), turn)
    seen, _, _ = measured(Footprint(0.6, 0.4), at, mounting=Pose2(0.1, 0.0, mounted))
    off = wrap_angle(2 * (seen.turn - turn - mounted)) / 2  # a half turn more looks the same
    assert abs(off) < 0.1


@settings(max_examples=25)
@given(st.sampled_from(BODIES), poses, st.floats(-0.3, 0.3))
def test_the_mounting_of_the_laser_moves_the_answer_with_it(body, at, turn):
    """Seen from the laser all is as before; the robot's own frame lies elsewhere."""
    mounting = Pose2(0.2, -0.1, turn)
    plain, _, _ = measured(body, at)
    moved, _, _ = measured(body, at, mounting=mounting)
    assert moved.point() == pytest.approx(mounting.apply(plain.point()), abs=1e-9)


@settings(max_examples=25)
@given(st.sampled_from(BODIES), poses)
def test_a_mirrored_scan_gives_the_mirrored_bearing(body, at):
    mirrored = Pose2(at.x, -at.y, -at.theta)
    # a beam straight ahead, and as many to either side
    seen, _, _ = measured(body, at, beams=541, field=2 * pi * 541 / 720)
    other, _, _ = measured(body, mirrored, beams=541, field=2 * pi * 541 / 720)
    assert abs(seen.range - other.range) < 0.01
    assert abs(seen.bearing + other.bearing) < 0.006


@pytest.mark.parametrize("body", BODIES, ids=["box", "disc", "long box"])
@pytest.mark.parametrize("beams", [540, 270])
def test_the_errors_agree_with_the_deviations_that_are_stated(body, beams):
    """95 % within the 95 % bound, give or take what chance does to 160 draws (three standard deviations)."""
    rng = np.random.default_rng(beams)
    inside, worst, count = 0, 0.0, 160
    errors, bearings = [], []
    for seed in range(count):
        distance, direction = rng.uniform(1.0, 6.0), rng.uniform(-1.2, 1.2)
        at = Pose2(distance * cos(direction), distance * sin(direction), rng.uniform(-pi, pi))
        noise = rng.uniform(0.012, 0.03)
        seen, true_range, true_bearing = measured(body, at, beams=beams, noise=noise, seed=seed, lost=0.01)
        error, off = seen.range - true_range, wrap_angle(seen.bearing - true_bearing)
        chi2 = (error / seen.sigma_range) ** 2 + (off / seen.sigma_bearing) ** 2
        inside += chi2 < CHI2_95
        worst = max(worst, chi2)
        errors.append(abs(error))
        bearings.append(abs(off))
    assert inside / count > 0.95 - 3 * (0.95 * 0.05 / count) ** 0.5
    assert worst < 60
    assert np.median(errors) < 0.01
    assert np.median(bearings) < np.radians(0.3)


def test_a_robot_of_which_half_is_hidden_leaves_more_open():
    body, at = Footprint(), Pose2(3.0, 0.0, 0.4)
    whole, _, _ = measured(body, at, noise=0.02)
    scan = scan_of(body, at, Pose2(1.2, 0.28, 0.0), noise=0.02)
    hidden = max((c for c in clusters_of(scan) if distance_of(c) < 4), key=distance_of)
    assert not hidden.whole
    seen = position_of(hidden, scan, body)
    assert seen.sigma_bearing > 2 * whole.sigma_bearing
    assert abs(seen.bearing) < 3 * seen.sigma_bearing
    assert abs(seen.range - 3.0) < 3 * seen.sigma_range


def test_a_noisier_laser_leaves_more_open():
    at = Pose2(2.0, 0.5, 0.2)
    quiet, loud = (measured(Footprint(), at, noise=noise)[0] for noise in (0.005, 0.05))
    assert loud.sigma_range > 1.5 * quiet.sigma_range


def test_a_thing_of_another_size_is_not_explained():
    at = Pose2(2.0, 0.0, 0.0)
    scan = scan_of(Footprint.disc(0.6), at)
    assert position_of(nearest(scan), scan, Footprint.disc(0.2)).unexplained > 0.3


def test_the_mean_of_the_points_lies_on_the_near_side_of_the_centre():
    scan = scan_of(Footprint.disc(0.3), Pose2(2.0, 0.0, 0.0))
    mean = mean_of_points(nearest(scan))
    assert 1.7 < mean[0] < 2.0 - 0.15
    assert abs(mean[1]) < 0.01
