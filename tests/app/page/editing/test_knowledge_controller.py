"""What is known is chosen, typed and moved on the map; each is a step that can be undone."""

from __future__ import annotations

from collections.abc import Callable
from unittest.mock import Mock

import numpy as np
import pytest
from tabs import noting_tab

from algorithms.common.pose import Pose2
from algorithms.observations.priors import InitialPose, NearPlace, TurnPrior
from app.page.editing.knowledge_controller import KnowledgeController
from app.page.inputs_controller import InputsController
from app.page.run_controller import RunController
from app.page.undo.undo_controller import UndoController

CHOOSE, TYPE, MOVE, SAVE = range(4)


@pytest.fixture
def tab(inputs):
    return noting_tab(inputs)


@pytest.fixture
def robots() -> Mock:
    """Begins to place the robots."""
    return Mock()


@pytest.fixture
def knowing(tab, robots) -> KnowledgeController:
    loads = Mock(InputsController)

    def show(inputs) -> bool:
        tab.state.update(inputs=inputs)
        return True

    loads.show = show
    loads.forget_results = show
    tab.events.then = lambda callback, *args: callback(*args)
    undo = Mock(UndoController, history=tab.history)
    return KnowledgeController(tab, undo, Mock(RunController, thread=Mock()), loads, robots)


def ask(tab, which: int, *args: object) -> None:
    """What the panel asks for."""
    tab.panels.knowledge.connect.call_args.args[which](*args)


def tell(tab, name: str, **fields: object) -> None:
    """What the browser tells, to everyone who listens."""
    for call in tab.events.on.call_args_list:
        listens: Callable[..., None] = call.args[1]
        if call.args[0] == name:
            listens(**fields)


def test_nothing_leaves_the_sighting_aside_and_choosing_it_again_brings_it_back(knowing, tab, inputs):
    ask(tab, CHOOSE, "nothing")
    assert tab.state.inputs.known == ()
    assert tab.state.inputs.complete
    assert tab.history.steps[-1].label == "known: nothing"
    ask(tab, CHOOSE, "sighting")
    assert tab.state.inputs.known == inputs.known


def test_a_sighting_that_is_not_there_is_placed_by_hand(knowing, tab, robots, inputs):
    tab.state.update(inputs=inputs.knowing((), "nothing"))
    ask(tab, CHOOSE, "sighting")
    robots.assert_called_once_with()


def test_a_pose_counts_once_map_2_was_laid_somewhere(knowing, tab):
    ask(tab, CHOOSE, "initial")
    assert knowing.active
    assert not tab.state.inputs.complete
    tell(tab, "put", x=1.0, y=-2.0, theta=0.5, knew=0)
    (known,) = tab.state.inputs.known
    assert isinstance(known, InitialPose)
    assert known.pose.theta == pytest.approx(0.5)
    at = known.pose.apply(known.about) - knowing._layout.anchor_ref
    assert at == pytest.approx((1.0, -2.0))
    assert tab.state.inputs.complete
    assert tab.history.steps[-1].label == "a rough initial pose by hand"


def test_while_map_2_is_on_its_way_nothing_is_known_yet(knowing, tab):
    ask(tab, CHOOSE, "initial")
    steps = len(tab.history.steps)
    tell(tab, "carry", x=1.0, y=-2.0, theta=0.5)
    assert tab.state.inputs.known == ()
    assert len(tab.history.steps) == steps


def test_a_turn_counts_at_once_and_only_turns(knowing, tab):
    ask(tab, CHOOSE, "turn")
    assert tab.state.inputs.known == (TurnPrior(0.0),)
    tell(tab, "put", x=100.0, y=50.0, theta=-0.25, knew=0)
    assert tab.state.inputs.known == (TurnPrior(-0.25),)
    at = tab.display.views.map.hold.call_args.args[0]
    assert (at.x, at.y) == (knowing._layout.apart.x, knowing._layout.apart.y)


def test_each_ring_of_a_place_is_put_into_its_own_map(knowing, tab):
    ask(tab, CHOOSE, "near")
    anchors = knowing._layout.anchors
    tell(tab, "drop", id="near1", at=[0.5, 0.25], heading=[])
    tell(tab, "drop", id="near2", at=[-1.0, 2.0], heading=[])
    (known,) = tab.state.inputs.known
    assert isinstance(known, NearPlace)
    assert (known.ref_x, known.ref_y) == pytest.approx(tuple(anchors[0] + (0.5, 0.25)))
    assert (known.mov_x, known.mov_y) == pytest.approx(tuple(anchors[1] + (-1.0, 2.0)))


def test_a_typed_number_counts_whether_it_is_moved_on_the_map_or_not(knowing, tab):
    ask(tab, CHOOSE, "turn")
    ask(tab, TYPE, "yaw", 0.75)
    assert tab.state.inputs.known == (TurnPrior(0.75),)
    ask(tab, MOVE)  # done
    assert not knowing.active
    ask(tab, TYPE, "s_yaw", 0.5)
    assert tab.state.inputs.known == (TurnPrior(0.75, 0.5),)


def test_a_number_that_cannot_be_is_told_and_changes_nothing(knowing, tab):
    ask(tab, CHOOSE, "turn")
    before = tab.state.inputs
    ask(tab, TYPE, "s_yaw", -1.0)
    assert "must be" in tab.panels.knowledge.tell.call_args.args[0]
    assert tab.state.inputs is before


def test_everything_together_is_used_where_that_is_chosen(knowing, tab, inputs):
    ask(tab, CHOOSE, "turn")
    ask(tab, CHOOSE, "all")
    assert set(tab.state.inputs.known) == {*inputs.observations, TurnPrior(0.0)}


def test_what_is_known_is_saved_as_a_file_that_reads_back(knowing, tab):
    ask(tab, CHOOSE, "nothing")
    ask(tab, SAVE)
    tab.panels.send.assert_not_called()
    ask(tab, CHOOSE, "turn")
    ask(tab, SAVE)
    name, content = tab.panels.send.call_args.args
    assert name == "observation.yaml"
    assert content.startswith(b"turn: ")


def test_the_pose_that_is_offered_lays_the_middles_of_both_maps_on_each_other(knowing, tab):
    ask(tab, CHOOSE, "initial")
    at = tab.display.views.map.hold.call_args.args[0]
    layout = knowing._layout
    middles = [corners.mean(axis=0) for corners in layout.corners]
    laid = Pose2(at.x, at.y, at.theta).apply(middles[1])
    assert np.allclose(laid, middles[0])
