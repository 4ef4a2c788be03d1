"""The lesson as a mode of the page: it borrows the maps and the sliders, and puts everything back."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from threading import RLock
from typing import Any

import viser

from algorithms.common.errors import MapMergeError
from algorithms.methods.registry import DEFAULT_METHOD, METHODS
from algorithms.methods.steps import Step
from app.jobs.job_thread import JobThread
from app.jobs.runner import TappedRunner
from app.model.merge_inputs import MergeInputs
from app.model.merge_job import MergeJob
from app.model.run_state import RunState
from app.page.lesson.figures.figure_registry import PICTURES
from app.page.lesson.hosts import Host
from app.page.lesson.lesson_display import LessonDisplay
from app.page.lesson.lesson_panel import LessonPanel, LessonWishes
from app.page.lesson.lesson_run import LessonRun, keep
from app.page.lesson.lesson_texts import StepText, files, read_step, with_settings
from app.page.lesson.placeholders import NUMBERS
from app.page.panels.settings_panel import SettingsPanel


class LessonController:
    """Goes through the steps; listens to a session of its own.

    turn : held while a person's wish is carried out
    """

    def __init__(
        self, host: Host, gui: viser.GuiApi, tuning: SettingsPanel, turn: RLock, folder: Path
    ) -> None:
        self._host, self._tuning, self._turn, self._folder = host, tuning, turn, folder
        wishes = LessonWishes(
            go=self.go, move=self.move, leave=self.leave, turn=self._dialled, try_=self._try
        )
        self._panel = LessonPanel(gui, wishes)
        self._display = LessonDisplay(host, self._panel)
        self._session = JobThread(self, TappedRunner(host.session.bench, self._record), beside=host.session)
        self.open = False
        self._own: tuple[str, Any] = (DEFAULT_METHOD, METHODS[DEFAULT_METHOD].defaults)
        self._files: list[Path] = []
        self._index = 0
        self._text: StepText | None = None
        self._steps: list[Step] = []
        self._study = LessonRun(MergeInputs(), None)
        self._done = False  # whether the run has come to its end
        self._tried: tuple[int, Any] | None = None  # which thing to try, and the settings before it
        self._told: set[int] = set()  # whose answers are shown
        self._wish = 0  # the newest turn of a dial: older ones need not be drawn any more

    def close(self) -> None:
        """The tab is gone."""
        self._session.close()

    # --- what a person asks for -------------------------------------------------------------------

    def enter(self) -> None:
        """Begin where one was the last time."""
        with self._turn:
            if self.open:
                return
            try:
                self._files = files(self._folder)
            except MapMergeError as error:
                self._host.report(error)
                return
            self._host.session.stop()
            self.open = True
            self._own = self._tuning.method, self._tuning.config
            proof = getattr(self._tuning.config, "proof", None)
            if proof is None or not proof.whole_circle:  # the lesson ends with a proof
                self._set(DEFAULT_METHOD, METHODS[DEFAULT_METHOD].defaults)
            self._panel.contents([self._title(path) for path in self._files])
            with self._host.session.drawing:
                self._host.entered(True)
                self._panel.visible(True)
            self._begin()
            self.go(min(self._index, len(self._files) - 1))

    def leave(self) -> None:
        """Put everything back as it was."""
        with self._turn:
            if not self.open:
                return
            self.shut()
            self._host.came_back()

    def shut(self) -> None:
        """Close the dock and put the settings back; what the map shows is the caller's business."""
        with self._turn:
            if not self.open:
                return
            self._session.stop()
            self.open = False
            self._tried = None
            self._set(*self._own)
            with self._host.session.drawing:
                self._panel.visible(False)
                self._host.entered(False)

    def changed(self) -> None:
        """A setting was moved by hand."""
        with self._turn:
            if self.open:
                self._begin()
                self._show(fresh=False)

    def recolour(self) -> None:
        """Light has become dark, or the other way round."""
        if self.open:
            self._show(fresh=True)

    def go(self, index: int) -> None:
        """Go to a step; beyond the first and the last nowhere."""
        with self._turn:
            if not self.open or not 0 <= index < len(self._files):
                return
            self._put_back()
            self._index, self._display.places, self._told = index, (), set()
            try:
                self._text = read_step(self._files[index], PICTURES, NUMBERS)
            except MapMergeError as error:
                self._text = None
                with self._host.session.drawing:
                    self._panel.broken(index, self._files[index].name, str(error))
                    self._host.present(RunState(), f"Lesson: {error}", [], None, True, False)
                return
            self._show(fresh=True)

    def move(self, by: int) -> None:
        """Go on or back by so many steps; pressed quickly, each press counts."""
        with self._turn:
            self.go(self._index + by)

    def _dialled(self) -> None:
        self._wish += 1
        mine = self._wish
        with self._turn:
            if self.open and mine == self._wish:
                self._display.places = self._panel.places
                self._show(fresh=False, moved=True)

    def _try(self, number: int) -> None:
        with self._turn:
            text = self._text
            if not self.open or text is None or number >= len(text.trials):
                return
            trial, shown = text.trials[number], number in self._told
            if trial.button:
                self._put_back()
                self._told.clear()
            if shown:
                self._told.discard(number)
            else:
                self._told.add(number)
                if trial.button:
                    method, config = self._tuning.method, self._tuning.config
                    self._tried = number, config
                    self._set(method, with_settings(config, trial.settings))
                    self._begin()
            self._show(fresh=False)

    def _put_back(self) -> None:
        if self._tried is not None:
            _, config = self._tried
            self._tried = None
            self._set(self._tuning.method, config)
            self._begin()

    def _set(self, method: str, config: Any) -> None:
        self._tuning.restore(method, config)
        self._host.method_shown(method)

    # --- the run ----------------------------------------------------------------------------------

    def _begin(self) -> None:
        """Run the method on what is loaded, as it is set now."""
        i, config = self._host.inputs, self._tuning.config
        self._session.stop()
        self._done = False
        self._study = LessonRun(i, config, self._host.seed)
        if self._study.possible and i.ref is not None and i.mov is not None:
            job = MergeJob(i.ref, i.mov, i.observations, config, self._tuning.method, self._host.seed)
            self._session.request(job)

    def _record(self, told: Iterator[Step]) -> Iterator[Step]:
        """Keep the steps of a run."""
        self._steps = steps = []
        for step in told:
            keep(steps, step)
            yield step

    def begun(self, job: MergeJob) -> None:
        """The run starts."""

    def show(self, job: MergeJob, story: RunState) -> None:
        """The run goes on: what a picture waits for may be there."""
        text, had = self._text, self._study
        if text is None or text.picture not in PICTURES or had.reached(*PICTURES[text.picture].needs):
            return
        early = LessonRun(had.inputs, job.config, job.seed, tuple(self._steps))
        if early.reached(*PICTURES[text.picture].needs):
            self._study = early
            self._show(fresh=True)

    def ending(self, job: MergeJob, story: RunState) -> None:
        """There is nothing to work out."""

    def waits(self, job: MergeJob, before: int) -> None:
        """Other tabs' runs are at work; the picture says that it is being worked out."""

    def ended(self, job: MergeJob, story: RunState) -> None:
        """The run came to its end."""
        had = bool(self._study.steps)
        self._study = LessonRun(self._study.inputs, job.config, job.seed, tuple(self._steps))
        self._done = True
        self._show(fresh=not had)

    def stopped(self, job: MergeJob, story: RunState) -> None:
        """The run is no longer wanted."""

    def failed(self, job: MergeJob, story: RunState, error: Exception) -> None:
        """The run could not go on."""
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
        with self._host.session.drawing:
            text, study = self._text, self._study
            if text is None or not self.open:
                return
            if not moved:
                self._display.words(self._index, text, study, self._told)
            says = f"Lesson, step {self._index + 1} of {len(self._files)}: {text.title}"
            self._display.picture(text, study, says, fresh, self._done)
