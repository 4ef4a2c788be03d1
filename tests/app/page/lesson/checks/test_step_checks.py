"""What a step asks for is not done when it opens, and done once it was done."""

from __future__ import annotations

from math import degrees

import pytest
from looks import lesson_of

from algorithms.common.pose import wrap_angle
from algorithms.files.case_folder import read_case
from algorithms.maps.map_fusion import ConflictRule
from algorithms.methods.merge_result import MergeResult
from algorithms.methods.registry import METHODS
from algorithms.methods.steps import HoughDetail
from app.model.merge_inputs import MergeInputs
from app.model.settings import with_value
from app.page.lesson.checks.step_checks import CHECKS, Seen, done
from app.page.lesson.figures import fit_figure
from app.page.lesson.figures.figure_registry import PICTURES
from app.page.lesson.figures.figure_slider import place_of
from app.page.lesson.figures.map_figures import SPREAD
from app.page.lesson.lesson_run import LessonRun
from app.page.lesson.lesson_texts import files, lesson_folder, read_step
from app.page.lesson.placeholders import NUMBERS
from app.page.lesson.whole_lesson import whole_lesson
from app.system import data_paths as paths

CONFIG = METHODS["spectra-proven"].defaults
STEPS = [read_step(path, PICTURES, NUMBERS) for path in files(lesson_folder())]
OF_STEP = {step.check.test: step for step in STEPS if step.check}


@pytest.fixture(scope="module")
def lesson() -> LessonRun:
    """Of the sample that the page opens with, with all that its steps compare."""
    return whole_lesson(MergeInputs.of(read_case(paths.samples()["office_r2_r1"])))


def opening(name: str, lesson: LessonRun) -> Seen:
    """The step as it opens."""
    return Seen(lesson, "", tuple(dial.start for dial in PICTURES[OF_STEP[name].picture].dials(lesson)))


def of_sample(name: str, setting: tuple[str, str] = ("augment", "spread"), value: float = 4.0) -> LessonRun:
    return lesson_of(read_case(paths.samples()[name]), with_value(CONFIG, setting, value), {})


def configured(lesson: LessonRun, path: tuple[str, ...], value: object) -> LessonRun:
    return LessonRun(lesson.inputs, with_value(lesson.config, path, value), 0, lesson.steps, lesson.sides)


def moved(name: str, lesson: LessonRun, way: str, *ranges: range) -> Seen:
    """The dials of a picture where they answer, found by moving them."""
    at: list[tuple[int, ...]] = [()]
    for each in ranges:
        at = [(*before, k) for before in at for k in each]
    return next(seen for seen in (Seen(lesson, way, each) for each in at) if done(name, seen))


def merged_turn(lesson: LessonRun) -> int:
    return place_of(fit_figure.TURN, degrees(wrap_angle(lesson.get(MergeResult).T_ref_mov.theta)))


def least_alike(lesson: LessonRun) -> int:
    match = lesson.get(HoughDetail).match
    return round(int(match.correlation.argmin()) * 180 / len(match.angles)) % 180


ANSWERS = {
    "laser": lambda s: Seen(s, "", (2,)),
    "laid-as-merged": lambda s: Seen(s, "laid", (merged_turn(s),)),
    "half-at-3-m": lambda s: Seen(s, "ring", (place_of(SPREAD, 2.5),)),
    "short-list": lambda s: Seen(of_sample("corridor_r2_r1")),
    "flat-wave": lambda s: moved("flat-wave", s, "wave", range(40, 121, 4), range(40, 121, 4)),
    "step-of-1-degree": lambda s: Seen(configured(s, ("spectra", "directions"), 180)),
    "least-alike": lambda s: Seen(s, "", (least_alike(s),)),
    "twin-of-first": lambda s: Seen(s, "", (1,)),
    "wide-shifts": lambda s: Seen(of_sample("office_r2_r1", ("window", "margin"), 0.8), "", (0,)),
    "across-the-ring": lambda s: Seen(s, "origins", (36,)),
    "gamma-is-fooled": lambda s: moved(
        "gamma-is-fooled", s, "fit", range(0, 81, 16), range(0, 81, 16), range(0, 361, 10)
    ),
    "no-better-dart": lambda s: Seen(s, "", (len(s.samples) - 1,)),
    "leader": lambda s: Seen(s, "", (0, int(s.few[0].values.argmax()))),
    "circle-open": lambda s: Seen(s, "", (0,)),
    "twin-wins": lambda s: Seen(of_sample("corridor_r3_r2", value=0.5)),
    "map-2-wins": lambda s: Seen(configured(s, ("conflict",), ConflictRule.MOV_WINS)),
    "too-little-wall": lambda s: Seen(s, "without", (0, 0)),
    "nothing-known": lambda s: Seen(s, "", (0,)),
    "other-answer": lambda s: moved("other-answer", s, "second", range(0, 481, 8), range(0, 481, 8)),
}


def test_every_step_asks_for_one_thing_and_nothing_is_asked_twice():
    assert all(step.check for step in STEPS)
    assert len(OF_STEP) == len(STEPS)
    assert set(OF_STEP) == set(CHECKS) == set(ANSWERS)


@pytest.mark.parametrize("name", CHECKS)
def test_what_is_asked_is_not_done_when_the_step_opens_nor_before_its_run(name, lesson):
    seen = opening(name, lesson)
    assert not done(name, seen)
    assert not done(name, Seen(LessonRun(MergeInputs(), None), seen.way, seen.at))


@pytest.mark.parametrize("name", CHECKS)
def test_to_take_a_picture_in_the_hand_is_no_answer_before_anything_is_dragged(name, lesson):
    ways = PICTURES[OF_STEP[name].picture].ways
    assert not any(done(name, Seen(lesson, way, drawn.places)) for way, drawn in ways.items() if drawn.dials)


@pytest.mark.parametrize("name", CHECKS)
def test_what_is_asked_is_done_once_it_was_done(name, lesson):
    assert done(name, ANSWERS[name](lesson))


def test_a_setting_answers_what_its_slider_in_the_picture_does(lesson):
    assert done("half-at-3-m", Seen(configured(lesson, ("augment", "spread"), 2.5)))
    assert not done("half-at-3-m", Seen(configured(lesson, ("augment", "spread"), 3.5)))


def test_added_contradiction_is_no_answer_where_wall_is_to_be_taken_away(lesson):
    assert not done("too-little-wall", Seen(lesson, "without", (0, 10)))
