"""The picture of a sample, looked at once for all tests; and the lesson's look, brought to its end."""

from __future__ import annotations

from functools import cache
from typing import Any

from app.model.merge_inputs import MergeInputs
from app.model.run_state import RunState
from app.page.lesson.side_runs import SideRuns
from app.page.lesson.sighting_look import SightingLook, look, sighting_runs
from app.system import data_paths as paths


@cache
def look_at(name: str) -> SightingLook:
    """What camera and laser saw that belong to a sample of this name."""
    folder = paths.samples()[name]
    return look(folder, folder)


def looked(inputs: MergeInputs, config: Any) -> SideRuns:
    """The look that belongs to a pair of maps, over."""
    runs = sighting_runs(inputs, config)
    for one in runs.each:
        one.run = RunState(one.job.config)
        for step in one.job.run({}):
            one.run.add(step)
    return runs
