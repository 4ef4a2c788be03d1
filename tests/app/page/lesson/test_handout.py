"""The handout holds every step as the page shows it, and needs nothing but itself."""

from __future__ import annotations

import re
from dataclasses import replace
from html import escape

import pytest

from app.drawing.palette import LIGHT
from app.page.lesson import equations
from app.page.lesson.figures.figure_registry import PICTURES
from app.page.lesson.handout import handout_page, numbered_steps
from app.page.lesson.lesson_run import LessonRun
from app.page.lesson.lesson_texts import files, lesson_folder
from app.page.lesson.whole_lesson import whole_lesson

STEPS = numbered_steps(files(lesson_folder()))


@pytest.fixture(scope="module")
def lesson(inputs) -> LessonRun:
    return whole_lesson(inputs)


@pytest.fixture(scope="module")
def page(lesson) -> str:
    return handout_page(lesson, STEPS).decode()


def test_every_step_is_there_with_its_equations_picture_and_what_to_try(page):
    sections = re.findall(r'<section id="step(\d+)">(.+?)</section>', page, flags=re.S)
    assert [int(number) for number, _ in sections] == list(STEPS)
    for (number, html), step in zip(sections, STEPS.values(), strict=True):
        assert escape(step.title) in html
        assert html.count("<svg") >= step.parts + sum(len(step.formulas(k)) for k in range(step.parts))
        for k in range(step.parts):
            assert all(f'data-equation="{name}"' in html for name in step.formulas(k))
        assert html.count('class="try"') == len(step.trials)
        assert html.count("Check yourself") == 1
        for k in range(1, len(step.trials) + 1):
            assert page.count(f"<b>{number}.{k}</b>") == 2  # what to try, and its answer


def test_its_pictures_are_those_of_the_page(page, lesson):
    for name in ("hough", "window", "verdict", "chain"):
        start = tuple(dial.start for dial in PICTURES[name].dials(lesson))
        assert PICTURES[name].draw(lesson, start, LIGHT) in page


def test_all_numbers_are_filled_in_and_all_symbols_told(page):
    words = re.sub(r"<(style|svg)\b.+?</\1>", "", page, flags=re.S)
    assert not re.findall(r"\{[a-z_0-9]+\}|\*\*", words)
    assert words.count("<dt>") == len(equations.symbols())
    assert not set(re.findall(r"\w+[_^]\w+", re.sub(r"<[^>]*>|\w+_r\d_r\d|\w+_fleet_\w+|flat_1", " ", words)))


def test_it_fetches_nothing_and_runs_nothing(page):
    assert not re.findall(r"<script|<link|src=|url\(", page)
    assert set(re.findall(r'href="(.{5})', page)) <= {"#step", "data:"}


def test_markup_in_a_text_and_in_a_name_stays_words(lesson):
    step = replace(STEPS[3], title="<b>x", body="Words <script>alert(1)</script> *so*.", picture="")
    named = LessonRun(replace(lesson.inputs, name="<i>maps"), lesson.config, 0, lesson.steps, lesson.sides)
    page = handout_page(named, {1: step}).decode()
    assert "<script" not in page
    assert "<i>maps" not in page
    assert "<b>x" not in page
    assert "<em>so</em>" in page
