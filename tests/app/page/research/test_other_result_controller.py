"""Another method's result is looked at, and the page's own comes back."""

from __future__ import annotations

from contextlib import nullcontext
from unittest.mock import Mock

import pytest
from tabs import event, noting_tab

from algorithms.files.case_folder import Case
from app.evaluation.method_run import run_method
from app.page.modes import Mode
from app.page.research.other_result import OtherResult
from app.page.research.other_result_controller import OtherResultController
from app.page.run_controller import RunController
from app.page.undo.undo_controller import UndoController


@pytest.fixture(scope="module")
def found(small_case: Case) -> OtherResult:
    config = noting_tab().state.config_for("paper-argmax")
    return OtherResult("paper-argmax", config, 0, run_method(small_case, "paper-argmax", config, 0, None))


@pytest.fixture
def tab(inputs):
    tab = noting_tab(inputs)
    tab.panels.task = Mock(side_effect=lambda words: nullcontext(lambda: None))
    return tab


@pytest.fixture
def others(tab) -> OtherResultController:
    undo = Mock(UndoController, history=tab.history)
    return OtherResultController(tab, undo, Mock(RunController, thread=Mock()))


def test_it_lies_over_map_1_nothing_of_it_can_be_taken_and_undo_goes_back(others, tab, found):
    own = tab.history.snapshot
    others.look(found)
    assert tab.state.other is found
    assert tab.state.run.answer == found.pose
    assert "another method" in str(tab.panels.export.outdate.call_args)
    assert tab.history.snapshot.other is found
    event(tab, "back")()
    snapshot, _ = others._undo.go_to.call_args.args
    assert snapshot.other is None
    assert snapshot.inputs is own.inputs


def test_another_mode_takes_its_place(others, tab, found):
    others.look(found)
    tab.modes.enter(tab.modes.add(Mode(Mock())))
    assert tab.state.other is None


def test_a_snapshot_with_it_brings_it_back(others, tab, found):
    others.look(found)
    snapshot = tab.history.snapshot
    tab.modes.close()
    assert tab.modes.resume(snapshot, None)
    assert tab.state.other is found


def test_other_maps_that_come_meanwhile_are_left_alone(others, tab, found, inputs):
    def task(words):
        tab.state.inputs = noting_tab().state.inputs
        return nullcontext(lambda: None)

    tab.panels.task = task
    merged = others._merged_by(found)
    others._merged_by = lambda other: merged
    others.look(found)
    assert tab.state.other is None
