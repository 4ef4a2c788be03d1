"""Undo puts a page back as it was, and works out again only what has been let go of."""

from __future__ import annotations

from dataclasses import replace
from unittest.mock import Mock

import pytest
from tabs import event, noting_tab

from algorithms.methods.steps import Step
from app.model.run_state import RunState
from app.page.inputs_controller import InputsController
from app.page.modes import Mode
from app.page.run_controller import RunController
from app.page.undo.undo_controller import UndoController


@pytest.fixture
def tab(inputs):
    return noting_tab(inputs)


@pytest.fixture
def undo(tab) -> UndoController:
    return UndoController(tab, Mock(RunController, thread=Mock()), Mock(InputsController))


@pytest.fixture
def merged(tab, result):
    """The snapshot of a merge with what came of it."""
    run = RunState(tab.state.config)
    run.add(Step("verdict", result, 0.0))
    return replace(tab.state.snapshot(), goal="merge", outcome=run)


def test_an_outcome_that_is_still_there_is_shown_and_not_run_again(undo, merged, result):
    undo.restore(merged)
    assert undo._runs.show_answer.call_args.args[:2] == (merged.outcome, result)
    undo._runs.thread.request.assert_not_called()


def test_an_outcome_that_was_let_go_of_is_worked_out_again(undo, merged, tab):
    undo.restore(merged.without_outcome())
    (job,) = undo._runs.thread.request.call_args.args
    assert (job.goal, job.seed) == ("merge", merged.seed)


def test_a_mode_that_a_snapshot_asks_for_comes_back_and_nothing_is_run(undo, merged, tab):
    tab.modes.add(Mode(Mock(), resume=lambda snapshot, was_on: True))
    undo.restore(merged.without_outcome())
    undo._runs.thread.request.assert_not_called()


def test_undo_and_redo_by_keys_go_along_the_history_and_stop_at_its_ends(undo, tab, merged):
    tab.history.note(replace(merged, seed=1), "one")
    step = event(tab, "step")
    step(by=-1)
    assert tab.history.position == 0
    step(by=-1)
    assert tab.history.position == 0
    step(by=1)
    assert tab.history.position == 1
    event(tab, "go")(to=99)
    assert tab.history.position == 1


def test_other_inputs_are_loaded_and_the_same_ones_stay_as_they_lie(undo, tab, merged, inputs):
    undo.restore(merged)
    undo._inputs.show.assert_not_called()
    other = replace(inputs, name="other")
    undo.restore(replace(merged, inputs=other))
    undo._inputs.show.assert_called_once_with(other)
