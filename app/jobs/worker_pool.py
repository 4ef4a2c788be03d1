"""Merges in processes of their own: one that dies of its work takes no page with it.

A worker serves several tabs, a step at a time; what it has worked out for each it keeps. It is started
when it is first needed, and again when it has died.
"""

from __future__ import annotations

import atexit
import contextlib
import itertools
import logging
from collections.abc import Callable, Generator, Iterator
from math import inf
from multiprocessing.connection import Connection
from threading import Lock
from time import monotonic
from typing import Any

from algorithms.common import parallel_kernels as kernels
from algorithms.common.errors import MapMergeError
from algorithms.methods.steps import Step
from app.jobs import forked_start
from app.jobs.fair_semaphore import FairSemaphore
from app.jobs.incremental_pickle import IncrementalPickle
from app.jobs.runner import RunCallbacks, Runner
from app.jobs.worker_process import Failed, serve
from app.model.merge_job import MergeJob

log = logging.getLogger(__name__)

MOST = 4  # each has threads for all cores
HANGS = 10.0  # seconds that a step goes on unwanted, or a word is not heard, until its process is ended
HANGS_BESIDE = 60.0  # where other runs would end with it; and until a run has to have begun
LOOK_S = 0.25  # how often it is looked
START = forked_start.context()


class WorkerDiedError(MapMergeError):
    """The process that worked on a merge has ended; the next merge has a new one."""

    def __init__(self) -> None:
        super().__init__(
            "The process that merged has ended; was there too little memory? Nothing else is lost. Press "
            "Merge again; if it ends again, close other tabs or take smaller maps."
        )


class WorkerPool:
    """As many as there are cores, and not too many."""

    def __init__(self, most: int = MOST) -> None:
        self._most = max(1, min(most, kernels.cores()))
        self._workers: list[_Worker] = []
        self._lock, self._closed = Lock(), False

    def runner(self) -> Runner:
        """A runner for a tab; it takes no worker before its first run."""
        return PoolRunner(self)

    @property
    def pids(self) -> list[int]:
        return [worker.pid for worker in self._workers if worker.pid is not None]

    def close(self) -> None:
        """End them all; this is no death to speak of."""
        with self._lock:
            self._closed = True
        for worker in self._workers:
            worker.close()

    def assign(self, runner: PoolRunner) -> _Worker:
        """The worker of a tab: one that serves no other, if there may be one."""
        with self._lock:
            if all(worker.runners for worker in self._workers) and len(self._workers) < self._most:
                self._workers.append(_Worker())
                if self._closed:
                    self._workers[-1].close()
            worker = min(self._workers, key=lambda worker: len(worker.runners))
            worker.runners.add(runner)
            return worker


class _Worker:
    """A process and the line to it. Only who has the turn says something to it."""

    def __init__(self) -> None:
        self.turns = FairSemaphore(1)
        self.runners: set[PoolRunner] = set()
        self.life = 0  # how often it was started
        self.runs: set[tuple[int, int]] = set()  # that are under way
        self._process: Any = None
        self._line: Connection | None = None
        self._starting, self._closed = Lock(), False

    @property
    def pid(self) -> int | None:
        process = self._process
        return None if process is None else process.pid

    def start(self) -> None:
        """Have a process; one that died with nothing to do is missed by nobody."""
        if self._line is not None:
            if self._process.is_alive():
                return
            self._end()
        with self._starting:
            if self._closed:
                raise WorkerDiedError
            line, theirs = START.Pipe()
            process = START.Process(target=serve, args=(theirs,), name="mapmeld-merge", daemon=True)
            try:
                with forked_start.without_interrupt():
                    forked_start.start_parent()
                    process.start()
            except BaseException as error:
                line.close()
                if isinstance(error, (EOFError, ConnectionError)):  # the process that is copied has died
                    raise WorkerDiedError from error
                raise
            finally:
                theirs.close()  # the process alone holds it, so that its end is heard here
            self._process, self._line = process, line
            self.life += 1

    def ask(self, *order: Any, wanted: Callable[[], bool] | None = None) -> tuple[Any, ...]:
        """Have it do something; raises WorkerDiedError, also where it hangs.

        wanted : whether a step is still waited for; None: it is no step, and done in a moment
        """
        if self._line is None:
            raise WorkerDiedError
        try:
            self._line.send(order)
            until = monotonic() + (HANGS_BESIDE if order[0] == "start" else HANGS) if wanted is None else inf
            while not self._line.poll(LOOK_S):
                if wanted is not None and wanted():
                    until = inf
                elif until == inf:
                    until = monotonic() + (HANGS if len(self.runs) <= 1 else HANGS_BESIDE)
                elif monotonic() > until:
                    raise EOFError
            answer: tuple[Any, ...] = self._line.recv()
        except (EOFError, OSError, MemoryError) as error:
            self._end()
            raise WorkerDiedError from error
        return answer

    def _end(self) -> None:
        assert self._line is not None
        self._line.close()
        self.runs.clear()
        process, self._line, self._process = self._process, None, None
        process.kill()
        process.join()
        if not self._closed:
            log.warning("a process that merges has ended, with %s", process.exitcode)

    def close(self) -> None:
        """End the process, whatever it is at; one that is half started would complain of us on stderr."""
        self._closed = True
        with self._starting:
            process = self._process
        if process is not None:
            process.kill()


