"""The charts follow a run, and never turn to a page that has nothing to show."""

from __future__ import annotations

from types import SimpleNamespace
from unittest.mock import MagicMock, Mock

import pytest

from algorithms.methods.registry import METHODS, PLANE_METHOD, run
from algorithms.methods.steps import Step
from app.model.run_state import RunState
from app.model.step_table import SHIFT, TURN
from app.page.panels.chart_widgets import nothing
from app.page.panels.charts_panel import ChartsPanel

SPECTRA = "spectra-swarm"


def widget(*_: object, **__: object) -> SimpleNamespace:
    return SimpleNamespace(content="", visible=True, data=nothing(2), scales=None, title="")


@pytest.fixture
def panel() -> ChartsPanel:
    gui = MagicMock()
    gui.add_html.side_effect = gui.add_uplot.side_effect = widget
    panel = ChartsPanel(Mock(gui=gui), Mock())
    panel.research(True)
    return panel


@pytest.fixture(scope="module")
def runs(small_case) -> dict[str, list[Step]]:
    """A run without a sighting, and one with spectra."""
    known = {PLANE_METHOD: (), SPECTRA: small_case.observations}
    return {name: list(run(name, small_case.ref, small_case.mov, seen)) for name, seen in known.items()}


def told(panel: ChartsPanel, steps: list[Step], method: str) -> RunState:
    """A whole run, shown step by step."""
    story = RunState(METHODS[method].defaults)
    for step in steps:
        story.add(step)
        panel.show(story, follow=True)
    return story


def shown(panel: ChartsPanel) -> set[str]:
    """Names of what is seen on the page at hand."""
    return {name for handle, _, name in panel._widgets if handle.visible}


def test_a_search_over_the_plane_shows_every_turn_and_the_surface_of_the_turn_at_hand(panel, runs):
    story, turns = RunState(METHODS[PLANE_METHOD].defaults), []
    for step in runs[PLANE_METHOD]:
        story.add(step)
        panel.show(story, follow=True)
        if step.stage == "correlate":
            assert panel.page == TURN
            assert shown(panel) == {"circle", "surface"}
            turns.append(panel._surface.content.split("Δθ = ")[1].split("<")[0])
    assert len(set(turns)) == len(turns) > 10


def test_no_page_that_such_a_run_turns_to_is_empty(panel, runs):
    story, begun = RunState(METHODS[PLANE_METHOD].defaults), False
    for step in runs[PLANE_METHOD][:-1]:
        story.add(step)
        panel.show(story, follow=True)
        begun = begun or step.stage == "correlate"
        assert bool(shown(panel)) is begun
    panel.tell("the verdict")
    panel.show(story, follow=True)
    assert not panel._hint.visible


def test_after_the_search_the_surface_is_that_of_the_best_turn(panel, runs):
    story = told(panel, runs[PLANE_METHOD], PLANE_METHOD)
    assert f"Δθ = {story.plane.picture.turn * 180 / 3.141592653589793:.1f}".replace("-", "−") in (
        panel._surface.content
    )
    assert story.plane.values[0] == max(detail.detail.values[0] for detail in runs[PLANE_METHOD][1:16])
    panel.page = SHIFT
    panel.show(story, follow=False)
    assert shown(panel) == {"surface"}


def test_of_a_run_before_nothing_is_left_beside_another_kind_of_run(panel, runs):
    told(panel, runs[SPECTRA], SPECTRA)
    told(panel, runs[PLANE_METHOD], PLANE_METHOD)
    panel.page = TURN
    panel._show_page()
    assert shown(panel) == {"circle", "surface"}
    told(panel, runs[SPECTRA], SPECTRA)
    panel.page = TURN
    panel._show_page()
    assert shown(panel) == {"hough", "turns"}
