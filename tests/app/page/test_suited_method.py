"""The method follows what is known, unless a person has chosen another one."""

from __future__ import annotations

from dataclasses import replace
from math import pi

from algorithms.methods.registry import DEFAULT_METHOD, PLANE_METHOD
from app.model.merge_inputs import MergeInputs
from app.page.suited_method import following_method, suited_method


def test_a_sharp_sighting_is_for_the_proven_method_and_anything_else_for_the_plane(inputs):
    (seen,) = inputs.observations
    vague = replace(seen, sigma_range=1.0, sigma_bearing=pi)
    assert suited_method(inputs) == DEFAULT_METHOD
    assert suited_method(inputs.knowing((vague,))) == PLANE_METHOD
    assert suited_method(inputs.knowing(())) == PLANE_METHOD
    assert suited_method(MergeInputs()) == DEFAULT_METHOD


def test_inputs_that_contradict_themselves_still_have_a_method(inputs):
    (seen,) = inputs.observations
    assert suited_method(inputs.knowing((replace(seen, observed_x=1e4),))) == DEFAULT_METHOD


def test_a_method_that_suited_follows_and_one_that_was_chosen_stays(inputs):
    nothing = inputs.knowing((), "nothing")
    assert following_method(DEFAULT_METHOD, inputs, nothing) == PLANE_METHOD
    assert following_method(PLANE_METHOD, nothing, inputs) == DEFAULT_METHOD
    assert following_method(PLANE_METHOD, inputs, inputs.knowing(inputs.observations)) == PLANE_METHOD
    assert following_method("orb", inputs, nothing) == "orb"


def test_a_method_that_needs_a_sighting_gives_way_where_there_is_none(inputs):
    nothing = inputs.knowing((), "nothing")
    assert following_method("spectra-swarm", inputs, nothing) == PLANE_METHOD
    assert following_method("spectra-swarm", inputs, inputs.knowing((), "sighting")) == "spectra-swarm"
