"""What a person asks of a run, and what the page makes of what it tells."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from unittest.mock import Mock

import pytest
from tabs import noting_tab

from algorithms.common.errors import InputFileError, NoAnswerError
from algorithms.methods.steps import Step
from algorithms.verdict.decision import Outcome
from app.jobs.job_thread import JobThread
from app.model.run_state import RunState
from app.model.settings import with_value
from app.page import run_controller
from app.page.modes import Mode
from app.page.run_controller import RunController


@pytest.fixture
def tab(inputs):
    return noting_tab(inputs)


@pytest.fixture
def controller(monkeypatch) -> Callable[..., RunController]:
    """Makes a controller whose thread only notes what is asked of it."""
    monkeypatch.setattr(
        run_controller, "JobThread", lambda *_: Mock(JobThread, busy=False, runs_method=False)
    )
    return lambda tab: RunController(tab, Mock(), stop_upload=Mock())


def asked(runs: RunController):
    """The newest job that was asked for; None where there is none."""
    call = runs.thread.request.call_args
    return call.args[0] if call else None


def ended(result) -> RunState:
    run = RunState()
    run.add(Step("verdict", result, 0.0))
    return run


def wider(tab):
    """The settings with another spread."""
    config = tab.state.config
    return with_value(config, ("augment", "spread"), config.augment.spread + 0.5)


def test_merge_asks_for_the_whole_merge_as_it_is_set_and_can_be_undone(tab, controller):
    runs = controller(tab)
    tab.panels.run.seed = 7
    runs.merge()
    assert (asked(runs).goal, asked(runs).seed, asked(runs).config) == ("merge", 7, tab.state.config)
    assert tab.history.steps[-1].label == "merge"
    assert tab.history.snapshot.goal == "merge"


def test_the_same_merge_again_is_no_further_step(tab, controller, result):
    runs = controller(tab)
    runs.merge()
    runs.ended(asked(runs), ended(result))
    before = len(tab.history.steps)
    runs.merge()
    assert len(tab.history.steps) == before


def test_without_an_observation_nothing_is_run(inputs, controller):
    tab = noting_tab(inputs.knowing((), "sighting"))
    runs = controller(tab)
    runs.merge()
    assert asked(runs) is None
    assert tab.state.goal is None


@pytest.mark.parametrize("merged", [False, True])
def test_a_moved_slider_asks_for_the_candidates_and_after_a_merge_for_the_merge(tab, controller, merged):
    runs = controller(tab)
    if merged:
        runs.merge()
    tab.panels.settings.move(wider(tab))
    assert asked(runs).goal == ("merge" if merged else "candidates")
    assert asked(runs).config.augment.spread == tab.state.config.augment.spread


def test_a_slider_that_is_moved_back_and_forth_to_where_it_was_runs_nothing(tab, controller):
    runs = controller(tab)
    tab.panels.settings.move(tab.state.config)
    assert asked(runs) is None


def test_a_mode_that_draws_the_map_takes_a_changed_setting_upon_itself(tab, controller):
    runs, changed = controller(tab), Mock()
    tab.modes.enter(tab.modes.add(Mode(Mock(), redraw=Mock(), changed=changed)))
    tab.panels.settings.move(wider(tab))
    changed.assert_called_once_with()
    assert asked(runs) is None
    assert len(tab.history.steps) == 2  # it can be undone all the same


def test_settings_that_a_mode_has_borrowed_are_not_recorded(tab, controller):
    runs, changed = controller(tab), Mock()
    tab.modes.enter(tab.modes.add(Mode(Mock(), changed=changed, reopen=Mock())))
    tab.panels.settings.move(wider(tab))
    changed.assert_called_once_with()
    assert asked(runs) is None
    assert len(tab.history.steps) == 1


def test_an_answer_is_shown_and_kept_and_a_refused_one_is_asked_for_its_cause(tab, controller, result):
    runs = controller(tab)
    runs.merge()
    job = asked(runs)
    runs.ended(job, ended(result))
    assert tab.state.result is result
    assert tab.history.snapshot.result is result
    assert asked(runs) is job  # accepted: there is nothing to explain
    verdict = replace(result.verdict, accepted=False, outcome=Outcome.REFUSED)
    refused = replace(result, verdict=verdict)
    runs.ended(job, ended(refused))
    assert asked(runs).goal == "cause"


def test_no_answer_takes_the_last_one_away(tab, controller, result):
    runs = controller(tab)
    runs.merge()
    runs.ended(asked(runs), ended(result))
    runs.failed(asked(runs), RunState(), NoAnswerError("nothing fits"))
    assert tab.state.result is None
    assert tab.display.show_no_answer.called


def test_a_wrong_input_is_reported_and_a_bug_is_told_as_one(tab, controller):
    runs = controller(tab)
    runs.merge()
    error = InputFileError("a.yaml", "is odd", "mend it")
    runs.failed(asked(runs), RunState(), error)
    tab.notices.report.assert_called_once_with(error)
    runs.failed(asked(runs), RunState(), RuntimeError("a secret path"))
    assert "a secret path" not in str(tab.notices.show.call_args)


def test_stop_leaves_a_file_that_is_read_then_the_run_then_the_file_on_its_way(tab, controller):
    runs = controller(tab)
    tab.panels.task.stop.return_value = True
    runs.stop()
    assert not runs.thread.stop.called
    tab.panels.task.stop.return_value = False
    runs.thread.busy = True
    runs.stop()
    assert runs.thread.stop.called
    assert not runs._stop_upload.called
    runs.thread.busy = False
    runs.stop()
    assert runs._stop_upload.called


def test_a_run_that_was_stopped_is_not_begun_again_by_undo(tab, controller):
    runs = controller(tab)
    runs.merge()
    runs.thread.busy = True
    tab.panels.task.stop.return_value = False
    runs.stop()
    assert tab.history.snapshot.goal is None


@pytest.mark.parametrize("stopped", [False, True])
def test_a_search_for_someone_else_ends_with_them_and_is_no_answer_of_the_page(
    tab, controller, result, stopped
):
    runs, searched = controller(tab), Mock()
    job = tab.state.job(steps=Mock())
    runs.search(job, searched)
    run = ended(result)
    if stopped:
        runs.stopped(job, run)
    else:
        runs.ended(job, run)
    searched.assert_called_once_with(None if stopped else run)
    assert tab.state.result is None
