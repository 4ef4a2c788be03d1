"""A step of the lesson is drawn as far as the run has come, and says what it waits for."""

from __future__ import annotations

import re
from dataclasses import replace
from unittest.mock import MagicMock, Mock

import pytest
from looks import lesson_of

from algorithms.common.robot_names import RobotNames
from algorithms.methods.registry import METHODS, run
from algorithms.methods.steps import HoughDetail, Step
from app.drawing.browser_messages import BrowserMessages
from app.drawing.scene_layout import lay_out
from app.model.merge_inputs import MergeInputs
from app.page.lesson.figures.figure_registry import PICTURES
from app.page.lesson.lesson_display import NO_MAPS, NOT_HERE, WAIT, LessonDisplay
from app.page.lesson.lesson_panel import LessonPanel
from app.page.lesson.lesson_run import LessonRun
from app.page.lesson.lesson_texts import Exercise, StepText, files, lesson_folder, read_step
from app.page.lesson.placeholders import NUMBERS
from app.page.page_display import PageDisplay
from app.page.page_state import PageState

CONFIG = METHODS["spectra-proven"].defaults


@pytest.fixture(scope="module")
def hough() -> StepText:
    """A step whose picture is of the spectra."""
    steps = [read_step(path, PICTURES, NUMBERS) for path in files(lesson_folder())]
    return next(step for step in steps if step.picture == "hough")


@pytest.fixture(scope="module")
def until_hough(inputs) -> tuple[Step, ...]:
    """A run that has come to the spectra and no farther."""
    told = []
    for step in run("spectra-proven", inputs.ref, inputs.mov, inputs.observations, CONFIG):
        told.append(step)
        if isinstance(step.detail, HoughDetail):
            break
    return tuple(told)


@pytest.fixture
def panel() -> Mock:
    return Mock(LessonPanel)


@pytest.fixture
def messages() -> Mock:
    return Mock(BrowserMessages)


@pytest.fixture
def display(inputs, panel, messages) -> LessonDisplay:
    page = MagicMock(PageDisplay, messages=messages)
    page.views = Mock()
    page.views.map.layout = lay_out(inputs.ref, inputs.mov, inputs.at)
    return LessonDisplay(PageState(), page, panel)


def drawn(display: LessonDisplay, panel: Mock, text: StepText, lesson: LessonRun, done: bool = False) -> str:
    display.on_map(display.picture(text, lesson, done), "Lesson", look=True)
    return panel.picture.call_args.args[0]


def test_what_the_run_has_not_come_to_is_waited_for_and_once_it_is_over_no_more(
    display, messages, panel, hough, inputs
):
    lesson = LessonRun(inputs, CONFIG)
    assert drawn(display, panel, hough, lesson) == WAIT
    assert messages.hud.call_args.kwargs["mood"] == "running"
    assert drawn(display, panel, hough, lesson, done=True) == NOT_HERE
    assert messages.hud.call_args.kwargs["mood"] == "idle"


def test_without_maps_or_with_a_method_of_other_stages_nothing_is_waited_for(display, panel, hough, inputs):
    assert drawn(display, panel, hough, LessonRun(MergeInputs(), CONFIG)) == NO_MAPS
    assert drawn(display, panel, hough, LessonRun(inputs, METHODS["mse"].defaults)) == NOT_HERE
    unseen = LessonRun(inputs.knowing(inputs.pool, "nothing"), CONFIG)  # the sighting is put aside
    assert drawn(display, panel, hough, unseen) == NO_MAPS


def test_a_picture_is_drawn_once_its_stage_is_there_with_its_dials_where_they_begin(
    display, panel, hough, inputs, until_hough
):
    lesson = LessonRun(inputs, CONFIG, 0, until_hough)
    assert drawn(display, panel, hough, lesson).startswith("<svg")
    dials, places = panel.dials.call_args.args
    assert places == tuple(dial.start for dial in dials)
    display.places = tuple(10**6 for _ in dials)  # of maps that had more to show
    drawn(display, panel, hough, lesson)
    assert panel.dials.call_args.args[1] == tuple(dial.count - 1 for dial in dials)


def test_what_stands_beside_a_picture_in_parts_is_that_of_the_part_its_dial_shows(
    display, panel, inputs, until_hough
):
    text = StepText("", "Title", "sighting", (("line",), ("votes",)), (), "A {range}.\n***\nB.\n***\nC.")
    lesson = LessonRun(inputs, CONFIG, 0, until_hough)
    for place, words, formulas in (
        (0, "A 3", "line"),
        (1, "B", "votes"),
        (2, "C", "votes"),
        (3, "C", "votes"),
    ):
        display.places = (place,)
        drawn(display, panel, text, lesson)
        said, beside = panel.beside.call_args.args
        assert said.strip().startswith(words[:1])
        assert "{" not in said
        assert beside == (formulas,)
    drawn(display, panel, text, LessonRun(MergeInputs(), CONFIG))
    assert panel.beside.call_args.args == ("A ….\n", ("line",))


def test_another_way_to_draw_a_picture_may_have_a_dial_of_its_own_or_none(display, panel, small_case):
    lesson = lesson_of(small_case, sides={})
    for picture, way, labels in (("window", "origins", ["off the best turn (°)"]), ("proof", "lattice", [])):
        display.draw_as(picture, way)
        drawn(display, panel, StepText("", "Title", picture, (), (), "Words."), lesson)
        dials, places = panel.dials.call_args.args
        assert [dial.label for dial in dials] == labels
        assert places == tuple(0 for _ in labels)


def test_an_answer_is_told_only_where_it_was_asked_for(display, panel, hough, inputs, until_hough):
    trial = Exercise("Why?", "so it is")
    text = replace(hough, trials=(trial, trial))
    display.words(0, text, LessonRun(inputs, CONFIG, 0, until_hough), {1})
    assert panel.trials.call_args.args[1] == ["", "so it is"]


def test_robots_that_have_names_are_told_by_them_in_words_pictures_and_things_to_try(
    display, panel, inputs, until_hough
):
    named = replace(inputs, names=RobotNames("Bob <1>", "Alice"))
    lesson = LessonRun(named, CONFIG, steps=list(until_hough))
    for path in files(lesson_folder()):
        text = read_step(path, PICTURES, NUMBERS)
        display.words(0, text, lesson, range(len(text.trials)))
        display.picture(text, lesson, done=False)
        title, trials = panel.text.call_args.args[1], panel.trials.call_args.args
        shown = [title, *(trial.ask for trial in trials[0]), *trials[1]]
        shown += [panel.beside.call_args.args[0], panel.picture.call_args.args[0]]
        of_numbers = re.compile(r"[^<>]{,40}\b(?:[Rr]obot|[Mm]ap) [12]\b(?!,\d)")
        assert [found for words in shown for found in of_numbers.findall(words)] == []
    assert "Bob &#60;1&#62;" in panel.picture.call_args_list[2].args[0]
