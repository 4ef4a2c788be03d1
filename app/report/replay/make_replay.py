"""A run as one HTML page that plays offline: recorded from the same pictures and words as the page's."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial
from typing import TYPE_CHECKING

from app.model import status_text as words
from app.model.merge_inputs import MergeInputs
from app.model.run_state import RunState
from app.report.replay.html_page import replay_html
from app.report.replay.metadata import ReplayMetadata
from app.report.replay.recorder import record
from app.system.cancellation import Check, unwatched, wanted

if TYPE_CHECKING:
    from algorithms.methods.steps import Step
    from app.model.merge_job import MergeJob


def replay_of(
    job: MergeJob,
    steps: Callable[[MergeJob, Callable[[], bool]], Iterator[Step]],
    inputs: MergeInputs,
    check: Check = unwatched,
) -> bytes:
    """The page for a run.

    job    : what ran, and how
    steps  : gives the steps of that run, as long as they are wanted
    inputs : the same maps and sightings, with their name and, where it is known, the truth
    check  : is called at every step
    """

    def watched() -> Iterator[Step]:
        story = RunState(job.config)
        for step in steps(job, partial(wanted, check)):
            story.tell(step)
            check(words.progress(story))
            yield step
        check()  # they end early where they are not wanted

    about = ReplayMetadata(inputs, job.method, job.config, job.seed)
    return replay_html(record(watched(), inputs, job.config), about)
