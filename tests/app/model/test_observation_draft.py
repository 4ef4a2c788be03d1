"""Placing robots by hand: range and bearing follow, and what was not touched stays as it was."""

from __future__ import annotations

from math import radians

import pytest
from hypothesis import given
from hypothesis import strategies as st

from algorithms.common.pose import Pose2
from algorithms.files.observation_file import known_to_bytes, observations_from_bytes
from algorithms.observations.observation import Observation, encounter
from app.model.observation_draft import ObservationDraft

metres, angles = st.floats(-50, 50), st.floats(-3.1, 3.1)
poses = st.builds(Pose2, metres, metres, angles)
observations = st.builds(
    Observation,
    poses,
    metres,
    metres,
    st.floats(0, 30),
    angles,
    st.none() | angles,
    st.floats(0.001, 1),
    st.floats(0.001, 1),
    st.none() | angles,
)


@given(observations)
def test_a_draft_that_nobody_touches_is_the_observation_itself(observation):
    draft = ObservationDraft.of(observation)
    assert draft.observation == observation
    assert draft.missing is None
    assert draft.seen == pytest.approx(encounter(observation).x_ref)


@given(poses, st.tuples(metres, metres), st.tuples(metres, metres), st.none() | angles)
def test_three_places_make_an_observation_that_sees_robot_2_where_it_was_put(observer, seen, was, heading):
    draft = ObservationDraft()
    assert draft.missing == "observer"
    draft = draft.stood(observer)
    assert draft.missing == "seen"
    draft = draft.saw(seen)
    assert draft.missing == "observed"
    assert draft.observation is None
    made = draft.was(was, heading).observation
    assert made is not None
    assert encounter(made).x_ref == pytest.approx(seen, abs=1e-6)
    assert encounter(made).x_mov == pytest.approx(was)
    assert made.observed_heading == heading


@given(observations, poses)
def test_robot_1_moves_and_what_it_saw_stays(observation, elsewhere):
    before = ObservationDraft.of(observation)
    after = before.stood(elsewhere)
    assert after.seen == pytest.approx(before.seen, abs=1e-6)
    assert after.observer == elsewhere


@given(st.lists(observations, min_size=1, max_size=4), poses)
def test_what_is_saved_loads_back_to_the_same(several, elsewhere):
    made = [ObservationDraft.of(o).stood(elsewhere).observation for o in several]
    assert observations_from_bytes("observation.yaml", known_to_bytes(made)) == tuple(made)


def test_what_a_person_places_is_as_uncertain_as_a_hand_and_what_a_file_says_stays():
    placed = ObservationDraft().stood(Pose2()).saw((2.0, 0.0)).was((1.0, 1.0), None).observation
    assert placed is not None
    assert (placed.sigma_range, placed.sigma_bearing) == (0.3, pytest.approx(radians(5)))
    told = Observation(Pose2(), 1.0, 1.0, 2.0, 0.0, sigma_range=0.02, sigma_bearing=0.01)
    assert ObservationDraft.of(told).observation == told
