"""Loading puts inputs in place of everything there was, or leaves everything as it is."""

from __future__ import annotations

from unittest.mock import Mock

import pytest
from tabs import noting_tab

from algorithms.common.errors import TooLargeError
from algorithms.observations.fleet import Fleet
from app.model.fleet_state import FleetState
from app.model.merge_inputs import MergeInputs
from app.page.inputs_controller import InputsController
from app.page.modes import Mode
from app.page.run_controller import RunController
from app.web.cell_quota import CellQuota


@pytest.fixture
def tab(inputs):
    return noting_tab(inputs)


def controller(tab, quota=None) -> InputsController:
    return InputsController(tab, Mock(RunController, thread=Mock()), quota or CellQuota())


def test_what_was_found_on_other_maps_is_forgotten_and_can_be_undone(tab, inputs, result):
    tab.state.update(result=result, goal="merge", contradictions=Mock())
    other = MergeInputs.pair(inputs.mov, inputs.ref, inputs.observations, "swapped")
    controller(tab).load(other)
    state = tab.state
    assert state.inputs is other
    assert (state.result, state.goal, state.contradictions) == (None, None, None)
    assert tab.history.steps[-1].label == "load swapped"
    assert tab.display.show_inputs.called


def test_what_more_is_known_of_a_fleets_pair_leaves_the_fleet_there_and_other_maps_do_not(tab, inputs):
    tab.state.update(fleet=FleetState(Fleet({"r1": inputs.ref, "r2": inputs.mov})))
    controller(tab).load(inputs.knowing(()), "remove o.yaml")
    assert tab.state.fleet is not None
    assert tab.history.steps[-1].label == "remove o.yaml"
    controller(tab).load(MergeInputs.pair(inputs.mov, inputs.ref))
    assert tab.state.fleet is None


def test_maps_that_are_too_large_are_reported_and_what_is_on_the_page_stays(tab, inputs):
    quota = Mock(CellQuota)
    quota.claim.side_effect = TooLargeError("too many cells")
    controller(tab, quota).load(MergeInputs.pair(inputs.mov, inputs.ref, (), "large"))
    assert tab.notices.report.called
    assert tab.state.inputs is inputs
    assert len(tab.history.steps) == 1


def test_a_lesson_goes_on_with_other_maps_and_any_other_mode_ends(tab, inputs):
    loads, end, reopen = controller(tab), Mock(), Mock()
    tab.modes.enter(tab.modes.add(Mode(end, reopen=reopen)))
    loads.load(inputs)
    reopen.assert_called_once_with()
    tab.modes.enter(tab.modes.add(Mode(end)))
    loads.load(inputs)
    assert tab.modes.current is None
    assert end.call_count == 2
    assert reopen.call_count == 1


def test_a_tab_that_is_gone_loads_nothing_and_gives_its_cells_back(tab, inputs):
    quota = Mock(CellQuota)
    loads = controller(tab, quota)
    tab.state.closed = True
    assert not loads.show(inputs)
    quota.claim.assert_not_called()
    loads.close()
    quota.release.assert_called_once_with(loads)
