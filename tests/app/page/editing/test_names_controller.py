"""Names that a person types: what the robots are called from then on, and what no robot can be called."""

from __future__ import annotations

from dataclasses import replace
from unittest.mock import Mock

import pytest
from controls import Controls
from tabs import noting_tab

from algorithms.common.robot_names import RobotNames
from algorithms.methods.steps import Step
from app.model.fleet_state import FleetState
from app.model.merge_inputs import MergeInputs
from app.model.run_state import RunState
from app.page.editing.names_controller import NamesController
from app.page.editing.names_panel import NamesPanel
from app.page.inputs_controller import InputsController
from app.page.run_controller import RunController
from app.page.undo.undo_controller import UndoController
from app.web.cell_quota import CellQuota

REF, MOV = "Robot 1 is called", "Robot 2 is called"


@pytest.fixture
def gui(server) -> Controls:
    return Controls(server.gui)


@pytest.fixture
def tab(inputs, gui):
    tab = noting_tab(inputs)
    tab.panels.names = NamesPanel(gui)
    return tab


@pytest.fixture
def names(tab) -> NamesController:
    runs = Mock(RunController, thread=Mock())
    return NamesController(tab, UndoController(tab, runs, InputsController(tab, runs, CellQuota())))


def typed(gui, names, ref, mov):
    gui.find(REF).value, gui.find(MOV).value = ref, mov
    names.take()


def test_names_go_into_the_inputs_as_a_step_that_can_be_undone_and_the_fields_go_along(gui, tab, names):
    typed(gui, names, "Bob ", "Alice")
    assert tab.state.inputs.names == RobotNames("Bob", "Alice")
    assert tab.history.steps[-1].label == "names: Bob, Alice"
    assert gui.find(REF).value == "Bob "  # who types on is not disturbed
    tab.history.go(0)
    names._undo.restore_current()
    assert tab.state.inputs.names == RobotNames()
    assert (gui.find(REF).value, gui.find(MOV).value) == ("", "")


def test_an_answer_stays_the_answer_when_the_robots_are_called_otherwise(gui, tab, names, result):
    run = RunState(tab.state.config)
    run.add(Step("verdict", result, 0.0))
    tab.history.record("merge", replace(tab.state.snapshot(), goal="merge", outcome=run))
    typed(gui, names, "Bob", "")
    assert tab.state.inputs.names == RobotNames("Bob")
    assert tab.history.snapshot.outcome is run
    assert names._undo._runs.show_answer.call_args.args[0] is run


@pytest.mark.parametrize(
    ("ref", "mov", "said"),
    [("Bob", "Bob", "both robots are called Bob"), ("a/b", "Alice", "is no name for a robot")],
)
def test_what_no_robot_can_be_called_is_told_below_the_fields(gui, tab, names, ref, mov, said):
    typed(gui, names, ref, mov)
    assert said in gui.text().replace("&#x27;", "'")
    assert tab.state.inputs.names == RobotNames()
    typed(gui, names, "Bob", "Alice")
    assert said not in gui.text()


def test_names_stay_as_long_as_a_map_of_theirs_does(tab, names, gui, inputs, small_case):
    typed(gui, names, "Bob", "Alice")
    load = names._undo._inputs.load
    load(MergeInputs.pair(inputs.ref, inputs.mov, name="the same maps"))
    assert tab.state.inputs.names == RobotNames("Bob", "Alice")
    load(MergeInputs.pair(inputs.mov.mirrored(), inputs.ref.mirrored(), name="others"))
    assert tab.state.inputs.names == RobotNames()


def test_a_fleet_has_fields_of_its_own(gui, tab, names):
    (folder,) = gui.of_kind("folder")
    assert folder.visible
    tab.state.update(fleet=Mock(FleetState))
    assert not folder.visible
    typed(gui, names, "Bob", "Alice")
    assert tab.state.inputs.names == RobotNames()
