"""Work in processes of this machine. A process that dies costs a second try, not an answer."""

from __future__ import annotations

import os
import signal
from collections.abc import Generator, Iterable, Iterator
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from functools import lru_cache
from itertools import chain
from multiprocessing import get_context
from multiprocessing.connection import Connection
from pathlib import Path
from tempfile import TemporaryDirectory
from threading import Event, Thread
from typing import Any

import cv2

from algorithms.common import parallel_kernels as kernels
from algorithms.common.errors import OutputError
from app.jobs.executor import Executor, LostTask, Shared, Task, Work, unpacked

LOOK_S = 0.1  # how often it is looked whether all is to stop
KEPT = 2  # shared values that a process holds on to; tasks that share one come one after the other
SPAWN = get_context("spawn")  # a copy of a process that already has threads can hang

Numbered = tuple[int, Task]


Unfinished = tuple[list[Numbered], list[Numbered]]
"""Where a process has died: the tasks that were being worked on, and the one that nobody had begun."""


class ProcessExecutor(Executor):
    """Processes of this machine, which share its cores evenly."""

    def __init__(self, jobs: int, gentle: bool = False) -> None:
        """gentle : they take only what time others leave them."""
        self.jobs, self._gentle = jobs, gentle

    def run(self, work: Work, tasks: Iterable[Task], stop: Event | None = None) -> Iterator[tuple[int, Any]]:
        left = iter(enumerate(tasks))
        with _folder() as folder:
            while True:
                stopped = yield from self._some(work, left, self.jobs, folder, stop)
                if stopped is None:
                    return
                suspects, untouched = stopped
                left, again = chain(untouched, left), iter(suspects)
                # who of them took its process down? Each alone shows it
                while stopped := (yield from self._some(work, again, 1, folder, stop)):
                    suspects, untouched = stopped
                    again = chain(untouched, again)
                    for number, _ in suspects:
                        yield number, LostTask()

    def _some(
        self, work: Work, left: Iterator[Numbered], jobs: int, folder: Path, stop: Event | None
    ) -> Generator[tuple[int, Any], None, Unfinished | None]:
        """Yield answers until no task is left; return what a process that died has left behind."""
        # a process ends when nobody holds the other end any more: it was closed, or this one is dead
        listening, line = SPAWN.Pipe(duplex=False)
        running: dict[Future[Any], Numbered] = {}
        pool = ProcessPoolExecutor(
            jobs, mp_context=SPAWN, initializer=_begin, initargs=(listening, self.jobs, self._gentle)
        )
        try:
            while stop is None or not stop.is_set():
                while len(running) < jobs and (found := next(left, None)) is not None:
                    number, task = found
                    path = None if task.shared is None else _laid_down(task.shared, folder)
                    try:
                        running[pool.submit(_do, work, path, task.order)] = found
                    except BrokenProcessPool:  # an idle process has died meanwhile
                        return (yield from _rescued(running)), [found]
                if not running:
                    return None
                for future in wait(running, None if stop is None else LOOK_S, FIRST_COMPLETED).done:
                    if isinstance(future.exception(), BrokenProcessPool):
                        return (yield from _rescued(running)), []
                    number, _ = running.pop(future)
                    yield number, future.result()
            return None
        finally:
            if running:  # Ctrl-C, or a caller that has left the loop: nobody waits for the rest
                line.close()
            pool.shutdown(wait=True, cancel_futures=True)
            line.close()
            listening.close()


def _rescued(running: dict[Future[Any], Numbered]) -> Generator[tuple[int, Any], None, list[Numbered]]:
    """Yield the answers that were there before the pool broke; return the tasks that have none."""
    lost = []
    for future, found in running.items():
        # all are done soon: the pool ends what it can't do any more
        if isinstance(future.exception(), BrokenProcessPool):
            lost.append(found)
        else:
            yield found[0], future.result()
    return lost


@contextmanager
def _folder() -> Iterator[Path]:
    """A folder for what the processes share, gone afterwards."""
    try:
        folder = TemporaryDirectory(prefix="mapmeld-", ignore_cleanup_errors=True)
    except OSError as error:
        raise _no_room(error) from error
    with folder as path:
        yield Path(path)


def _laid_down(shared: Shared, folder: Path) -> Path:
    path = folder / shared.key
    if not path.exists():
        try:
            path.write_bytes(shared.data)
        except OSError as error:
            raise _no_room(error) from error
    return path


def _no_room(error: OSError) -> OutputError:
    return OutputError(
        "the folder for temporary files",
        f"cannot be written to ({error.strerror})",
        "make room in it, or name another one in $TMPDIR",
    )


# ---- what runs in the other process


def _begin(line: Connection, jobs: int, gentle: bool) -> None:
    if gentle and hasattr(os, "nice"):  # not on Windows
        os.nice(10)
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the first process hears it and ends the others
    threads = max(1, kernels.cores() // jobs)
    kernels.use_threads(threads)
    cv2.setNumThreads(threads)
    Thread(target=_end_with, args=(line,), daemon=True).start()


def _end_with(line: Connection) -> None:
    try:
        line.recv()
    except EOFError:
        os._exit(1)


def _do(work: Work, path: Path | None, order: Any) -> Any:
    return work(None if path is None else _value_in(path), order)


@lru_cache(maxsize=KEPT)
def _value_in(path: Path) -> Any:
    return unpacked(path.read_bytes())
