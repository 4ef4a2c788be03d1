"""Stages in a row, each told step by step, timed, and remembered for the next run."""

from __future__ import annotations

from collections.abc import Callable, Generator, Iterable
from time import perf_counter
from typing import Any

from algorithms.methods.steps import Detail, RefineDetail, Step

# Snapshots of a search that are remembered for showing it again; a longer search is shown again with
# gaps. 2,000 particles through 300 iterations of 24 candidates would fill a gigabyte.
MOST_BYTES = 64_000_000

# stage -> what went into it, the steps that came out. Inputs are compared with ==: settings by
# value, maps and outputs of earlier stages by identity.
StageCache = dict[str, tuple[tuple[Any, ...], list[Step]]]


class StageRunner:
    """Runs one stage after another and knows what each took.

    timings_s : seconds per stage so far; of the run that did the work where a stage was reused
    """

    def __init__(self, memo: StageCache) -> None:
        self._memo = memo
        self.timings_s: dict[str, float] = {}

    def stage(
        self, name: str, inputs: tuple[Any, ...], make: Callable[[], Iterable[Detail]]
    ) -> Generator[Step, None, Any]:
        """Yield a Step per detail that ``make`` gives, and return the last detail.

        With inputs equal to those of the last complete run of this stage, its steps are given again
        and ``make`` is not called. A stage that the caller leaves half-way is not remembered.
        """
        known = self._memo.get(name)
        if known is not None and known[0] == inputs:
            steps = known[1]
            self.timings_s[name] = sum(step.seconds for step in steps)
            for step in steps:
                yield Step(name, step.detail, step.seconds, reused=True)
            return steps[-1].detail
        self._memo.pop(name, None)
        self.timings_s[name] = 0.0
        steps, held = [], 0
        began = perf_counter()
        details = iter(make())
        while True:
            detail = next(details, None)
            seconds = perf_counter() - began
            self.timings_s[name] += seconds
            if detail is None:
                break
            step = Step(name, detail, seconds)
            steps.append(step)
            held += _bytes(step)
            if held > MOST_BYTES:
                steps = _with_gaps(steps)
                held = sum(map(_bytes, steps))
            yield step
            began = perf_counter()
        self._memo[name] = (inputs, steps)
        return steps[-1].detail


def _bytes(step: Step) -> int:
    """What a snapshot holds on to; the other details are few."""
    if not isinstance(step.detail, RefineDetail):
        return 0
    state = step.detail.state
    arrays = (state.poses, state.values, state.own_poses, state.own_values, state.pulls)
    return sum(array.nbytes for array in arrays if array is not None)


def _with_gaps(steps: list[Step]) -> list[Step]:
    """Every other snapshot left out; never the last of a candidate, nor what is not a snapshot."""
    return [
        step
        for position, step in enumerate(steps)
        if position % 2 == 0 or not isinstance(step.detail, RefineDetail) or step.detail.state.stopped
    ]
