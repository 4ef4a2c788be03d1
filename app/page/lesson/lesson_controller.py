"""The lesson as a mode of the page: it borrows the maps and the sliders, and puts everything back."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

from algorithms.common.errors import MapMergeError
from algorithms.methods.registry import DEFAULT_METHOD, METHODS
from algorithms.methods.steps import Step
from app.jobs.job_thread import JobThread
from app.jobs.runner import TappedRunner
from app.model.merge_inputs import MergeInputs
from app.model.merge_job import MergeJob
from app.model.run_state import RunState
from app.model.view_modes import LESSON
from app.page.lesson.figures.figure_registry import PICTURES
from app.page.lesson.lesson_display import LessonDisplay, OnMap
from app.page.lesson.lesson_run import LessonRun, keep
from app.page.lesson.lesson_texts import StepText, files, first_number, read_step, with_settings
from app.page.lesson.placeholders import NUMBERS
from app.page.modes import Mode
from app.page.run_controller import RunController
from app.page.tab import Tab
from app.page.undo.undo_controller import UndoController


class LessonController:
    """Goes through the texts of a folder; listens to a job thread of its own."""

    def __init__(self, tab: Tab, undo: UndoController, runs: RunController, folder: Path) -> None:
        self._state, self._panels, self._panel = tab.state, tab.panels, tab.panels.lesson
        self._modes, self._notices, self._locks = tab.modes, tab.notices, tab.state.locks
        self._undo, self._runs, self._folder = undo, runs, folder
        self._display = LessonDisplay(tab.state, tab.display, self._panel)
        runner = TappedRunner(runs.thread.runner, self._record)
        self._thread = JobThread(self, runner, tab.state.locks.drawing)
        self._own: tuple[str, Any] = (tab.state.method, tab.state.config)
        self._files: list[Path] = []
        self._index = 0
        self._text: StepText | None = None
        self._steps: list[Step] = []
        self._lesson = LessonRun(MergeInputs(), None)
        self._done = False  # whether the run has come to its end
        self._tried: tuple[int, Any] | None = None  # which thing to try, and the settings before it
        self._answered: set[int] = set()  # whose answers are shown
        self._slid = 0  # how often a slider was moved: older values need not be drawn any more
        self._mode = tab.modes.add(
            Mode(self._end, leave=self.leave, changed=self._settings_changed, reopen=self.enter)
        )
        self._panel.connect(self.go, self.move, self.leave, self._slide, self._try)
        tab.state.subscribe("palette", lambda: self._show(fresh=True))

    def close(self) -> None:
        self._thread.close()

    @property
    def open(self) -> bool:
        return self._modes.current is self._mode

    # --- what a person asks for -------------------------------------------------------------------

    def toggle(self) -> None:
        (self.leave if self.open else self.enter)()

    def enter(self) -> None:
        """Begin where one was the last time."""
        with self._locks.action:
            if self.open:
                return
            try:
                self._files = files(self._folder)
            except MapMergeError as error:
                self._notices.report(error)
                return
            self._modes.enter(self._mode)
            self._runs.thread.stop()
            self._own = self._state.method, self._state.config
            proof = getattr(self._state.config, "proof", None)
            if proof is None or not proof.whole_circle:  # the lesson ends with a proof
                self._runs.set_method(DEFAULT_METHOD, METHODS[DEFAULT_METHOD].defaults)
            told = self._state.inputs.names.told
            titles = [told(self._title(path)) for path in self._files]
            self._panel.contents(titles, first_number(self._files))
            self._dock(True)
            self._begin()
            self.go(min(self._index, len(self._files) - 1))

    def leave(self) -> None:
        """Put everything back as it was."""
        with self._locks.action:
            if self.open:
                self._modes.close()
                self._undo.restore_current()

    def _end(self) -> None:
        """Close the dock and put the settings back."""
        self._thread.stop()
        self._lesson.sides.clear()  # their merged maps may be large
        self._tried = None
        self._runs.set_method(*self._own)
        self._dock(False)

    def _dock(self, open_: bool) -> None:
        with self._locks.drawing:
            self._panels.run.open(LESSON, open_)
            self._panels.charts.visible(not open_)
            self._display.dock(open_, turned=open_ and self._state.turn_to_map())

    def _settings_changed(self) -> None:
        """A setting was moved by hand."""
        with self._locks.action:
            if self.open:
                self._begin()
                self._show(fresh=False)

    def go(self, index: int) -> None:
        """Go to a step; beyond the first and the last nowhere."""
        with self._locks.action:
            if not self.open or not 0 <= index < len(self._files):
                return
            self._put_back()
            self._text = None
            if self._done:  # what may be at work is compared by the step that is left
                self._thread.stop()
            self._index, self._display.places, self._display.way, self._answered = index, (), "", set()
            try:
                self._text = read_step(self._files[index], PICTURES, NUMBERS)
            except MapMergeError as error:
                with self._locks.drawing:
                    self._panel.broken(index, self._files[index].name, str(error))
                    self._show_on_map(OnMap(RunState()), f"Lesson: {error}", look=True)
                return
            self._show(fresh=True)
            self._compare()

    def move(self, by: int) -> None:
        """Go on or back by so many steps; pressed quickly, each press counts."""
        with self._locks.action:
            self.go(self._index + by)

    def _slide(self) -> None:
        self._slid += 1
        mine = self._slid
        with self._locks.action:
            if self.open and mine == self._slid:
                self._display.places = self._panel.places
                self._show(fresh=False, moved=True)

    def _try(self, number: int) -> None:
        with self._locks.action:
            text = self._text
            if not self.open or text is None or number >= len(text.trials):
                return
            trial, shown = text.trials[number], number in self._answered
            if trial.button:
                self._put_back()
                self._answered.clear()
            if shown:
                self._answered.discard(number)
            else:
                self._answered.add(number)
                if trial.show:
                    self._display.draw_as(text.picture, trial.show)
                elif trial.button:
                    config = self._state.config
                    self._tried = number, config
                    self._runs.set_method(self._state.method, with_settings(config, trial.settings))
                    self._begin()
            self._show(fresh=False)

    def _put_back(self) -> None:
        self._display.way = ""
        if self._tried is not None:
            _, config = self._tried
            self._tried = None
            self._runs.set_method(self._state.method, config)
            self._begin()

    # --- the run ----------------------------------------------------------------------------------

    def _begin(self) -> None:
        """Run the method on what is loaded, as it is set now."""
        state, had = self._state, self._lesson
        self._thread.stop()
        self._done = False
        sides = had.sides if (had.inputs, had.seed) == (state.inputs, state.seed) else {}
        self._lesson = LessonRun(state.inputs, state.config, state.seed, sides=sides)
        job = state.job()
        if self._lesson.possible and job is not None:
            self._thread.request(job)

    def _compare(self) -> bool:
        """Begin the next of the merges that the step at hand compares, once the lesson's own is over, or at
        once where they come early; whether one is begun.
        """
        text, lesson = self._text, self._lesson
        picture = PICTURES.get(text.picture) if text is not None and self.open else None
        if text is None or picture is None or picture.compares is None or not (self._done or picture.early):
            return False
        if not lesson.possible or not lesson.reached(*picture.needs):
            return False
        runs = lesson.sides.get(text.picture) or picture.compares(lesson)
        lesson.sides[text.picture] = runs
        if runs.next is not None:
            self._thread.request(runs.next.job)
        return runs.next is not None

    def _compared(self, job: MergeJob, run: RunState, failed: str = "") -> bool:
        """Take in one of these merges, as far as it has come; whether it is one."""
        one = self._lesson.compared(job)
        if one is not None:
            one.run, one.failed = run, failed
            self._show(fresh=True, moved=not one.over)  # its numbers may stand in the text
        return one is not None

    def _record(self, run: Iterator[Step]) -> Iterator[Step]:
        self._steps = steps = []
        for step in run:
            keep(steps, step)
            yield step

    def begun(self, job: MergeJob) -> None:
        self._compared(job, run=RunState(job.config))

    def show(self, job: MergeJob, run: RunState) -> None:
        """The run goes on: what a picture waits for may be there."""
        if self._compared(job, run):
            return
        text, had = self._text, self._lesson
        if text is None or text.picture not in PICTURES or had.reached(*PICTURES[text.picture].needs):
            return
        early = LessonRun(had.inputs, job.config, job.seed, tuple(self._steps), had.sides)
        if early.reached(*PICTURES[text.picture].needs):
            self._lesson = early
            self._show(fresh=True)

    def ending(self, job: MergeJob, run: RunState) -> None:
        """There is nothing to work out."""

    def waits(self, job: MergeJob, before: int) -> None:
        """Other tabs' runs are at work; the picture says that it is being worked out."""

    def ended(self, job: MergeJob, run: RunState) -> None:
        if self._compared(job, run):
            self._go_on()
        else:
            had = self._lesson
            self._lesson = LessonRun(had.inputs, job.config, job.seed, tuple(self._steps), had.sides)
            self._done = True
            self._show(fresh=not had.steps)
            self._compare()

    def _go_on(self) -> None:
        """One that is compared is over: the next comes; after those that come early the lesson's own run."""
        job = self._state.job()
        if not self._compare() and not self._done and job is not None:
            self._thread.request(job)

    def stopped(self, job: MergeJob, run: RunState) -> None:
        """The run is no longer wanted; one that is compared begins anew when its step is opened again."""
        if (one := self._lesson.compared(job)) is not None:
            one.run = None

    def failed(self, job: MergeJob, run: RunState, error: Exception) -> None:
        if self._compared(job, run, str(error)):
            self._go_on()
            return
        self._done = True
        self._panel.picture(f"These maps cannot be merged: {error}")

    # --- drawing ----------------------------------------------------------------------------------

    def _title(self, path: Path) -> str:
        try:
            return read_step(path, PICTURES, NUMBERS).title
        except MapMergeError:
            return path.name

    def _show(self, fresh: bool, moved: bool = False) -> None:
        """Show the step at hand, as far as the run has come.

        fresh : look at the map anew
        moved : only a dial was: the words stay
        """
        with self._locks.drawing:
            text, lesson = self._text, self._lesson
            if text is None or not self.open:
                return
            if not moved:
                self._display.words(self._index, text, lesson, self._answered)
            first = first_number(self._files)
            where = f"step {first + self._index} of {first + len(self._files) - 1}"
            says = f"Lesson, {where}: {text.title}"
            self._show_on_map(self._display.picture(text, lesson, self._done), says, fresh)

    def _show_on_map(self, step: OnMap, says: str, look: bool) -> None:
        self._state.update(run=step.run)
        self._display.on_map(step, says, look)
