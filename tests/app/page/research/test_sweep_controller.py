"""A setting swept on the loaded pair: its points come one by one, and each can be put into the sliders."""

from __future__ import annotations

from time import monotonic, sleep
from unittest.mock import Mock

import pytest
from tabs import event, noting_tab

from app.jobs.executor import SerialExecutor
from app.model.merge_inputs import MergeInputs
from app.page.research.sweep_controller import SweepController
from app.page.research.sweep_request import Wanted
from app.page.run_controller import RunController


@pytest.fixture
def tab(inputs):
    tab = noting_tab(inputs)
    fields = Mock(untouched=True)
    fields.setting.value = ""
    fields.offer = lambda labels, chosen: setattr(fields.setting, "value", chosen)
    second = Mock(wanted=None)
    second.setting.value = "none"
    tab.panels.sweep.axes = (fields, second)
    tab.panels.sweep.seeds, tab.panels.sweep.measure = 1, "Agreement"
    return tab


@pytest.fixture
def runs() -> Mock:
    return Mock(RunController)


@pytest.fixture
def sweep(tab, runs):
    tab.state.update(method="paper-argmax", config=tab.state.config_for("paper-argmax"))
    made = SweepController(
        tab.state, tab.panels.sweep, Mock(), tab.events, runs, Mock(), lambda jobs: SerialExecutor()
    )
    first = tab.panels.sweep.axes[0]
    spread = tab.state.config.augment.spread
    first.wanted = Wanted(first.setting.value, spread - 1, spread + 1, 3, False)
    yield made
    made.close()


def swept(tab, count: int = 3):
    """Run the sweep, and wait for so many points."""
    tab.panels.sweep.connect.call_args.args[0]()
    end = monotonic() + 60
    while f"{count} of 3" not in said(tab) or "took" not in said(tab):
        assert monotonic() < end, said(tab)
        sleep(0.02)


def said(tab) -> str:
    call = tab.panels.sweep.say.call_args
    return call.args[0] if call else ""


def test_the_spread_is_offered_first_and_every_point_of_its_range_is_merged(sweep, tab):
    assert "spread" in tab.panels.sweep.axes[0].setting.value
    swept(tab)
    _, rows, here = tab.panels.sweep.points.call_args.args
    assert [n for n, _ in rows] == [0, 1, 2]
    assert here == 1  # in the middle is what the sliders have


def test_a_pressed_point_puts_its_settings_into_the_sliders(sweep, tab, runs):
    load = event(tab, "point")
    load(n=0)
    runs.load_settings.assert_not_called()
    swept(tab)
    load(n=2)
    method, config = runs.load_settings.call_args.args
    assert (method, config.augment.spread) == ("paper-argmax", tab.state.config.augment.spread + 1)


def test_a_setting_that_cannot_be_swept_so_is_said_and_nothing_runs(sweep, tab):
    first = tab.panels.sweep.axes[0]
    first.wanted = Wanted(first.setting.value, 5.0, 3.0, 3, False)
    tab.panels.sweep.connect.call_args.args[0]()
    assert said(tab)
    assert sweep.swept[2] is None


def test_another_pair_forgets_the_sweep_and_another_setting_does_not(sweep, tab, inputs):
    swept(tab)
    tab.state.update(seed=3)
    assert len(sweep.swept[3]) == 3
    tab.state.update(inputs=MergeInputs.pair(inputs.mov, inputs.ref, inputs.observations))
    assert len(sweep.swept[3]) == 0


def test_without_an_observation_nothing_is_swept(sweep, tab, inputs):
    tab.state.update(inputs=inputs.knowing((), "sighting"))
    tab.panels.sweep.connect.call_args.args[0]()
    assert sweep.swept[2] is None
