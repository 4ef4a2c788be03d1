"""A run as one HTML page that plays offline: recorded from the same pictures and words as the page's."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING

from app.inputs import Inputs
from app.replay.facts import About
from app.replay.page import replay_html
from app.replay.record import record

if TYPE_CHECKING:
    from algorithms.steps import Step
    from app.session import Job

__all__ = ["About", "record", "replay_html", "replay_of"]


def replay_of(job: Job, steps: Callable[[Job], Iterator[Step]], inputs: Inputs) -> bytes:
    """The page for a run.

    job    : what ran, and how
    steps  : gives the steps of that run
    inputs : the same maps and sightings, with their name and, where it is known, the truth
    """
    about = About(inputs, job.method, job.config, job.seed)
    return replay_html(record(steps(job), inputs, job.config), about)