_numbers = itertools.count()


class PoolRunner(Runner):
    """A tab at its worker; its epoch counts how often both had to begin anew with each other."""

    def __init__(self, workers: WorkerPool) -> None:
        self._workers, self._number = workers, next(_numbers)
        self._worker: _Worker | None = None
        self._lock, self._closed = Lock(), False
        self._epoch, self._life = 0, 0
        self._pickler = IncrementalPickle("page")
        self._maps: tuple[object, object] = (None, None)

    def steps(
        self, job: MergeJob, callbacks: RunCallbacks, aside: bool = False
    ) -> Generator[Step, None, None]:
        with self._lock:
            if self._closed:
                raise WorkerDiedError
            worker = self._worker = self._worker or self._workers.assign(self)
        with worker.turns.take(callbacks.wanted, callbacks.waits) as mine:
            if not mine:
                return
            run, epoch = self._begin(worker, job, aside), self._epoch
        over, key = False, (self._number, run)
        worker.runs.add(key)
        try:
            while True:
                with worker.turns.take(callbacks.wanted, callbacks.waits) as mine:
                    if not mine:
                        return
                    over = True  # as it is where this fails
                    if self._epoch != epoch:
                        raise WorkerDiedError
                    step = self._next(worker, run, callbacks)
                if step is None:
                    return
                over = False
                yield step
        finally:
            worker.runs.discard(key)
            if not over:
                self._send(worker, epoch, "leave", run)

    def close(self) -> None:
        """As in Runner."""
        with self._lock:
            self._closed = True
        if self._worker is not None:
            self._send(self._worker, self._epoch, "forget")
            self._worker.runners.discard(self)
            self._epoch += 1

    def _begin(self, worker: _Worker, job: MergeJob, aside: bool) -> int:
        worker.start()
        if worker.life != self._life:
            self._reset()
            self._life = worker.life
        before, self._maps = self._maps, (job.ref, job.mov)
        others = any(new is not old for new, old in zip(self._maps, before, strict=True))
        turns = 1 + others  # what was made of other maps is not met again
        for _ in range(turns):
            self._pickler.turn_over()
        with self._in_step(worker):
            data = self._pickler.pack(job)
        (run,) = self._checked(worker.ask("start", self._number, aside, turns, data))
        return int(run)

    def _next(self, worker: _Worker, run: int, callbacks: RunCallbacks) -> Step | None:
        (data,) = self._checked(worker.ask("next", self._number, run, wanted=callbacks.wanted))
        with self._in_step(worker):
            return None if data is None else self._pickler.unpack(data)

    @contextlib.contextmanager
    def _in_step(self, worker: _Worker) -> Iterator[None]:
        """Begin anew with the worker where what is between both cannot be packed or unpacked."""
        try:
            yield
        except BaseException:
            self._reset()
            worker.ask("forget", self._number)
            raise

    def _checked(self, answer: tuple[Any, ...]) -> tuple[Any, ...]:
        if isinstance(failed := answer[0], Failed):
            if failed.anew:
                self._reset()
            raise failed.error from _RemoteError(failed.trace)
        return answer

    def _reset(self) -> None:
        self._pickler, self._maps = IncrementalPickle("page"), (None, None)
        self._epoch += 1

    def _send(self, worker: _Worker, epoch: int, verb: str, *what: Any) -> None:
        """Tell what matters only as long as nobody had to begin anew."""
        with worker.turns.get(), contextlib.suppress(WorkerDiedError):
            if self._epoch == epoch and worker.life == self._life:
                worker.ask(verb, self._number, *what)


class _RemoteError(Exception):
    """What went wrong in the other process, where it did: for the log."""

    def __str__(self) -> str:
        return f"\n{self.args[0]}"


COMMON = WorkerPool()
atexit.register(COMMON.close)
