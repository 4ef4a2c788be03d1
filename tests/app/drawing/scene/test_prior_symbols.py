"""Rings and wedges lie where what is known says, as wide as it says."""

from __future__ import annotations

from math import atan2

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from algorithms.common.pose import Pose2
from algorithms.observations.priors import InitialPose, NearPlace, TurnPrior
from app.drawing.palette import LIGHT
from app.drawing.scene.prior_symbols import DEVIATIONS, near_place, rough_pose, rough_turn
from app.drawing.scene_layout import lay_out


@pytest.fixture(scope="module")
def layout(small_case):
    return lay_out(small_case.ref, small_case.mov, None)


@given(theta=st.floats(-3, 3), sigma_x=st.floats(0.1, 5), sigma_y=st.floats(0.1, 5))
def test_the_ring_of_a_pose_holds_every_place_within_two_deviations(layout, theta, sigma_x, sigma_y):
    prior = InitialPose(Pose2(4.0, 5.0, theta), sigma_x, sigma_y, 0.1, 2.0, -1.0)
    ring = next(item for item in rough_pose(prior, layout, LIGHT) if "middle" in item.get("t", ""))
    moved = [prior.pose.apply(point + layout.anchor_mov) for point in ring["p"]]
    place = prior.pose.apply(prior.about)
    poses = np.array([[*(prior.pose.xy + (at - place)), theta] for at in moved])
    assert prior.deviations(poses) == pytest.approx(np.full(len(poses), DEVIATIONS))


@given(sigma=st.floats(0.01, 1.5))
def test_the_wedge_of_a_turn_opens_by_two_deviations_to_either_side(layout, sigma):
    fan = rough_turn(TurnPrior(0.3, sigma), layout, LIGHT)[0]["p"]
    angles = [atan2(y, x) for x, y in fan[1:]]
    assert (min(angles), max(angles)) == pytest.approx((-2 * sigma, 2 * sigma))


def test_the_wedge_of_a_turn_that_nobody_knows_is_a_whole_circle(layout):
    fan = rough_turn(TurnPrior(0.0, 3.0), layout, LIGHT)[0]["p"]
    assert fan[1] == pytest.approx(fan[-1])


def test_a_place_has_a_ring_in_the_frame_of_each_map(layout):
    prior = NearPlace(1.0, 2.0, 3.0, 4.0, 1.5)
    first, _, second, _ = near_place(prior, layout, LIGHT)
    for item, point, anchor in (
        (first, (1.0, 2.0), layout.anchor_ref),
        (second, (3.0, 4.0), layout.anchor_mov),
    ):
        assert np.hypot(*(item["p"] - (point - anchor)).T) == pytest.approx(np.full(64, 1.5))
    assert (first["f"], second["f"]) == ("scene", "map2")
