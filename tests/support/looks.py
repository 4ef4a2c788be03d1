"""The picture of a sample, looked at once for all tests; the lesson's look and its run, at their end."""

from __future__ import annotations

from functools import cache
from typing import Any

from algorithms.files.case_folder import Case
from algorithms.methods.registry import METHODS, run
from algorithms.methods.steps import Step
from app.model.merge_inputs import MergeInputs
from app.model.run_state import RunState
from app.page.lesson.lesson_run import LessonRun, keep
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


def lesson_of(
    case: Case, config: Any = METHODS["spectra-proven"].defaults, sides: dict[str, SideRuns] | None = None
) -> LessonRun:
    """The lesson's run on a pair of maps, over; ``sides``: the look is there, or none is wanted."""
    steps: list[Step] = []
    for step in run("spectra-proven", case.ref, case.mov, case.observations, config):
        keep(steps, step)
    inputs = MergeInputs.of(case)
    look_too = {"sighting": looked(inputs, config)} if sides is None else sides
    return LessonRun(inputs, config, 0, tuple(steps), look_too)
