"""The lesson as a mode of the page: it borrows the maps and the sliders, and puts everything back."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

from algorithms.common.errors import MapMergeError
from algorithms.methods.registry import DEFAULT_METHOD, METHODS
from app.model.run_state import RunState
from app.model.view_modes import LESSON
from app.page.lesson.checks.step_checks import Seen, done, ready
from app.page.lesson.figures.figure_registry import PICTURES
from app.page.lesson.lesson_display import NAMED, LessonDisplay, OnMap
from app.page.lesson.lesson_texts import StepText, files, first_number, read_step, with_settings
from app.page.lesson.lesson_work import LessonWork
from app.page.lesson.placeholders import NUMBERS
from app.page.modes import Mode
from app.page.run_controller import RunController
from app.page.tab import Tab
from app.page.undo.undo_controller import UndoController
from app.web.browser_events import Numbers

MOST_STEPS = 100
NOT_YET = "Not yet."
STILL = "These maps are still being worked out."


class LessonController:
    """Goes through the texts of a folder."""

    def __init__(
        self,
        tab: Tab,
        undo: UndoController,
        runs: RunController,
        folder: Path,
        take_sample: Callable[[str], None] = lambda name: None,
    ) -> None:
        """take_sample : shows the sample of a name in place of what is on the page"""
        self._state, self._panels, self._panel = tab.state, tab.panels, tab.panels.lesson
        self._modes, self._notices, self._locks = tab.modes, tab.notices, tab.state.locks
        self._undo, self._runs, self._folder = undo, runs, folder
        self._display = LessonDisplay(tab.state, tab.display, self._panel)
        self._work = LessonWork(tab.state, runs.thread.runner, self._picture, self._show, self._panel.picture)
        self._own: tuple[str, Any] = (tab.state.method, tab.state.config)
        self._files: list[Path] = []
        self._index = 0
        self._text: StepText | None = None
        self._tried: tuple[int, Any] | None = None  # which thing to try, and the settings before it
        self._answered: set[int] = set()  # whose answers are shown
        self._take_sample = take_sample
        self._done: set[int] = set()  # numbers of the steps whose question was answered
        self._said = ""  # what the last check found
        self._slid = 0  # how often a slider was moved: older values need not be drawn any more
        self._mode = tab.modes.add(
            Mode(self._end, leave=self.leave, changed=self._settings_changed, reopen=self.enter)
        )
        self._panel.connect(
            self.go, self.move, self.leave, self._slide, self._try, self._check, self._to_sample
        )
        tab.events.on("grip", self._grip, latest=True, dials=Numbers(1, 2), values=Numbers(1, 2))
        tab.events.on("done", self._was_done, steps=Numbers(1, MOST_STEPS))
        tab.state.subscribe("palette", lambda: self._show(fresh=True))

    def close(self) -> None:
        self._work.close()

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
            self._contents()
            self._dock(True)
            self._work.begin()
            self.go(min(self._index, len(self._files) - 1))

    def open_at(self, number: int) -> None:
        """Open the step that is counted as this number, or the one that is nearest to it."""
        with self._locks.action:
            self.enter()
            if self.open:
                index = number - first_number(self._files)
                self.go(min(max(index, 0), len(self._files) - 1))

    def leave(self) -> None:
        """Put everything back as it was."""
        with self._locks.action:
            if self.open:
                self._modes.close()
                self._undo.restore_current()

    def _end(self) -> None:
        """Close the dock and put the settings back."""
        self._work.leave()
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
                self._work.begin()
                self._show(fresh=False)

    def go(self, index: int) -> None:
        """Go to a step; beyond the first and the last nowhere."""
        with self._locks.action:
            if not self.open or not 0 <= index < len(self._files):
                return
            self._put_back()
            self._text = None
            self._work.leave_step()
            self._index, self._display.places, self._display.way, self._answered = index, (), "", set()
            self._said = ""
            try:
                self._text = read_step(self._files[index], PICTURES, NUMBERS)
            except MapMergeError as error:
                with self._locks.drawing:
                    self._panel.broken(index, self._files[index].name, str(error))
                    self._show_on_map(OnMap(RunState()), f"Lesson: {error}", look=True)
                return
            self._show(fresh=True)
            self._work.compare()

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

    def _grip(self, dials: list[float], values: list[float]) -> None:
        """A handle in the picture is dragged."""
        with self._locks.action:
            if self.open and self._text is not None:
                self._display.move(dials, values)
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
                    self._work.begin()
            self._show(fresh=False)

    def _check(self) -> None:
        """Look whether what the step asks for is on the page."""
        with self._locks.action:
            text, at = self._text, self._display.places
            if not self.open or text is None or text.check is None:
                return
            lesson, number = self._work.lesson, first_number(self._files) + self._index
            if not (self._work.done or ready(text.check.test, lesson)):
                self._said = STILL
            elif done(text.check.test, Seen(lesson, self._display.way, at)):
                self._said = ""
                self._done.add(number)
                with self._locks.drawing:
                    self._contents()
            else:
                self._said = NOT_YET
            self._show(fresh=False)

    def _to_sample(self) -> None:
        """Open the sample that shows what the maps at hand do not."""
        with self._locks.action:
            text = self._text
            if self.open and text is not None:
                sighted = self._state.inputs.sighted
                self._take_sample(text.effect.sample if sighted and text.effect is not None else NAMED)

    def _was_done(self, steps: list[float]) -> None:
        """The tab comes back, and tells which questions were answered before."""
        with self._locks.action:
            self._done |= {int(step) for step in steps}
            if self.open:
                with self._locks.drawing:
                    self._contents()
                self._show(fresh=False)

    def _put_back(self) -> None:
        self._display.way = ""
        if self._tried is not None:
            _, config = self._tried
            self._tried = None
            self._runs.set_method(self._state.method, config)
            self._work.begin()

    # --- drawing ----------------------------------------------------------------------------------

    def _contents(self) -> None:
        """The list of steps, those with a tick whose question was answered."""
        told, first = self._state.inputs.names.told, first_number(self._files)
        self._panel.contents([told(self._title(path)) for path in self._files], first, self._steps_done)

    @property
    def _steps_done(self) -> set[int]:
        """Of those that there are."""
        first = first_number(self._files)
        return self._done & set(range(first, first + len(self._files)))

    def _title(self, path: Path) -> str:
        try:
            return read_step(path, PICTURES, NUMBERS).title
        except MapMergeError:
            return path.name

    def _picture(self) -> str:
        """Name of the picture that is looked at."""
        return self._text.picture if self._text is not None and self.open else ""

    def _show(self, fresh: bool, moved: bool = False) -> None:
        """Show the step at hand, as far as the run has come.

        fresh : look at the map anew
        moved : only a dial was: the words stay
        """
        with self._locks.drawing:
            text, lesson = self._text, self._work.lesson
            if text is None or not self.open:
                return
            if self._said == STILL and (text.check is None or ready(text.check.test, lesson)):
                self._said = ""
            if not moved:
                self._display.words(self._index, text, lesson, self._answered, self._steps_done)
            first = first_number(self._files)
            self._display.question(text, lesson, first + self._index in self._done, self._said)
            where = f"step {first + self._index} of {first + len(self._files) - 1}"
            says = f"Lesson, {where}: {text.title}"
            self._show_on_map(self._display.picture(text, lesson, self._work.done), says, fresh)

    def _show_on_map(self, step: OnMap, says: str, look: bool) -> None:
        self._state.update(run=step.run)
        self._display.on_map(step, says, look)
