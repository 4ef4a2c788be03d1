"""What the lesson has worked out: its own run on the loaded maps, and the merges that a step compares."""

from __future__ import annotations

from collections.abc import Callable, Iterator

from algorithms.methods.steps import Step
from app.jobs.job_thread import JobThread
from app.jobs.runner import Runner, TappedRunner
from app.model.merge_inputs import MergeInputs
from app.model.merge_job import MergeJob
from app.model.run_state import RunState
from app.page.lesson.figures.figure_registry import PICTURES
from app.page.lesson.lesson_run import LessonRun, keep
from app.page.page_state import PageState

Show = Callable[[bool, bool], None]


class LessonWork:
    """Of one tab; listens to a job thread of its own.

    lesson : as far as the run has come
    done   : whether it has come to its end
    """

    def __init__(
        self,
        state: PageState,
        runner: Runner,
        picture: Callable[[], str],
        show: Show,
        say: Callable[[str], None],
    ) -> None:
        """picture : name of the one that is looked at; empty where none is
        show    : the step at hand anew; whether to look at the map anew, and whether only the picture is new
        say     : a sentence in place of the picture
        """
        self._state, self._picture, self._show, self._say = state, picture, show, say
        self._thread = JobThread(self, TappedRunner(runner, self._record), state.locks.drawing)
        self._steps: list[Step] = []
        self.lesson = LessonRun(MergeInputs(), None)
        self.done = False

    def close(self) -> None:
        self._thread.close()

    def leave(self) -> None:
        """Nobody looks any more."""
        self._thread.stop()
        self.lesson.sides.clear()  # their merged maps may be large

    def leave_step(self) -> None:
        """What may be at work once the run is over is compared by the step that is left."""
        if self.done:
            self._thread.stop()

    def begin(self) -> None:
        """Run the method on what is loaded, as it is set now."""
        state, had = self._state, self.lesson
        self._thread.stop()
        self.done = False
        sides = had.sides if (had.inputs, had.seed) == (state.inputs, state.seed) else {}
        self.lesson = LessonRun(state.inputs, state.config, state.seed, sides=sides)
        job = state.job()
        if self.lesson.possible and job is not None:
            self._thread.request(job)

    def compare(self) -> bool:
        """Begin the next of the merges that the step at hand compares, once the lesson's own is over, or at
        once where they come early; whether one is begun.
        """
        name, lesson = self._picture(), self.lesson
        picture = PICTURES.get(name)
        if picture is None or picture.compares is None or not (self.done or picture.early):
            return False
        if not lesson.possible or not lesson.reached(*picture.needs):
            return False
        runs = lesson.sides.get(name) or picture.compares(lesson)
        lesson.sides[name] = runs
        if runs.next is not None:
            self._thread.request(runs.next.job)
        return runs.next is not None

    def _compared(self, job: MergeJob, run: RunState, failed: str = "") -> bool:
        """Take in one of these merges, as far as it has come; whether it is one."""
        one = self.lesson.compared(job)
        if one is not None:
            one.run, one.failed = run, failed
            self._show(True, not one.over)  # its numbers may stand in the text
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
        picture, had = PICTURES.get(self._picture()), self.lesson
        if picture is None or had.reached(*picture.needs):
            return
        early = LessonRun(had.inputs, job.config, job.seed, tuple(self._steps), had.sides)
        if early.reached(*picture.needs):
            self.lesson = early
            self._show(True, False)

    def ending(self, job: MergeJob, run: RunState) -> None:
        """There is nothing to work out."""

    def waits(self, job: MergeJob, before: int) -> None:
        """Other tabs' runs are at work; the picture says that it is being worked out."""

    def ended(self, job: MergeJob, run: RunState) -> None:
        if self._compared(job, run):
            self._go_on()
        else:
            had = self.lesson
            self.lesson = LessonRun(had.inputs, job.config, job.seed, tuple(self._steps), had.sides)
            self.done = True
            self._show(not had.steps, False)
            self.compare()

    def _go_on(self) -> None:
        """One that is compared is over: the next comes; after those that come early the lesson's own run."""
        job = self._state.job()
        if not self.compare() and not self.done and job is not None:
            self._thread.request(job)

    def stopped(self, job: MergeJob, run: RunState) -> None:
        """The run is no longer wanted; one that is compared begins anew when its step is opened again."""
        if (one := self.lesson.compared(job)) is not None:
            one.run = None

    def failed(self, job: MergeJob, run: RunState, error: Exception) -> None:
        if self._compared(job, run, str(error)):
            self._go_on()
            return
        self.done = True
        self._say(f"These maps cannot be merged: {error}")
