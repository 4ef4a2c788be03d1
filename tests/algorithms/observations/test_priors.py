"""What is known without a sighting: nothing off at the truth, slack that holds, clear refusals."""

from __future__ import annotations

from dataclasses import replace
from math import degrees, nan, pi, radians

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from algorithms.common.errors import SettingError
from algorithms.common.pose import Pose2
from algorithms.observations.observation import Observation
from algorithms.observations.priors import InitialPose, NearPlace, TurnPrior
from algorithms.observations.sighted_ring import SightedRing, is_curved

T = Pose2(3.0, -2.0, 0.7)
AT = (1.5, 4.0)
HERE = T.apply(np.array(AT)).tolist()
RING = SightedRing(
    Observation(Pose2(0.0, 0.0, 0.3), *AT, 6.0, 0.4, sigma_range=1.0, sigma_bearing=pi), 0.1, 3
)
PRIORS = [
    InitialPose(T, 0.5, 2.0, 0.2),
    TurnPrior(T.theta, 0.1),
    NearPlace(*HERE, *AT, 1.0),
    RING,
    InitialPose(T, 0.5, 2.0, 0.2, *AT),
]

small = st.floats(-0.5, 0.5)


@pytest.mark.parametrize("prior", PRIORS[:3])
def test_the_truth_deviates_by_nothing_and_a_whole_turn_more_is_the_same(prior):
    poses = np.array([T.array(), T.array() + (0, 0, 2 * pi)])
    assert prior.deviations(poses) == pytest.approx([0, 0], abs=1e-9)


def test_a_standard_deviation_off_is_one():
    assert PRIORS[0].deviations(T.array()[None] + (0.0, 2.0, 0.0)) == pytest.approx([1])
    assert PRIORS[1].deviations(T.array()[None] + (9.0, 9.0, 0.1)) == pytest.approx([1])
    assert PRIORS[2].deviations(T.array()[None] + (0.5, 0.0, 0.0)) == pytest.approx([1])  # half the radius


def test_a_pose_that_is_known_at_a_point_of_map_2_lets_it_turn_about_that_point():
    turned = Pose2(0.0, 0.0, T.theta + 0.2)
    x, y = (np.array(HERE) - turned.apply(np.array(AT))).tolist()
    poses = np.array([[x, y, turned.theta], [x, y + 2.0, turned.theta]])
    assert PRIORS[4].deviations(poses) == pytest.approx([1, 2**0.5])  # of the turn; of the turn and y


@pytest.mark.parametrize("prior", [*PRIORS[1:3], InitialPose(T, 0.5, 0.5, 0.2, *AT)])
@given(st.tuples(small, small, small).map(lambda off: 0.02 * np.array(off)))
def test_told_the_other_way_round_it_says_the_same_of_every_transform_near_the_truth(prior, off):
    pose = Pose2.from_array(T.array() + off)
    there = float(prior.deviations(pose.array()[None])[0])
    back = float(prior.inverse().deviations(pose.inverse().array()[None])[0])
    assert back == pytest.approx(there, rel=0.02, abs=1e-9)


@pytest.mark.parametrize("prior", [*PRIORS[:3], PRIORS[4]])
def test_told_the_other_way_round_twice_the_truth_is_where_it_was_and_known_no_better(prior):
    twice = prior.inverse().inverse()
    near = T.array() + 0.1 * np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
    assert (twice.deviations(near) <= prior.deviations(near) + 1e-9).all()


@pytest.mark.parametrize("prior", PRIORS)
@given(small, small, small, small, small, small)
def test_no_deviation_changes_by_more_than_the_slack(prior, x, y, turn, dx, dy, dturn):
    pivot = np.array(AT)
    one = Pose2(T.x + x, T.y + y, T.theta + turn)
    two = Pose2(one.x + dx, one.y + dy, one.theta + dturn)
    moved = float(np.linalg.norm(two.apply(pivot) - one.apply(pivot)))
    before, after = prior.deviations(np.array([one.array(), two.array()]))
    assert abs(after - before) <= prior.slack(moved, abs(dturn), pivot) + 1e-9


def test_a_ring_lets_robot_2_stand_anywhere_around_the_observer_at_its_range():
    angles = np.linspace(-pi, pi, 24)
    poses = np.column_stack([6 * np.cos(angles) - AT[0], 6 * np.sin(angles) - AT[1], np.zeros(24)])
    assert RING.deviations(poses).max() <= 1 + 1e-9  # half a turn is one standard deviation of the bearing
    assert RING.deviations(np.array([[12.0 - AT[0], -AT[1], 0.0]]))[0] > 5


def test_only_a_sighting_that_is_vague_in_its_bearing_is_a_ring():
    sharp = Observation(Pose2(), 0.0, 0.0, 3.0, 0.0)
    assert not is_curved(sharp, 3.5)
    assert is_curved(RING.observation, 3.5)


@pytest.mark.parametrize(
    "make",
    [
        lambda: InitialPose(Pose2(0, 0, 90.0)),
        lambda: InitialPose(Pose2(0, 0, 0), 1.0, 1.0, 10.0),
        lambda: TurnPrior(degrees(1.0)),
    ],
)
def test_degrees_for_radians_are_told_as_that(make):
    with pytest.raises(SettingError, match="degrees"):
        make()


@pytest.mark.parametrize(
    "make",
    [
        lambda: InitialPose(Pose2(nan, 0, 0)),
        lambda: InitialPose(Pose2(), 0.0),
        lambda: InitialPose(Pose2(), -1.0),
        lambda: TurnPrior(0.0, nan),
        lambda: TurnPrior(0.0, radians(0.001)),
        lambda: NearPlace(0, 0, 0, nan),
        lambda: NearPlace(0, 0, 0, 0, 0.0),
    ],
)
def test_numbers_that_mean_nothing_are_refused(make):
    with pytest.raises(SettingError, match="must be"):
        make()


def test_a_ring_far_from_the_observer_is_known_to_be_flat_there():
    o = RING.observation
    near, far = (SightedRing(replace(o, range=metres), 0.1, 3) for metres in (2.0, 20.0))
    pivot = np.array(AT)
    assert far.slack(0.2, 0.0, pivot) < near.slack(0.2, 0.0, pivot) / 4
