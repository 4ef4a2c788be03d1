"""One tab's work: newest request wins, one worker computes, and every step is told at a pace.

No viser here: a listener gets what is to be drawn.
"""

from __future__ import annotations

import logging
from collections.abc import Callable, Iterator
from contextlib import closing
from threading import Condition, RLock, Thread
from time import perf_counter
from typing import Protocol

from algorithms.common.errors import MapMergeError
from algorithms.methods.merge_result import MergeResult
from algorithms.methods.steps import AnswersDetail, CandidatesDetail, Step
from app.jobs.runner import RunCallbacks, Runner
from app.model.merge_job import MergeJob
from app.model.playback import FRAME, InterruptibleWait, dwell
from app.model.run_state import RunState
from app.system.logging_setup import facts

log = logging.getLogger(__name__)


class Listener(Protocol):
    """Who draws. All calls come one at a time; all but ``ending`` while nobody else draws."""

    def begun(self, job: MergeJob) -> None:
        """A run starts; what is on the screen is out of date from the first changed stage on."""

    def show(self, job: MergeJob, story: RunState) -> None:
        """Draw the newest state."""

    def ending(self, job: MergeJob, story: RunState) -> None:
        """The run is at its goal: work out what takes long to tell of it. It can still be stopped."""

    def waits(self, job: MergeJob, before: int) -> None:
        """Other tabs' runs have the processors; so many of them are before this one."""

    def ended(self, job: MergeJob, story: RunState) -> None:
        """The run came to its goal."""

    def stopped(self, job: MergeJob, story: RunState) -> None:
        """Someone pressed Stop."""

    def failed(self, job: MergeJob, story: RunState, error: Exception) -> None:
        """The run could not go on: a NoAnswerError where the method found no transform, another
        MapMergeError to be told, or a bug to be logged.
        """


class JobThread:
    """A thread and the request it works on.

    runner  : where it is worked out; closed with the thread
    drawing : held while the listener is told, so that nothing of a run is drawn after Stop has returned
    """

    def __init__(
        self,
        listener: Listener,
        runner: Runner,
        drawing: RLock | None = None,
        clock: Callable[[], float] = perf_counter,
        waiting: InterruptibleWait | None = None,
    ) -> None:
        self._listener, self.runner, self._clock = listener, runner, clock
        self._waiting = waiting or InterruptibleWait()
        self._wake = Condition()
        self._wanted: MergeJob | None = None
        self._running: MergeJob | None = None
        self._ended: MergeJob | None = None  # the last that came to its end
        self._story = RunState()
        self._pace = 0.0
        self._closed = False
        self.drawing = drawing or RLock()
        self._worker = Thread(target=self._work, name="mapmeld-session", daemon=True)
        self._worker.start()

    @property
    def busy(self) -> bool:
        """Whether a run is going on or about to."""
        return self._running is not None or self._wanted is not None

    @property
    def telling(self) -> bool:
        """Whether that is a run that is told step by step, and no search for a refusal's cause."""
        job = self._wanted or self._running
        return job is not None and job.goal != "cause"

    def request(self, job: MergeJob) -> None:
        """Run this next; a run that is going on is left where it is."""
        with self._wake:
            if self._closed:
                return
            self._wanted = job
            self._wake.notify()
        self._waiting.cut()

    def set_pace(self, pace: float) -> None:
        """Tell a run that is being told at a pace at another one, from the step at hand on."""
        if self._pace > 0 and pace > 0:
            self._pace = pace
            self._waiting.cut()

    def stop(self) -> None:
        """Leave the run that is going on; nothing of it is drawn once this has returned."""
        with self._wake:
            self._wanted = None
            job, self._running = self._running, None
        self._waiting.cut()
        with self.drawing:
            if job is not None and job is not self._ended:  # it may have come to its end just now
                self._listener.stopped(job, self._story)

    def told_again(self, job: MergeJob, wanted: Callable[[], bool]) -> Iterator[Step]:
        """The steps of a run once more, for a recording: those that are known are not computed again."""
        return self.runner.steps(job, RunCallbacks(wanted), aside=True)

    def close(self) -> None:
        """End the worker; the tab is gone."""
        with self._wake:
            self._closed, self._wanted, self._running = True, None, None
            self._wake.notify()
        self._waiting.cut()

    def _work(self) -> None:
        try:
            self._work_on()
        finally:
            self.runner.close()

    def _work_on(self) -> None:
        while True:
            with self._wake:
                self._wake.wait_for(lambda: self._closed or self._wanted is not None)
                if self._closed:
                    return
                job, self._wanted = self._wanted, None
                assert job is not None
                self._running, self._story, self._pace = job, RunState(job.config), job.pace
            began = self._clock()
            try:
                self._tell(job)
            except MapMergeError as error:
                self._fail(job, error)
            except Exception as error:
                log.exception("a run of %s ended in a bug", job.method)
                self._fail(job, error)
            log.info("run over", extra=facts(method=job.method, seconds=round(self._clock() - began, 3)))
            with self._wake:
                if self._running is job:
                    self._running = None

    def _fail(self, job: MergeJob, error: Exception) -> None:
        self._deliver(job, lambda: self._listener.failed(job, self._story, error))

    def _tell(self, job: MergeJob) -> None:
        """Iterate the method; draw at most every FRAME, except where a step is meant to be seen."""
        story = self._story
        if not self._deliver(job, lambda: self._listener.begun(job)):
            return
        drawn_at = -FRAME
        with closing(self.runner.steps(job, self._asker(job))) as steps:
            for step in steps:
                story.tell(step)
                mark = self._waiting.mark
                stay = dwell(step, self._pace, job.again)
                if not self._wants(job):
                    return
                if stay >= FRAME or self._clock() - drawn_at >= FRAME:
                    drawn_at = self._clock()
                    if not self._deliver(job, lambda: self._listener.show(job, story)):
                        return
                    stay -= self._clock() - drawn_at
                self._waiting.wait(stay, mark)
                if not self._wants(job):
                    return
                if job.goal == "candidates" and isinstance(step.detail, (CandidatesDetail, AnswersDetail)):
                    break
                if isinstance(step.detail, MergeResult):
                    break
        self._listener.ending(job, story)
        self._deliver(job, lambda: self._end(job, story))

    def _end(self, job: MergeJob, story: RunState) -> None:
        self._ended = job
        self._listener.ended(job, story)

    def _asker(self, job: MergeJob) -> RunCallbacks:
        def waits(before: int) -> None:
            self._deliver(job, lambda: self._listener.waits(job, before))

        return RunCallbacks(lambda: self._wants(job), waits)

    def _wants(self, job: MergeJob) -> bool:
        return self._running is job and self._wanted is None and not self._closed

    def _deliver(self, job: MergeJob, tell: Callable[[], None]) -> bool:
        """Tell the listener, unless the run has been stopped or overtaken; whether it was told."""
        with self.drawing:
            if not self._wants(job):
                return False
            tell()
        return True
