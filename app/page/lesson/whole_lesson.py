"""The lesson at its end: its own run, and all that its steps compare, with nobody looking on."""

from __future__ import annotations

from collections.abc import Callable, Collection

from algorithms.common.errors import MapMergeError
from algorithms.methods import registry as methods
from algorithms.methods.steps import Step
from app.model.merge_inputs import MergeInputs
from app.model.run_state import RunState
from app.page.lesson.figures.figure_registry import PICTURES
from app.page.lesson.lesson_run import LessonRun, keep
from app.page.lesson.side_runs import SideRun

Tell = Callable[[float, str], None]


def whole_lesson(
    inputs: MergeInputs,
    pictures: Collection[str] = PICTURES,
    seed: int = 0,
    tell: Tell = lambda done, what: None,
) -> LessonRun:
    """Work out what pictures of the lesson show of a pair with a sighting, by the method that the page takes.

    pictures : their names
    tell     : called with the share that is done, and what comes next
    Raises NoAnswerError where the maps have no transform at all to show.
    """
    assert inputs.ref is not None
    assert inputs.mov is not None
    config, steps = methods.METHODS[methods.DEFAULT_METHOD].defaults, list[Step]()
    tell(0.0, inputs.title)
    for step in methods.run(methods.DEFAULT_METHOD, inputs.ref, inputs.mov, inputs.known, config, seed):
        keep(steps, step)
    lesson = LessonRun(inputs, config, seed, tuple(steps))
    compared = {
        name: of.compares(lesson) for name, of in PICTURES.items() if name in pictures and of.compares
    }
    each = [one for runs in compared.values() for one in runs.each]
    for number, one in enumerate(each, 1):
        tell(number / (len(each) + 1), one.title)
        _work_out(one)
    lesson.sides.update(compared)
    tell(1.0, "")
    return lesson


def _work_out(one: SideRun) -> None:
    if one.failed:
        return
    one.run = RunState(one.job.config)
    try:
        for step in one.job.run({}):
            one.run.add(step)
    except MapMergeError as error:  # told in its place, as on the page
        one.failed = str(error)
