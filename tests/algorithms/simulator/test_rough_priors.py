"""What somebody may know is drawn around the truth, with the deviations that it states."""

from __future__ import annotations

import numpy as np
import pytest

from algorithms.common.pose import Pose2
from algorithms.observations.observation import Observation, encounter
from algorithms.simulator.portable_random import stream
from algorithms.simulator.rough_priors import met_at, rough_prior

T = Pose2(3.0, -2.0, 2.9)


@pytest.mark.parametrize("knowledge", ["initial", "turn"])
def test_the_truth_lies_within_the_stated_deviations(knowledge):
    rng = stream(1, "test")
    off = [rough_prior(T, knowledge, rng)[0].deviations(T.array()[None])[0] ** 2 for _ in range(400)]
    assert np.mean(off) == pytest.approx(3 if knowledge == "initial" else 1, rel=0.2)  # degrees of freedom


@pytest.mark.parametrize("knowledge", ["sighting", "none"])
def test_nothing_more_is_known_of_a_sighting_or_of_nothing(knowledge):
    assert rough_prior(T, knowledge, stream(1, "test")) == ()


def test_a_transform_through_the_place_of_a_sighting_puts_robot_2_where_it_was_seen():
    o = Observation(Pose2(1.0, 2.0, 0.5), 4.0, -1.0, 3.0, 0.2)
    at = encounter(o)
    assert met_at(o, 1.3).apply(at.x_mov) == pytest.approx(at.x_ref)
