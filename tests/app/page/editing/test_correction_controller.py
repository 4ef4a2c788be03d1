"""The merged map is corrected on the page: rules, places of the list, tools, and the way back."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from controls import Controls
from tabs import event, noting_tab

from algorithms.maps.grid_map import OCCUPIED
from algorithms.maps.map_corrections import NO_CORRECTIONS, Corrections
from algorithms.maps.map_fusion import ConflictRule
from algorithms.methods.steps import Step
from algorithms.verdict.contradictions import Contradiction, find_conflicts
from app.model.run_state import RunState
from app.page.editing.correction_controller import CorrectionController
from app.page.editing.correction_panel import CorrectionPanel
from app.report.result_files import ResultFiles

PLACE = Contradiction(1.0, 2.0, 0.5, 1.0, 0.0)


@pytest.fixture
def gui(server) -> Controls:
    return Controls(server.gui)


class Export(SimpleNamespace):
    """The export's panel, but for its downloads."""

    def reframe(self, harvest: ResultFiles) -> None:
        self.harvest = harvest


@pytest.fixture
def tab(inputs, result, gui):
    """A tab with an answer, and what it looks at noted in ``looked``."""
    tab = noting_tab(inputs)
    tab.events.then.side_effect = lambda callback, *args: callback(*args)
    tab.panels.correction = CorrectionPanel(gui)
    tab.panels.export = Export(harvest=ResultFiles(result, inputs, None), offered=lambda: None)
    tab.display.messages.said.return_value = {"state": "Merged.", "mood": "accepted"}
    run = RunState(tab.state.config)
    run.add(Step("verdict", result, 0.0))
    found = replace(find_conflicts(result.fusion), places=(PLACE,))
    tab.history.record("merge", replace(tab.state.snapshot(), goal="merge", outcome=run))
    CorrectionController(tab, tab.display.compare)
    tab.state.update(run=run, result=result, contradictions=found)
    return tab


def draws(tab, id_, *points):
    """A drag over the map, in metres of map 1's frame."""
    at = (np.array(points) - tab.display.views.map.layout.anchor_ref).ravel().tolist()
    event(tab, "draw")(id=id_, points=at)


def choose(gui, label, value):
    handle = gui.find(label)
    handle.value = value
    for callback in handle._impl.update_cb:
        callback(SimpleNamespace(client_id=0, target=handle))


def said(tab) -> list[str]:
    return [step.label for step in tab.history.steps]


def test_a_rule_is_a_step_of_its_own_that_keeps_the_answer_and_shows_the_merged_map(gui, tab):
    choose(gui, "Contradictions", "map 2 counts")
    assert tab.state.corrections == Corrections(ConflictRule.MOV_WINS)
    assert tab.panels.export.harvest.corrections == tab.state.corrections
    assert said(tab)[-1] == "contradictions: map 2 counts"
    assert tab.history.snapshot.outcome is tab.state.run
    tab.display.compare.assert_called_with("result")
    choose(gui, "Contradictions", "a wall counts")  # as it was merged
    assert tab.state.corrections == NO_CORRECTIONS
    choose(gui, "Contradictions", "the newer map counts")
    assert "Which map is newer is not known" in gui.text()


def test_a_place_of_the_list_is_chosen_and_let_go_of_by_pressing_it_again(tab):
    keep = event(tab, "keep")
    keep(n=1, does="map2")
    assert tab.state.corrections.chosen_at((1.0, 2.0)) == "map2"
    keep(n=1, does="unknown")
    assert [edit.does for edit in tab.state.corrections.edits] == ["unknown"]
    assert said(tab)[-1] == "place left unknown"
    keep(n=1, does="unknown")
    keep(n=7, does="map1")  # there is no such place
    assert tab.state.corrections == NO_CORRECTIONS


def test_a_tool_draws_while_it_is_taken_up_and_every_drag_can_be_undone_by_itself(gui, tab):
    draws(tab, "line", (0, 0), (1, 1))  # nobody took it up
    assert tab.state.corrections == NO_CORRECTIONS
    gui.press("Draw a keep-out line")
    assert tab.display.messages.hand.call_args.args == ({"draw": {"id": "line", "r": 0.0}},)
    draws(tab, "line", (0, 0), (1, 1))
    draws(tab, "line", (0, 1), (1, 0))
    assert said(tab)[-2:] == ["keep-out line", "keep-out line"]
    wall = tab.panels.export.harvest.corrected.grid
    assert wall.value_at(np.array([0.5, 0.5])) == OCCUPIED
    choose(gui, "Brush (m)", 0.6)
    gui.press("Erase with a brush")
    assert tab.display.messages.hand.call_args.args == ({"draw": {"id": "brush", "r": 0.3}},)
    draws(tab, "brush", (0.5, 0.5))
    assert tab.panels.export.harvest.corrected.grid.value_at(np.array([0.5, 0.5])) != OCCUPIED
    gui.press("Erase a rectangle")
    draws(tab, "box", (0, 0), (1, 1))
    assert tab.state.corrections.edits[-1].box
    event(tab, "cancel")()
    assert tab.modes.current is None
    assert tab.display.messages.hud.call_args.kwargs == {"state": "Merged.", "mood": "accepted"}
    gui.press("Take all corrections back")
    assert tab.state.corrections == NO_CORRECTIONS
    assert said(tab)[-1] == "all corrections taken back"


def test_a_drag_off_any_map_is_reported_and_changes_nothing(gui, tab):
    gui.press("Erase a rectangle")
    draws(tab, "box", (0, 0), (1e8, 1))
    assert "correction" in str(tab.notices.report.call_args.args[0])
    assert tab.state.corrections == NO_CORRECTIONS


def test_cropping_is_undone_and_told(gui, tab):
    choose(gui, "Crop to known", True)
    assert tab.state.corrections.crop
    assert said(tab)[-1] == "crop to known"
    assert "cropped to what is known" in gui.text()


def test_walls_left_around_the_robots_are_offered_and_erased_at_a_press(gui, tab, inputs):
    here = inputs.observations[0].observer.xy
    gui.press("Draw a keep-out line")
    draws(tab, "line", here - 0.1, here + 0.1)  # stands for a ghost
    around = gui.find("Erase what is left around the robots")
    assert around.visible
    assert "cells)" in around.label
    gui.press("Erase what is left around the robots")
    assert tab.panels.export.harvest.corrected.grid.value_at(here) != OCCUPIED
    assert not around.visible


def test_while_there_is_no_answer_nothing_is_corrected(gui, tab):
    tab.panels.export.harvest = None
    tab.state.update(result=None)
    assert not gui.of_kind("folder")[-1].visible
    event(tab, "keep")(n=1, does="map1")
    choose(gui, "Crop to known", True)
    assert tab.state.corrections == NO_CORRECTIONS


def test_who_takes_a_step_back_while_erasing_goes_on_erasing(gui, tab):
    gui.press("Erase with a brush")
    snapshot, mode = tab.history.snapshot, tab.modes.close()
    assert tab.modes.resume(snapshot, mode)
    assert tab.modes.current is mode
