"""Who does long work: processes on this machine, or the workers of a Dask cluster. One interface for all.

Work is a function and its orders, all of which can be pickled. Answers come as they are done, and don't
depend on who did them, on how many there are, or on workers that died in between.
"""

from __future__ import annotations

import pickle
import secrets
import zlib
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, field
from threading import Event
from typing import Any

Work = Callable[[Any, Any], Any]
"""``work(shared, order)`` makes an answer; ``shared`` is the value of the task's Shared, or None."""


@dataclass(frozen=True)
class Shared:
    """A value that several tasks need: it travels to a worker once, not with every task."""

    data: bytes = field(repr=False)
    key: str

    @staticmethod
    def of(value: Any) -> Shared:
        """Pack a value. Grid maps are mostly floor: they shrink to a twentieth."""
        return Shared(zlib.compress(pickle.dumps(value), 1), secrets.token_hex(8))


def unpacked(data: bytes) -> Any:
    return pickle.loads(zlib.decompress(data))


@dataclass(frozen=True)
class Task:
    """One order, with the value it shares with others, if any."""

    order: Any
    shared: Shared | None = None


@dataclass(frozen=True)
class LostTask:
    """In place of an answer: whoever worked on the task died of it, each time that it was tried."""

    reason: str = "the process that ran it ended; was there too little memory?"


class Executor(ABC):
    """Does tasks.

    jobs : how many at a time
    far  : whether its workers may be on other machines: they can't read files of this one
    """

    jobs: int
    far = False

    @abstractmethod
    def run(self, work: Work, tasks: Iterable[Task], stop: Event | None = None) -> Iterator[tuple[int, Any]]:
        """Yield (number of the task, answer or LostTask) in the order of completion.

        Tasks are taken from the iterable only as workers become free. Whoever leaves the loop, or
        closes the generator, stops the work. What ``work`` raises is raised here.

        stop : set by another thread, which can't close a generator at work, it ends the loop: at once,
               or after the task at hand where this process does it
        """


class SerialExecutor(Executor):
    """This process, one task after the other."""

    jobs = 1

    def run(self, work: Work, tasks: Iterable[Task], stop: Event | None = None) -> Iterator[tuple[int, Any]]:
        known: tuple[str, Any] = ("", None)
        for number, task in enumerate(tasks):
            if stop is not None and stop.is_set():
                return
            if task.shared is not None and task.shared.key != known[0]:
                known = (task.shared.key, unpacked(task.shared.data))
            yield number, work(None if task.shared is None else known[1], task.order)
