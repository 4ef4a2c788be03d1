"""Methods compared on the loaded pair: what was found stays as long as the pair does."""

from __future__ import annotations

from time import monotonic, sleep
from unittest.mock import Mock

import pytest
from tabs import event, noting_tab

from app.jobs.executor import SerialExecutor
from app.model.merge_inputs import MergeInputs
from app.page.research.comparison_controller import ComparisonController
from app.page.research.other_result_controller import OtherResultController

METHOD = "paper-argmax"


@pytest.fixture
def tab(inputs):
    return noting_tab(inputs)


@pytest.fixture
def others() -> Mock:
    return Mock(OtherResultController)


@pytest.fixture
def deliver() -> Mock:
    return Mock()


@pytest.fixture
def comparison(tab, others, deliver) -> ComparisonController:
    made = ComparisonController(
        tab.state, tab.panels.comparison, tab.events, others, deliver, lambda jobs: SerialExecutor()
    )
    tab.panels.comparison.connect.call_args.args[2](None)  # no group: nothing is ticked
    event(tab, "pick")(method=METHOD, yes=True)
    yield made
    made.close()


def press(tab, which: int) -> None:
    """Press a button of the panel: 0 run, 1 stop, 3 save."""
    tab.panels.comparison.connect.call_args.args[which]()


def card(tab):
    return tab.panels.comparison.show.call_args.args[0][METHOD]


def compared(tab) -> None:
    """Run the ticked method, and wait for its end."""
    press(tab, 0)
    end = monotonic() + 60
    while card(tab).state != "done":
        assert monotonic() < end
        sleep(0.02)


def test_a_ticked_method_is_run_and_its_card_says_what_came_of_it(comparison, tab):
    assert card(tab).chosen
    compared(tab)
    assert card(tab).outcome is not None
    assert card(tab).picture.startswith("data:image/png")
    assert card(tab).old == ""


def test_a_card_is_out_of_date_with_another_seed_and_gone_with_another_pair(comparison, tab, inputs):
    compared(tab)
    tab.state.update(seed=4)
    assert card(tab).old
    tab.state.update(seed=0)
    assert not card(tab).old
    tab.state.update(inputs=MergeInputs.pair(inputs.mov, inputs.ref, inputs.observations))
    assert card(tab).state == "idle"


def test_a_pressed_card_is_looked_at_and_pressed_again_left(comparison, tab, others):
    show = event(tab, "show")
    show(method=METHOD)
    others.look.assert_not_called()  # nothing was found yet
    compared(tab)
    show(method=METHOD)
    (found,) = others.look.call_args.args
    tab.state.update(other=found)
    assert card(tab).shown
    show(method=METHOD)
    others.back.assert_called_once_with()


def test_a_reloaded_tab_takes_up_what_was_found_on_the_same_pair_only(
    comparison, tab, inputs, others, deliver
):
    compared(tab)
    for held, kept in ((inputs, True), (MergeInputs.pair(inputs.mov, inputs.ref), False)):
        again = noting_tab(held)
        fresh = ComparisonController(again.state, again.panels.comparison, again.events, others, deliver)
        fresh.resume(comparison.found)
        assert (card(again).state == "done") is kept


def test_there_is_nothing_to_save_before_anything_was_found(comparison, tab, deliver):
    press(tab, 3)
    deliver.assert_not_called()
    compared(tab)
    press(tab, 3)
    assert deliver.call_args.args[1] == "compared.zip"
