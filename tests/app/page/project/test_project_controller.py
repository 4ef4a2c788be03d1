"""A tab's work leaves it as a file, and another tab goes on with it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from wire import WireFile, WireTab, until

from algorithms.files.case_folder import Case
from algorithms.fleets.pair_hypotheses import Hypothesis, PairFinding, PairOrder
from algorithms.methods.merge_result import BY_HAND
from algorithms.observations.fleet import Fleet, FleetSighting
from app.model.fleet_state import FleetState
from app.model.merge_inputs import Files, MergeInputs
from app.page.application import make_server
from app.page.page_state import PageState
from app.page.project.project_file import project_from_bytes, project_to_bytes
from app.page.undo.undo_history import SavedTab, UndoStep


@pytest.fixture(scope="module")
def server(small_case: Case):
    server = make_server(port=0, initial=small_case)
    yield server
    server.stop()


def opened(tab: WireTab, name: str, content: bytes) -> None:
    """Give the tab a file, as by the button for it."""
    file = WireFile(tab, "Open files…", name, content)
    file.part(len(content))
    assert file.over()
    tab.tell("sent", button=tab.find("Open files…"), count=1, whole=True, days=[])


def test_an_answer_that_was_taken_by_hand_is_there_again_in_another_tab_with_all_that_was_done(server):
    tab = WireTab(server.get_port())
    tab.choose("Instant")
    tab.press("Move map 2 by hand")
    until(lambda: tab.state.startswith("By hand, would be"), "map 2 in the hand")
    held = tab.state
    tab.press("Take this as the answer")
    until(lambda: tab.state.startswith("By hand. "), "the answer")
    said = tab.state
    tab.press("Save project")
    (name, content) = until(lambda: next(iter(tab.files.items()), None), "the project")
    assert name.endswith(".mapmeld")
    saved = project_from_bytes(name, content)
    assert saved.steps[-1].snapshot.taken == BY_HAND
    tab.close()

    other = WireTab(server.get_port())
    opened(other, name, content)
    until(lambda: other.state == said, "the answer")
    other.tell("step", by=-1)
    until(lambda: other.state == held, "map 2 in the hand")
    other.tell("step", by=-1)
    until(lambda: other.state.startswith("Ready"), "the beginning")
    opened(other, "broken.mapmeld", content[:-40])
    until(lambda: other.notices("This cannot be used"), "what is wrong with it")
    assert other.state.startswith("broken.mapmeld: is no zip")
    other.close()


def test_a_server_opens_with_a_project_and_puts_a_fleet_together_again(small_case):
    order = PairOrder("a", "b", (0,))
    fleet = Fleet(
        {"a": small_case.ref, "b": small_case.mov}, (FleetSighting("a", "b", small_case.observations[0]),)
    )
    T = small_case.truth.T_ref_mov
    answer = Hypothesis(T, np.diag([1e-4, 1e-4, 1e-6]), 0.999, 7.0)
    state = FleetState(fleet, "two").with_finding(
        PairFinding(order, np.zeros(2), (answer,), "fits", accepted=True)
    )
    page = replace(PageState().snapshot(), inputs=MergeInputs(name="two"), files=Files(), fleet=state)
    saved = SavedTab(
        (UndoStep("load two", page), UndoStep("merge", replace(page, fleet=replace(state, again=True)))), 1
    )
    server = make_server(port=0, initial=project_from_bytes("two", project_to_bytes(saved)))
    try:
        tab = WireTab(server.get_port())
        until(lambda: tab.state.startswith("2 of 2 robots"), "the fleet")
        tab.tell("step", by=-1)
        until(lambda: tab.state.startswith("A fleet of 2 robots."), "the fleet before it was merged")
        tab.close()
    finally:
        server.stop()
