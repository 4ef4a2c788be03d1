"""Where a tab's runs are worked out: a worker process, which serves several tabs, each in its turn."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Generator, Iterator
from contextlib import closing
from dataclasses import dataclass

from algorithms.methods.steps import Step
from app.model.merge_job import MergeJob


@dataclass(frozen=True)
class RunCallbacks:
    """Who wants a run.

    wanted : whether they still do; asked now and then
    waits  : is called with how many are before it, where it takes a while
    """

    wanted: Callable[[], bool] = lambda: True
    waits: Callable[[int], None] = lambda before: None


class Runner(ABC):
    """Of one tab. It remembers the stages of one run for the next."""

    @abstractmethod
    def steps(
        self, job: MergeJob, callbacks: RunCallbacks, aside: bool = False
    ) -> Generator[Step, None, None]:
        """The steps of a run, each worked out when it is asked for and it is this run's turn.

        They end early where nobody wants them any more.

        aside  : the next run is not to know of this one
        raises : what the run raises, and WorkerDiedError
        """

    @abstractmethod
    def close(self) -> None:
        """Nobody wants anything of it any more."""


class TappedRunner(Runner):
    """Another runner, whose steps pass through a function; who made it closes it."""

    def __init__(self, runner: Runner, through: Callable[[Iterator[Step]], Iterator[Step]]) -> None:
        self._runner, self._through = runner, through

    def steps(
        self, job: MergeJob, callbacks: RunCallbacks, aside: bool = False
    ) -> Generator[Step, None, None]:
        with closing(self._runner.steps(job, callbacks, aside)) as steps:
            yield from self._through(steps)

    def close(self) -> None:
        pass
