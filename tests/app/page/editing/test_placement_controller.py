"""Three touches of the maps make an observation; every sign can be put elsewhere afterwards."""

from __future__ import annotations

from unittest.mock import Mock

import numpy as np
import pytest
from tabs import event, noting_tab

from app.drawing.scene_layout import lay_out
from app.model.merge_inputs import MergeInputs
from app.page.editing.placement_controller import PlacementController
from app.page.inputs_controller import InputsController
from app.page.run_controller import RunController
from app.page.undo.undo_controller import UndoController


@pytest.fixture
def tab(inputs):
    return noting_tab(MergeInputs.pair(inputs.ref, inputs.mov).knowing((), "sighting"))


@pytest.fixture
def placing(tab) -> PlacementController:
    loads = Mock(InputsController)
    loads.forget_results = lambda inputs: tab.state.update(inputs=inputs)
    undo = Mock(UndoController, history=tab.history)
    made = PlacementController(tab, undo, Mock(RunController, thread=Mock()), loads)
    press(tab, 0)
    assert made.active
    return made


def press(tab, which: int) -> None:
    """Press a button of the panel: 0 begin or end, 3 add, 4 remove."""
    tab.panels.knowledge.observation.connect.call_args.args[which]()


def drop(tab, sign: str, point, heading: float | None = None) -> None:
    """Put a sign at a point of its map."""
    layout = lay_out(tab.state.inputs.ref, tab.state.inputs.mov, None)
    anchor = layout.anchor_mov if sign == "observed" else layout.anchor_ref
    at = (np.array(point) - anchor).tolist()
    event(tab, "drop")(id=sign, at=at, heading=[] if heading is None else [heading])


def place_all(tab, seen) -> None:
    """The three touches that make this observation."""
    o = seen.observations[0]
    drop(tab, "observer", (o.observer.x, o.observer.y), o.observer.theta)
    drop(tab, "seen", seen.at.x_ref)
    drop(tab, "observed", (o.observed_x, o.observed_y))


def test_three_touches_make_the_observation_that_they_show(placing, tab, inputs):
    place_all(tab, inputs)
    (made,) = tab.state.inputs.observations
    true = inputs.observations[0]
    assert (made.observer.x, made.observer.y) == pytest.approx((true.observer.x, true.observer.y))
    assert MergeInputs.pair(inputs.ref, inputs.mov, (made,)).at.x_ref == pytest.approx(inputs.at.x_ref)
    assert tab.history.steps[-1].label == "observation by hand"
    assert tab.panels.run.merge.disabled is False


def test_a_touch_beside_the_map_is_refused_with_a_word(placing, tab):
    drop(tab, "observer", (1e4, 0.0))
    assert "not in map 1" in tab.panels.knowledge.observation.edit.call_args.args[2]
    assert tab.state.inputs.observations == ()


def test_escape_drops_a_half_placed_observation_and_leaves_a_whole_one(placing, tab, inputs):
    place_all(tab, inputs)
    event(tab, "cancel")()
    assert len(tab.state.inputs.observations) == 1
    press(tab, 3)
    drop(tab, "observer", (inputs.observations[0].observer.x, inputs.observations[0].observer.y))
    event(tab, "cancel")()
    assert len(tab.state.inputs.observations) == 1
    press(tab, 4)
    assert tab.state.inputs.observations == ()


def test_only_whole_observations_can_be_saved(placing, tab, inputs):
    tab.panels.knowledge.savable.assert_called_with(False)
    place_all(tab, inputs)
    tab.panels.knowledge.savable.assert_called_with(True)


def test_done_shows_everything_as_usual(placing, tab, inputs):
    place_all(tab, inputs)
    press(tab, 0)
    assert not placing.active
    placing._inputs.show.assert_called_once_with(tab.state.inputs)
    placing._undo.restore_current.assert_called_once_with()
