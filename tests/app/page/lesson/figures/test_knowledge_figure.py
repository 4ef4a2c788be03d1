"""The merges with less and more known, side by side, as far as each has come."""

from __future__ import annotations

from xml.etree import ElementTree

import pytest

from algorithms.methods.merge_result import MergeResult
from algorithms.methods.registry import METHODS
from algorithms.methods.steps import PlaneDetail, Step
from app.drawing.palette import DARK, LIGHT
from app.model.merge_inputs import MergeInputs
from app.model.run_state import RunState
from app.page.lesson.figures.figure_registry import PICTURES
from app.page.lesson.figures.knowledge_figure import ROWS
from app.page.lesson.lesson_run import LessonRun
from app.page.lesson.side_runs import knowledge_runs

FIGURE = PICTURES["knowledge"]
TEXT = "{http://www.w3.org/2000/svg}text"


@pytest.fixture
def lesson(small_case, result) -> LessonRun:
    """A lesson whose own run is over, and none of the merges begun."""
    inputs, own = MergeInputs.of(small_case), (Step("verdict", result, 0.0),)
    sides = {"knowledge": knowledge_runs(inputs)}
    return LessonRun(inputs, METHODS["spectra-proven"].defaults, 0, own, sides)


@pytest.fixture(scope="module")
def steps(small_case) -> list[Step]:
    """Of the merge with the sighting."""
    *_, exact = knowledge_runs(MergeInputs.of(small_case)).each
    return list(exact.job.run({}))


def told(steps: list[Step]) -> RunState:
    story = RunState(METHODS["whole-plane"].defaults)
    for step in steps:
        story.add(step)
    return story


def words(lesson: LessonRun, at: tuple[int, ...] = (), palette=LIGHT) -> list[str]:
    return [text.text for text in ElementTree.fromstring(FIGURE.draw(lesson, at, palette)).iter(TEXT)]


def test_before_they_begin_each_waits_and_the_map_shows_the_lessons_own(lesson, result):
    assert words(lesson).count("waits …") == 3
    assert words(lesson).count("…") == 3 * len(ROWS)
    assert FIGURE.dials(lesson) == ()
    assert FIGURE.run(lesson, ()).get(MergeResult) is result


@pytest.mark.parametrize("palette", [LIGHT, DARK], ids=["light", "dark"])
def test_the_one_at_work_says_how_far_it_is_on_the_map_too(lesson, steps, palette):
    plane = [step for step in steps if isinstance(step.detail, PlaneDetail)]
    first = lesson.sides["knowledge"].each[0]
    first.run = told(plane[:3])
    assert "24 of 120 turns" in words(lesson, palette=palette)
    assert FIGURE.run(lesson, ()) is first.run
    first.run = told(plane)
    assert "climbs …" in words(lesson, palette=palette)
    assert words(lesson).count("…") == 3 * len(ROWS) - 3  # how much was searched is known


def test_once_all_are_over_their_numbers_stand_side_by_side_and_any_can_be_put_on_the_map(lesson, steps):
    for one in lesson.sides["knowledge"].each:
        one.run = told(steps)
    found = words(lesson)
    assert "…" not in found
    assert sum(word.endswith("merged") for word in found) == 3
    assert sum(word.endswith(" s") for word in found) == 3
    (dial,) = FIGURE.dials(lesson)
    assert dial.count == 3
    for place in range(3):
        assert FIGURE.run(lesson, (place,)) is lesson.sides["knowledge"].each[place].run


def test_where_there_is_no_answer_the_others_stand_beside_it(lesson, steps):
    none, *others = lesson.sides["knowledge"].each
    none.failed = "no walls coincide"
    for one in others:
        one.run = told(steps)
    found = words(lesson)
    assert "no answer" in found
    assert found.count("–") == len(ROWS)
    assert FIGURE.run(lesson, (0,)).last is not None
