"""The state of a tab tells its subscribers of what they subscribed to, and says what a merge would do."""

from __future__ import annotations

from unittest.mock import Mock

import pytest

from algorithms.methods.registry import METHODS
from app.drawing.palette import DARK
from app.model.merge_inputs import MergeInputs
from app.page.page_state import PageState


def test_a_subscriber_is_called_after_changes_of_its_topic_alone(inputs):
    state, setup, palette = PageState(), Mock(), Mock()
    state.subscribe("setup", lambda: setup(state.inputs, state.seed))
    state.subscribe("palette", palette)
    state.update(inputs=inputs, seed=3, goal="merge")
    setup.assert_called_once_with(inputs, 3)  # once, with all of it
    palette.assert_not_called()
    state.update(palette=DARK)
    palette.assert_called_once_with()


@pytest.mark.parametrize("lacking", ["maps", "observation"])
def test_there_is_no_job_while_an_input_is_missing(inputs, lacking):
    held = inputs.knowing((), "sighting") if lacking == "observation" else MergeInputs()
    assert PageState(held).job() is None
    job = PageState(inputs, seed=5).job(pace=2.0)
    assert (job.ref, job.mov, job.known) == (inputs.ref, inputs.mov, inputs.observations)
    assert (job.seed, job.pace) == (5, 2.0)


def test_a_method_that_is_not_the_chosen_one_runs_with_its_defaults():
    mine = METHODS["mse"].defaults
    state = PageState(method="mse", config=object())
    assert state.config_for("mse") is state.config
    assert state.config_for("sift") == METHODS["sift"].defaults
    assert PageState(method="mse", config=mine).snapshot().config is mine
