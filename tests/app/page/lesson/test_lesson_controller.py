"""The lesson borrows the page's settings and dock, and puts both back."""

from __future__ import annotations

from unittest.mock import Mock

import pytest
from tabs import noting_tab

from algorithms.methods.registry import METHODS
from app.jobs.job_thread import JobThread
from app.model.settings import with_value
from app.page.lesson import lesson_controller
from app.page.lesson.lesson_controller import LessonController
from app.page.lesson.lesson_texts import lesson_folder
from app.page.modes import Mode
from app.page.run_controller import RunController
from app.page.undo.undo_controller import UndoController

TEXTS = {
    "01-first.md": "---\ntitle: One\ntry:\n  - {ask: Look., answer: There.}\n---\nFirst.",
    "02-second.md": (
        "---\ntitle: Two\ntry:\n"
        "  - {ask: Press., answer: It moved., button: Wider, set: {augment.spread: 9}}\n---\nSecond."
    ),
    "03-broken.md": "no front matter",
}


@pytest.fixture
def tab(inputs):
    return noting_tab(inputs)


@pytest.fixture
def lesson(tab, tmp_path, monkeypatch) -> LessonController:
    for name, text in TEXTS.items():
        (tmp_path / name).write_text(text, encoding="utf-8")
    return make(tab, tmp_path, monkeypatch)


def make(tab, folder, monkeypatch) -> LessonController:
    monkeypatch.setattr(lesson_controller, "JobThread", lambda *_: Mock(JobThread))
    runs = Mock(RunController, thread=Mock())

    def set_method(method, config, seed=None):
        tab.panels.show_method(method, config, tab.state.seed)
        tab.state.update(method=method, config=config)

    runs.set_method = set_method
    return LessonController(tab, Mock(UndoController), runs, folder)


def step(tab) -> tuple[int, str]:
    """Number and title of the step that is shown."""
    return tab.panels.lesson.text.call_args.args[:2]


def test_it_takes_a_method_with_a_proof_and_leaving_puts_the_persons_own_back(lesson, tab):
    own = METHODS["mse"].defaults
    tab.state.update(method="mse", config=own)
    lesson.enter()
    assert tab.state.config.proof.whole_circle
    tab.panels.charts.visible.assert_called_with(False)
    lesson.leave()
    assert (tab.state.method, tab.state.config) == ("mse", own)
    tab.panels.charts.visible.assert_called_with(True)
    lesson._undo.restore_current.assert_called_once_with()


def test_it_goes_from_step_to_step_and_no_further_and_comes_back_to_where_it_was_left(lesson, tab):
    lesson.enter()
    assert step(tab) == (0, "One")
    lesson.move(-1)
    assert step(tab) == (0, "One")
    lesson.move(1)
    assert step(tab) == (1, "Two")
    lesson.leave()
    lesson.enter()
    assert step(tab) == (1, "Two")
    lesson.go(99)
    assert step(tab) == (1, "Two")


def test_a_broken_text_is_named_and_the_others_are_shown(lesson, tab):
    lesson.enter()
    lesson.go(2)
    (index, name, what), _ = tab.panels.lesson.broken.call_args
    assert (index, name) == (2, "03-broken.md")
    assert "front matter" in what
    lesson.go(0)
    assert step(tab) == (0, "One")


def test_a_thing_to_try_sets_what_it_says_and_the_next_press_or_step_puts_it_back(lesson, tab):
    lesson.enter()
    before = tab.state.config
    lesson.go(1)
    for put_back in (lambda: lesson._try(0), lambda: lesson.move(-1)):
        lesson.go(1)
        lesson._try(0)
        assert tab.state.config == with_value(before, ("augment", "spread"), 9.0)
        put_back()
        assert tab.state.config == before


def test_another_mode_leaves_it(lesson, tab):
    lesson.enter()
    assert lesson.open
    tab.modes.enter(tab.modes.add(Mode(Mock())))
    assert not lesson.open
    tab.panels.lesson.visible.assert_called_with(False)


def test_without_texts_it_does_not_open_and_says_why(tab, tmp_path, monkeypatch):
    lesson = make(tab, tmp_path / "nowhere", monkeypatch)
    lesson.enter()
    assert not lesson.open
    assert "nowhere" in str(tab.notices.report.call_args)


def test_the_lesson_that_ships_opens_with_its_first_step(tab, monkeypatch):
    lesson = make(tab, lesson_folder(), monkeypatch)
    lesson.toggle()
    assert step(tab)[0] == 0
    assert len(tab.panels.lesson.contents.call_args.args[0]) == 16
    lesson.toggle()
    assert not lesson.open
