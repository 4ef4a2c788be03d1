"""Maps that do not show what a step is about are told so, and the sample that is offered shows it."""

from __future__ import annotations

import pytest
from looks import lesson_of

from algorithms.files.case_folder import read_case
from app.model.merge_inputs import MergeInputs
from app.page.lesson.checks.effects import EFFECTS, missing
from app.page.lesson.figures.figure_registry import PICTURES
from app.page.lesson.lesson_run import LessonRun
from app.page.lesson.lesson_texts import files, lesson_folder, read_step
from app.page.lesson.placeholders import NUMBERS
from app.system import data_paths as paths

STEPS = [read_step(path, PICTURES, NUMBERS) for path in files(lesson_folder())]
OFFERED = [step.effect for step in STEPS if step.effect]


def of_sample(name: str) -> LessonRun:
    return lesson_of(read_case(paths.samples()[name]), sides={})


def test_every_test_of_maps_is_asked_by_a_step_that_names_the_sample_it_offers():
    assert {effect.test for effect in OFFERED} == set(EFFECTS)
    for effect in OFFERED:
        assert effect.sample in effect.missing
        assert effect.sample in paths.samples()


@pytest.mark.parametrize("effect", OFFERED, ids=lambda effect: effect.test)
def test_the_sample_that_is_offered_shows_it(effect):
    lesson = of_sample(effect.sample)
    assert lesson.reached(*EFFECTS[effect.test][0])
    assert not missing(effect.test, lesson)


def test_maps_of_two_buildings_turn_no_verdict_and_are_told_so(strangers):
    assert missing("verdict-turns", lesson_of(strangers, sides={}))


def test_where_one_place_alone_fits_there_is_nothing_to_choose_from():
    assert missing("several-answers", of_sample("office_r2_r1"))


@pytest.mark.parametrize("name", EFFECTS)
def test_nothing_is_said_before_the_run_has_come_to_it(name, small_case):
    config = lesson_of(small_case, sides={}).config
    assert not missing(name, LessonRun(MergeInputs.of(small_case), config))
