"""One tab's work: newest request wins, one worker computes, and a listener gets every step at a pace."""

from __future__ import annotations

import logging
from collections.abc import Callable, Iterator
from contextlib import closing
from functools import partial
from threading import RLock
from time import perf_counter
from typing import Protocol

from algorithms.common.errors import MapMergeError
from algorithms.methods.merge_result import MergeResult
from algorithms.methods.steps import AnswersDetail, CandidatesDetail, Step
from app.jobs.latest_request import LatestRequest
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

    def show(self, job: MergeJob, run: RunState) -> None:
        """Draw the newest state."""

    def ending(self, job: MergeJob, run: RunState) -> None:
        """The run is at its goal: work out what takes long to tell of it. It can still be stopped."""

    def waits(self, job: MergeJob, before: int) -> None:
        """Other tabs' runs have the processors; so many of them are before this one."""

    def ended(self, job: MergeJob, run: RunState) -> None:
        """The run came to its goal."""

    def stopped(self, job: MergeJob, run: RunState) -> None:
        """Someone pressed Stop."""

    def failed(self, job: MergeJob, run: RunState, error: Exception) -> None:
        """The run could not go on: with a NoAnswerError, another MapMergeError, or a bug."""


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
        self._ended: MergeJob | None = None  # the last that came to its end
        self._told: tuple[MergeJob | None, RunState] = (None, RunState())  # the run at hand
        self._pace = 0.0
        self.drawing = drawing or RLock()
        self._requests = LatestRequest(self._work, "mapmeld-session", runner.close)

    @property
    def busy(self) -> bool:
        """Whether a run is going on or about to."""
        return self._requests.newest is not None

    @property
    def runs_method(self) -> bool:
        """Whether that is a run that is told step by step, and no search for a refusal's cause."""
        job = self._requests.newest
        return job is not None and job.goal != "cause"

    def request(self, job: MergeJob) -> None:
        """Run this next; a run that is going on is left where it is."""
        self._requests.ask(job)
        self._waiting.cut()

    def set_pace(self, pace: float) -> None:
        """Tell a run that is being told at a pace at another one, from the step at hand on."""
        if self._pace > 0 and pace > 0:
            self._pace = pace
            self._waiting.cut()

    def stop(self) -> None:
        """Leave the run that is going on; nothing of it is drawn once this has returned."""
        job = self._requests.drop()
        self._waiting.cut()
        with self.drawing:
            if job is not None and job is not self._ended:  # it may have come to its end just now
                of, run = self._told
                self._listener.stopped(job, run if of is job else RunState(job.config))

    def steps_again(self, job: MergeJob, wanted: Callable[[], bool]) -> Iterator[Step]:
        """The steps of a run once more, for a recording: those that are known are not computed again."""
        return self.runner.steps(job, RunCallbacks(wanted), aside=True)

    def close(self) -> None:
        self._requests.close()
        self._waiting.cut()

    def _work(self, job: MergeJob) -> None:
        began, run = self._clock(), RunState(job.config)
        self._told, self._pace = (job, run), job.pace

        try:
            self._tell(job, run)
        except Exception as error:
            if not isinstance(error, MapMergeError):
                log.exception("a run of %s ended in a bug", job.method)
            self._deliver(job, partial(self._listener.failed, job, run, error))
        log.info("run over", extra=facts(method=job.method, seconds=round(self._clock() - began, 3)))

    def _tell(self, job: MergeJob, run: RunState) -> None:
        """Iterate the method; draw at most every FRAME, except where a step is meant to be seen."""

        def waits(before: int) -> None:
            self._deliver(job, partial(self._listener.waits, job, before))

        def end() -> None:
            self._ended = job
            self._listener.ended(job, run)

        callbacks = RunCallbacks(partial(self._requests.wants, job), waits)
        if not self._deliver(job, partial(self._listener.begun, job)):
            return
        drawn_at = -FRAME
        with closing(self.runner.steps(job, callbacks)) as steps:
            for step in steps:
                run.add(step)
                mark = self._waiting.mark
                stay = dwell(step, self._pace, job.again)
                if not self._requests.wants(job):
                    return
                if stay >= FRAME or self._clock() - drawn_at >= FRAME:
                    drawn_at = self._clock()
                    if not self._deliver(job, partial(self._listener.show, job, run)):
                        return
                    stay -= self._clock() - drawn_at
                self._waiting.wait(stay, mark)
                if not self._requests.wants(job):
                    return
                if job.goal == "candidates" and isinstance(step.detail, (CandidatesDetail, AnswersDetail)):
                    break
                if isinstance(step.detail, MergeResult):
                    break
        self._listener.ending(job, run)
        self._deliver(job, end)

    def _deliver(self, job: MergeJob, tell: Callable[[], None]) -> bool:
        """Tell the listener, unless the run has been stopped or overtaken; whether it was told."""
        with self.drawing:
            if not self._requests.wants(job):
                return False
            tell()
        return True
