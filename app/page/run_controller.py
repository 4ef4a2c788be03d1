"""Runs the method on what is loaded: what a person asks for, and what the run tells of itself."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import Any

from algorithms.common.errors import MapMergeError, NoAnswerError
from algorithms.methods import registry as methods
from algorithms.methods.merge_result import MergeResult
from algorithms.methods.steps import CauseDetail, Step, TriedDetail
from algorithms.verdict.contradictions import Contradictions, find_conflicts
from app.jobs.job_thread import JobThread
from app.jobs.runner import Runner
from app.jobs.worker_pool import WorkerDiedError
from app.model import status_text
from app.model.merge_job import MergeJob
from app.model.run_state import RunState
from app.model.view_modes import MAP
from app.page.tab import Tab
from app.report.replay.html_page import replay_of
from app.web.callback_errors import words


class RunController:
    """Of one tab: listens to its job thread; ``stop_upload``: leaves the file that is on its way."""

    def __init__(self, tab: Tab, runner: Runner, stop_upload: Callable[[], None]) -> None:
        self._state, self._display, self._panels = tab.state, tab.display, tab.panels
        self._modes, self._history, self._notices = tab.modes, tab.history, tab.notices
        self._messages, self._comparison = tab.display.messages, tab.display.views.comparison
        self._stop_upload = stop_upload
        self._weighed: tuple[tuple[Any, ...], tuple[Contradictions, str]] | None = None
        self._searched: Callable[[RunState | None], None] | None = None
        self.thread = JobThread(self, runner, tab.state.locks.drawing)
        tab.panels.run.connect_run(
            self.merge, self.stop, self._set_speed, tab.panels.settings.choose, self.settings_changed
        )
        tab.panels.settings.connect(self.settings_changed, tab.notices.report)

    # --- what a person asks for -------------------------------------------------------------------

    def merge(self) -> None:
        state, panels, mode = self._state, self._panels, self._modes.current
        if mode is not None and mode.merge is not None:
            mode.merge()
            return
        with state.locks.action, state.locks.drawing:
            self._modes.leave()
            panels.settings.sync()
            self._read_settings()
            job = state.job(pace=panels.run.pace, again=True)
            if job is None:
                return
            state.update(goal="merge")
            snapshot, before = state.snapshot(), self._history.snapshot
            if before is None or before.outcome is None or not before.same_request(snapshot):
                self._history.note(snapshot, "merge")
            panels.charts.follow()
            self._messages.look_down(self._display.views.map.layout.view(), follow=True)
            if state.view != MAP:
                self._display.show_view()
            self.thread.request(job)

    def stop(self) -> None:
        """Leave the file that is read, or else what is run, or else the file on its way."""
        mode = self._modes.current
        if self._panels.task.stop() or (mode is not None and mode.stop()):
            return
        if not self.thread.busy:
            self._stop_upload()
            return
        self.thread.stop()  # at once, whatever else is being carried out
        with self._state.locks.action:
            self._history.forget_goal()

    def settings_changed(self) -> None:
        """A setting, the method or the seed was changed: what is on the screen is out of date."""
        state, mode = self._state, self._modes.current
        self._read_settings()
        if mode is not None and mode.reopen is not None:
            mode.changed()
            return
        with state.locks.action, state.locks.drawing:
            live = self.thread.runs_method and state.goal == "merge"
            goal = state.goal or "candidates"
            job = state.job(goal=goal, pace=self._panels.run.pace if live else 0.0)
            if job is not None:
                state.update(goal=goal)
            if not self._history.note(state.snapshot()) or job is None:
                return
            if mode is not None and mode is self._modes.current and mode.redraw is not None:
                mode.changed()
                return
            self._display.mark_outdated()
            self.thread.request(job)

    def load_settings(self, method: str, config: Any) -> None:
        """Set these, as if a person had moved the sliders."""
        with self._state.locks.action:
            self._modes.leave()
            self.set_method(method, config)
            self.settings_changed()

    def set_method(self, method: str, config: Any, seed: int | None = None) -> None:
        """Set these, and run nothing. Without a seed it stays."""
        self._panels.show_method(method, config, self._state.seed if seed is None else seed)
        self._read_settings()

    def _read_settings(self) -> None:
        settings, seed = self._panels.settings, self._panels.run.seed
        self._state.update(method=settings.method, config=settings.config, seed=seed)

    def _set_speed(self) -> None:
        # a run that is shown at a pace comes to its end so
        self.thread.set_pace(self._panels.run.pace or 0.01)
        self._display.show_buttons()

    def search(self, job: MergeJob, searched: Callable[[RunState | None], None]) -> None:
        """Run something else than the method; ``searched`` is given the run, or None where it was stopped."""
        self._searched = searched
        self.thread.request(job)

    # --- what the run tells -----------------------------------------------------------------------

    def begun(self, job: MergeJob) -> None:
        self._panels.run.stoppable("run", True)
        if job.goal == "cause":
            return
        self._notices.clear()
        if self._modes.close() is not None:  # another's result is not left there while something else is said
            self._comparison.clear()
            self._display.views.map.apart()
        if job.pace > 0:  # shown step by step; a run at once leaves what is seen until it has ended
            self._comparison.clear()
        self._display.clear_read_out()
        self._messages.hud(state="Starting.", mood="running", progress=0.0)
        self._messages.flush()

    def show(self, job: MergeJob, run: RunState) -> None:
        """The newest step is there."""
        if job.goal == "cause":
            self._show_tried(run.get(TriedDetail))
            return
        self._state.update(run=run)
        self._display.show_step(live=job.pace > 0, follow=job.goal == "merge")

    def ending(self, job: MergeJob, run: RunState) -> None:
        """What is to be said of an answer: with large maps it takes longer than to draw it."""
        result = run.get(MergeResult)
        if result is not None and job.steps is None:
            self._weigh(result, job.config)

    def waits(self, job: MergeJob, before: int) -> None:
        """Others are at work: other tabs' runs, or the end of a step of one that was left."""
        if job.goal == "cause":
            return
        place = f"{before} before this one" if before else "this one is next"
        self._messages.hud(state=f"The processors are busy: {place}.", mood="running")
        self._messages.flush()

    def ended(self, job: MergeJob, run: RunState) -> None:
        self._panels.run.stoppable("run", False)
        if job.goal == "cause":
            self._explain(run.get(CauseDetail))
            return
        result = run.get(MergeResult)
        with self._display.together():
            if result is None:
                self._state.update(run=run)
                self._display.show_candidates()
            elif job.steps is not None:
                self._tell_searched(run)
            else:
                self.show_answer(run, result, job.config, live=job.pace > 0)
                self._history.amend(run)
            self._display.show_buttons()
        if result is not None and job.steps is None and not result.verdict.accepted:
            cause = partial(methods.find_cause, job.ref, job.mov, job.known)
            self.thread.request(replace(job, goal="cause", steps=cause, pace=0.0))

    def stopped(self, job: MergeJob, run: RunState) -> None:
        self._panels.run.stoppable("run", False)
        if job.goal == "cause":
            self._display.show_result_text(self._state.result)
            return
        if self._display.views.map.together:
            self._comparison.offer(None, self._state.palette)
        if job.steps is not None and self._tell_searched(None):
            return
        state = f"Stopped, unfinished. {status_text.sentence(run)}"
        self._messages.hud(state=state, mood="stopped", progress=None)
        self._messages.flush()

    def failed(self, job: MergeJob, run: RunState, error: Exception) -> None:
        self._panels.run.stoppable("run", False)
        if job.goal == "cause":  # the verdict stands without it
            self._display.show_result_text(self._state.result)
            return
        if isinstance(error, NoAnswerError):
            self._state.update(run=run, search=None, result=None, result_config=None, contradictions=None)
            self._display.show_no_answer(error)
            return
        died = isinstance(error, WorkerDiedError)
        if isinstance(error, MapMergeError) and not died:
            self._notices.report(error)
            return
        text = str(error) if died else words(error)
        self._notices.show("The run ended", text, "red")
        self._messages.hud(state=text, mood="failed", progress=None)
        self._messages.flush()

    def _tell_searched(self, run: RunState | None) -> bool:
        searched, self._searched = self._searched, None
        if searched is not None:
            searched(run)
        return searched is not None

    # --- the answer -------------------------------------------------------------------------------

    def show_answer(self, run: RunState, result: MergeResult, config: Any, live: bool) -> None:
        """Show an answer and everything that led to it; whoever calls is drawing."""
        self._modes.close()
        state, replay = self._state, self._panels.export.replay
        contradictions, html = self._weigh(result, config)
        by_hand = result.by_person
        search = state.search if by_hand else run
        found = {"result": result, "result_config": config, "contradictions": contradictions}
        state.update(run=run, search=search, **found)
        self._display.show_answer(result, html, live)
        job = state.job()
        if by_hand or job is None:  # there was no run that could be recorded
            replay.visible(False)
        else:
            job = replace(job, config=config, method=result.method, seed=result.seed)
            replay.offer(state.inputs.name, partial(replay_of, job, self.thread.steps_again, state.inputs))

    def _weigh(self, result: MergeResult, config: Any) -> tuple[Contradictions, str]:
        """Where the maps contradict each other, and the page of the result; worked out once."""
        of = (result, self._state.inputs, config, self._state.corrections)
        if self._weighed is None or any(a is not b for a, b in zip(self._weighed[0], of, strict=True)):
            found = find_conflicts(result.fusion)
            self._weighed = of, (found, self._display.result_html(result, config, found))
        return self._weighed[1]

    # --- after a refusal: a simple change under which the maps would agree? ---------------------------

    def _show_tried(self, tried: TriedDetail | None) -> None:
        """Say below the verdict what is being tried."""
        result = self._state.result
        if tried is None or result is None:
            return
        trying = f"Looking for the cause, {tried.index + 1} of {tried.total}: {tried.clause}?"
        with self._display.together():
            self._display.show_result_text(result.with_hint(trying))
            self._messages.flush()

    def _explain(self, cause: CauseDetail | None) -> None:
        """Put the cause, if one was found, into the result."""
        state = self._state
        if state.result is None or cause is None:
            return
        result = state.result.with_hint(cause.hint)
        with self._display.together():
            self._display.show_result_text(result)
            if cause.hint:
                state.run.add(Step("explain", result, 0.0))
                state.update(result=result)
                self._panels.export.offer(state.files_of(result))
                self._history.amend(state.run)
            self._messages.flush()
