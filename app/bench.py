"""Where a tab's runs are worked out: a worker process, which serves several tabs, each in its turn."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Generator, Iterator
from contextlib import AbstractContextManager, closing

from algorithms.steps import Step
from app.job import Job
from app.turns import Turns

Take = Callable[[Turns], AbstractContextManager[bool]]
"""Waits for a turn; gives False where it is no longer wanted."""


class Bench(ABC):
    """Of one tab. It remembers the stages of one run for the next."""

    @abstractmethod
    def steps(self, job: Job, take: Take, aside: bool = False) -> Generator[Step, None, None]:
        """The steps of a run, each worked out when it is asked for and it is this run's turn.

        take   : waits for that turn; where it gets none, the steps end
        aside  : the next run is not to know of this one
        raises : what the run raises, and WorkerDiedError
        """

    @abstractmethod
    def close(self) -> None:
        """Nobody wants anything of it any more."""


class Overheard(Bench):
    """Another's bench; its steps go through somebody's hands on their way."""

    def __init__(self, bench: Bench, through: Callable[[Iterator[Step]], Iterator[Step]]) -> None:
        self._bench, self._through = bench, through

    def steps(self, job: Job, take: Take, aside: bool = False) -> Generator[Step, None, None]:
        """As in Bench."""
        with closing(self._bench.steps(job, take, aside)) as steps:
            yield from self._through(steps)

    def close(self) -> None:
        """Whose bench it is closes it."""
