"""Progress bars on stderr, only where a person looks at it."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from tqdm import tqdm

from algorithms.methods.merge_result import MergeResult
from algorithms.methods.steps import Step
from app.model import status_text as words
from app.model.run_state import RunState

STEPS_FORMAT = "{desc:<9}|{bar}| {percentage:3.0f}% {elapsed}"


def result_of(steps: Iterator[Step]) -> MergeResult:
    """Run a method to its end with a bar that names the stage at work."""
    *_, last = with_bar(steps)
    return last.detail


def with_bar(steps: Iterator[Step]) -> Iterator[Step]:
    """The same steps, with that bar while they are taken."""
    run, stage = RunState(), ""
    with bar(total=1.0, bar_format=STEPS_FORMAT) as shown:
        for step in steps:
            run.add(step)
            shown.update(max(0.0, words.progress(run) - shown.n))
            if step.stage != stage:  # a new stage is named at once, however short it is
                stage = step.stage
                shown.set_description_str(stage)
            yield step


def bar(**kwargs: Any) -> tqdm:
    """A bar of tqdm that is gone when it is done, and silent where stderr is no terminal."""
    return tqdm(disable=None, leave=False, dynamic_ncols=True, **kwargs)
