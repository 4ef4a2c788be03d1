"""Long work of a tab beside its page: in processes of its own, which give way to whatever the page does."""

from __future__ import annotations

import logging
from collections.abc import Callable, Iterator
from contextlib import closing
from threading import Event, RLock, Thread
from time import perf_counter
from typing import Any, Protocol

from algorithms.common import parallel_kernels as kernels
from algorithms.common.errors import MapMergeError
from app.jobs.executor import Executor
from app.jobs.fair_semaphore import FairSemaphore
from app.jobs.process_executor import ProcessExecutor

log = logging.getLogger(__name__)

MOST_AT_ONCE = 2  # comparisons and sweeps of all tabs; a further one waits for its turn

_turns = FairSemaphore(MOST_AT_ONCE, patience=0.0)


def beside_the_page(jobs: int) -> Executor:
    """Processes for work behind a page: one core is left to it, and what is left is not fought for."""
    return ProcessExecutor(max(1, min(jobs, kernels.cores() - 1)), gentle=True)


class JobListener(Protocol):
    """Who is told of the work; one call at a time, with nobody else drawing."""

    def part_done(self, part: Any) -> None:
        """The next of what the work yields."""

    def ended(self, why: str) -> None:
        """It has come to its end; ``why`` it could not, as a sentence, empty where it could."""


class BackgroundJob:
    """One piece of work at a time, in a thread of its own. Nothing is told once ``stop`` has returned."""

    def __init__(
        self, listener: JobListener, drawing: RLock, name: str, say: Callable[[str, float], None]
    ) -> None:
        """say : shows a sentence, and the share of the work that is done"""
        self._listener, self._drawing, self._name, self._say = listener, drawing, name, say
        self._stop: Event | None = None  # of the work at hand
        self._began = 0.0

    @property
    def seconds(self) -> float:
        """Since it has been its turn."""
        return perf_counter() - self._began

    @property
    def busy(self) -> bool:
        return self._stop is not None

    def start(self, work: Callable[[Event], Iterator[Any]]) -> None:
        """Do this in place of whatever is going on: a generator that ends soon once its event is set."""
        stop = Event()
        with self._drawing:
            self.stop()
            self._stop = stop
        Thread(target=self._run, args=(work, stop), name=f"mapmeld-{self._name}", daemon=True).start()

    def stop(self) -> bool:
        """Leave what is going on; whether there was anything."""
        with self._drawing:
            stop, self._stop = self._stop, None
            if stop is not None:
                stop.set()
        return stop is not None

    def _run(self, work: Callable[[Event], Iterator[Any]], stop: Event) -> None:
        why = ""

        def waits(_: int) -> None:
            self._tell(stop, lambda: self._say("Waits: other tabs compare or sweep already.", 0.0))

        with _turns.take(lambda: not stop.is_set(), waits) as mine:
            if not mine:
                return
            try:
                self._tell(stop, self._begin)
                with closing(work(stop)) as parts:  # type: ignore[type-var]
                    for part in parts:
                        if not self._tell(stop, lambda part=part: self._listener.part_done(part)):
                            return
            except MapMergeError as error:
                why = str(error)
            except Exception as error:
                log.exception("the %s ended in a bug", self._name)
                why = (
                    f"A bug of mapmeld's ended it ({type(error).__name__}); the server's log has the details."
                )
        self._tell(stop, lambda: self._over(why))

    def _begin(self) -> None:
        self._began = perf_counter()
        self._say("Starting.", 0.0)

    def _over(self, why: str) -> None:
        self._stop = None
        self._listener.ended(why)

    def _tell(self, stop: Event, tell: Callable[[], None]) -> bool:
        with self._drawing:
            if self._stop is not stop:
                return False
            tell()
        return True
