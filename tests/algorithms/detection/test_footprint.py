"""A robot's outline: what a laser sees of it, and how far behind that its centre is."""

from __future__ import annotations

from math import cos, pi, sin

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from robot_scans import hits

from algorithms.common.errors import SettingError
from algorithms.common.pose import Pose2
from algorithms.detection.footprint import Footprint
from algorithms.detection.footprint_fit import ON_ROBOT, PAST_ROBOT, BeamsAround

bodies = st.one_of(
    st.builds(Footprint, st.floats(0.2, 1.0), st.floats(0.2, 1.0)), st.floats(0.1, 0.5).map(Footprint.disc)
)


@given(bodies, st.floats(-pi, pi))
def test_the_centre_lies_behind_the_mean_surface_by_area_over_twice_the_width(body, turn):
    """Seen from so far away that all beams are parallel, however the robot is turned."""
    far = 10_000.0
    at = Pose2(far, 0.0, turn)
    angles = np.linspace(-1.5, 1.5, 40_001) * body.widest / 2 / far
    ranges = hits(body, at, angles)
    seen = np.isfinite(ranges)
    width = (angles[seen][-1] - angles[seen][0]) * far
    assert far - ranges[seen].mean() == pytest.approx(body.depth(width), abs=0.002)
    assert body.narrowest - 0.001 <= width <= body.widest + 0.001


@given(bodies, st.floats(0.8, 4), st.floats(-1, 1), st.floats(-pi, pi))
def test_the_true_pose_explains_every_beam_better_than_one_beside_it(body, distance, bearing, turn):
    at = Pose2(distance * cos(bearing), distance * sin(bearing), turn)
    angles = bearing + np.linspace(-1, 1, 160)
    ranges = hits(body, at, angles)
    kinds = np.where(np.isfinite(ranges), ON_ROBOT, PAST_ROBOT).astype(np.uint8)
    beams = BeamsAround(np.stack([np.cos(angles), np.sin(angles)], axis=1), ranges, kinds, 0.01)
    poses = np.array([[at.x, at.y, turn], [at.x + 0.1 * cos(bearing), at.y + 0.1 * sin(bearing), turn]])
    true, beside = beams.likelihoods(poses, body)
    assert true > beside
    assert beams.unexplained(poses[0], body) < 0.02
    assert beams.unexplained(poses[1], body) > 0.02


@pytest.mark.parametrize("size", [0.0, -1.0, np.nan, 100.0])
def test_a_size_that_no_robot_has_is_refused(size):
    with pytest.raises(SettingError, match="robot's size"):
        Footprint(size, 0.4)
