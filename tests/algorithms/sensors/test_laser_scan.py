"""A laser scan as points, and the noise that it shows of itself."""

from __future__ import annotations

from math import inf, nan, pi

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from algorithms.common.errors import SettingError
from algorithms.common.pose import Pose2
from algorithms.sensors.laser_scan import LaserScan


@given(st.floats(-pi, 0), st.floats(0.002, 0.01), st.floats(-3, 3), st.floats(-pi, pi))
def test_points_lie_at_their_ranges_and_bearings_from_the_laser(first, step, x, turn):
    mounting = Pose2(x, -0.2, turn)
    ranges = np.linspace(1, 5, 300)
    points = mounting.inverse().apply(LaserScan(first, step, ranges, mounting=mounting).points())
    assert np.hypot(*points.T) == pytest.approx(ranges)
    angles = np.unwrap(np.arctan2(points[:, 1], points[:, 0]))
    assert np.diff(angles) == pytest.approx(step)


def test_what_a_scanner_cannot_measure_is_no_point():
    ranges = np.array([1.0, nan, inf, 0.0, 0.04, 31.0, -1.0, 2.0])
    scan = LaserScan(0.0, 0.1, ranges, range_min=0.05, range_max=30.0)
    assert scan.valid.tolist() == [True, *[False] * 6, True]
    assert np.isfinite(scan.points()[:, 0]).tolist() == scan.valid.tolist()


@given(st.floats(0.005, 0.05), st.integers(0, 1000))
def test_the_noise_is_told_from_the_scan_itself(noise, seed):
    """Before a wall with a corner and a step in it."""
    angles = np.linspace(-2, 2, 720)
    ranges = 3 / np.maximum(np.abs(np.cos(angles)), np.abs(np.sin(angles)))
    ranges[200:260] -= 1.5
    ranges += noise * np.random.default_rng(seed).normal(size=720)
    assert LaserScan(-2.0, 4 / 719, ranges).noise() == pytest.approx(noise, rel=0.2)


def test_a_scan_without_noise_is_not_taken_for_perfect():
    assert LaserScan(-1.0, 0.01, np.full(200, 3.0)).noise() > 0.001


@pytest.mark.parametrize(
    ("first", "step", "count", "said"),
    [
        (0.0, 0.1, 3, "3 beams"),
        (0.0, 0.0, 100, "not 0"),
        (nan, 0.1, 100, "finite"),
        (0.0, 0.5, 100, "more than a whole turn"),
    ],
)
def test_a_scan_that_cannot_be_is_refused(first, step, count, said):
    with pytest.raises(SettingError, match=said):
        LaserScan(first, step, np.ones(count))


def test_a_whole_turn_may_have_its_first_beam_twice():
    assert len(LaserScan(-pi, 2 * pi / 360, np.ones(361)).points()) == 361
