"""The lesson borrows the page's settings and dock, and puts both back."""

from __future__ import annotations

from dataclasses import replace
from unittest.mock import Mock

import pytest
from looks import look_at
from tabs import noting_tab

from algorithms.common.errors import NoAnswerError
from algorithms.methods.merge_result import MergeResult
from algorithms.methods.registry import METHODS
from algorithms.methods.steps import Step
from app.jobs.job_thread import JobThread
from app.model.merge_job import MergeJob
from app.model.run_state import RunState
from app.model.settings import with_value
from app.page.lesson import lesson_work
from app.page.lesson.lesson_controller import NOT_YET, STILL, LessonController
from app.page.lesson.lesson_texts import lesson_folder
from app.page.lesson.sighting_look import STAND_IN
from app.page.modes import Mode
from app.page.run_controller import RunController
from app.page.undo.undo_controller import UndoController

COMPARES = "---\ntitle: Two\npicture: knowledge\n---\nSecond."
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
    monkeypatch.setattr(lesson_work, "JobThread", lambda *_: Mock(JobThread))
    runs = Mock(RunController, thread=Mock())

    def set_method(method, config, seed=None):
        tab.panels.show_method(method, config, tab.state.seed)
        tab.state.update(method=method, config=config)

    runs.set_method = set_method
    return LessonController(tab, Mock(UndoController), runs, folder)


def entered(tab, folder, monkeypatch, other_texts) -> LessonController:
    """A lesson that is open, some of its texts in place of the usual ones."""
    for name, text in {**TEXTS, **other_texts}.items():
        (folder / name).write_text(text, encoding="utf-8")
    lesson = make(tab, folder, monkeypatch)
    lesson.enter()
    return lesson


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


def test_it_opens_at_the_step_of_a_number_or_at_the_nearest(lesson, tab):
    for number, index in ((2, 1), (-7, 0), (10**6, 2)):
        lesson.open_at(number)
        assert lesson.open
        assert lesson._index == index


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


@pytest.fixture
def comparing(tab, tmp_path, monkeypatch, result) -> LessonController:
    """A lesson at a step that compares merges, its own run over."""
    lesson = entered(tab, tmp_path, monkeypatch, {"02-second.md": COMPARES})
    lesson.go(1)
    own_run_ends(lesson, result)
    return lesson


def own_run_ends(lesson: LessonController, result: MergeResult) -> None:
    lesson._work._steps = [Step("verdict", result, 0.0)]
    lesson._work.ended(lesson._state.job(), RunState())


def asked(lesson: LessonController) -> MergeJob:
    """What the thread was asked for last."""
    return lesson._work._thread.request.call_args.args[0]


def ended(lesson: LessonController, result: MergeResult) -> None:
    """What it was asked for last has come to its end."""
    job, story = asked(lesson), RunState()
    lesson._work.begun(job)
    story.add(Step("verdict", result, 0.0))
    lesson._work.ended(job, story)


def test_a_step_that_compares_begins_one_merge_after_another_once_the_lessons_own_is_over(comparing, result):
    compared = [asked(comparing)]
    for _ in range(2):
        ended(comparing, result)
        compared.append(asked(comparing))
    assert [len(job.known) for job in compared] == [0, 1, 1]
    assert compared[-1].known == comparing._state.inputs.observations
    before = comparing._work._thread.request.call_count
    ended(comparing, result)
    assert comparing._work._thread.request.call_count == before  # all are over
    comparing.go(0)
    comparing.go(1)
    assert comparing._work._thread.request.call_count == before  # and stay so


def test_leaving_the_step_stops_the_merge_at_work_and_coming_back_begins_that_one_anew(comparing, result):
    ended(comparing, result)
    at_work = asked(comparing)
    comparing._work.begun(at_work)
    stops = comparing._work._thread.stop.call_count
    comparing.move(-1)
    assert comparing._work._thread.stop.call_count > stops
    comparing._work.stopped(at_work, RunState())
    assert comparing._work.lesson.compared(at_work).run is None
    requests = comparing._work._thread.request.call_count
    comparing.move(1)
    assert asked(comparing) is at_work
    assert comparing._work._thread.request.call_count == requests + 1


def test_a_merge_without_an_answer_is_told_in_its_place_and_the_next_one_begins(comparing):
    first = asked(comparing)
    comparing._work.failed(first, RunState(), NoAnswerError("no walls coincide"))
    assert asked(comparing) is not first
    assert comparing._work.lesson.compared(first).over
    assert "no answer" in comparing._panel.picture.call_args.args[0]


def test_what_was_compared_stays_while_settings_move_and_not_on_other_maps(comparing, tab, result):
    ended(comparing, result)
    comparing._settings_changed()
    own_run_ends(comparing, result)
    assert len(asked(comparing).known) == 1  # the first is over still
    tab.state.update(inputs=replace(tab.state.inputs))
    comparing._settings_changed()
    own_run_ends(comparing, result)
    assert asked(comparing).known == ()


LOOKS = (
    "---\ntitle: Zero\npicture: sighting\nequations: [[line], [votes]]\ntry:\n"
    "  - {ask: Press., answer: So., button: Mean, show: mean}\n---\nBy {box_chance}.\n\n***\n\nMore."
)


@pytest.fixture
def looking(tab, tmp_path, monkeypatch) -> LessonController:
    """A lesson that begins with a look at a picture."""
    for name, text in {"00-zero.md": LOOKS, **TEXTS}.items():
        (tmp_path / name).write_text(text, encoding="utf-8")
    return make(tab, tmp_path, monkeypatch)


def looked_at(lesson: LessonController) -> None:
    """The look that was asked for last is over."""
    job, story = asked(lesson), RunState()
    lesson._work.begun(job)
    story.add(Step("observe", look_at(STAND_IN), 0.0))
    lesson._work.ended(job, story)


def test_a_look_comes_before_the_lessons_own_run_and_the_run_follows_it(looking, tab, result):
    looking.enter()
    assert looking._work.lesson.compared(asked(looking))
    assert "step 0 of 3" in tab.display.messages.hud.call_args.kwargs["state"]
    assert "…" in tab.panels.lesson.beside.call_args.args[0]
    looked_at(looking)
    assert looking._work.lesson.compared(asked(looking)) is None  # the lesson's own
    assert asked(looking).steps is None
    assert "…" not in tab.panels.lesson.beside.call_args.args[0]  # its numbers are in the text
    own_run_ends(looking, result)
    requests = looking._work._thread.request.call_count
    looking.move(1)
    looking.move(-1)
    assert looking._work._thread.request.call_count == requests  # both are over


def test_a_look_that_is_left_before_it_is_over_still_lets_the_run_begin(looking):
    looking.enter()
    look = asked(looking)
    looking._work.begun(look)
    looking.move(1)
    looking._work.failed(look, RunState(), NoAnswerError("no picture"))
    assert asked(looking).steps is None
    assert looking._work.lesson.compared(look).failed == "Refused: no picture."


def test_a_thing_to_try_may_draw_the_picture_in_another_way_and_leaves_the_settings(looking, tab):
    looking.enter()
    looked_at(looking)
    before, requests = tab.state.config, looking._work._thread.request.call_count
    for put_back in (lambda: looking._try(0), lambda: looking.move(1)):
        looking.go(0)
        assert tab.panels.lesson.beside.call_args.args[1] == ("line",)
        looking._try(0)
        assert "too near by" in tab.panels.lesson.picture.call_args.args[0]
        assert tab.panels.lesson.dials.call_args.args[1] == (2,)
        assert tab.panels.lesson.beside.call_args.args[1] == ("votes",)
        put_back()
        assert looking._display.way == ""
    assert tab.state.config is before
    assert looking._work._thread.request.call_count == requests


def test_the_lesson_that_ships_opens_with_its_first_step(tab, monkeypatch):
    lesson = make(tab, lesson_folder(), monkeypatch)
    lesson.toggle()
    assert step(tab)[0] == 0
    titles, first, _ = tab.panels.lesson.contents.call_args.args
    assert (len(titles), first) == (19, 0)
    assert "step 0 of 18" in tab.display.messages.hud.call_args.kwargs["state"]
    lesson.toggle()
    assert not lesson.open


ASKS = (
    "---\ntitle: Laser\npicture: sighting\ncheck: {ask: Go there., test: laser}\n"
    "effect: {test: contradictions, missing: None here., sample: office_r2_r1}\n---\nText."
)


@pytest.fixture
def asking(tab, tmp_path, monkeypatch, result) -> LessonController:
    """A lesson whose first step asks for something, its own run over."""
    return entered(tab, tmp_path, monkeypatch, {"01-first.md": ASKS})


def question(tab) -> tuple[str, bool, str]:
    return tab.panels.lesson.check.call_args.args


def test_what_a_step_asks_for_is_ticked_once_it_was_done_and_stays_so(asking, tab, result):
    own_run_ends(asking, result)
    asking._check()
    assert question(tab) == ("Go there.", False, NOT_YET)
    tab.panels.lesson.places = (2,)
    asking._slide()
    asking._check()
    assert question(tab) == ("Go there.", True, "")
    assert tab.panels.lesson.contents.call_args.args[2] == {1}
    asking.move(1)
    assert question(tab)[:2] == ("", False)
    asking.move(-1)
    assert question(tab) == ("Go there.", True, "")


def test_a_question_on_a_run_that_has_not_come_to_it_waits_for_it(tab, tmp_path, monkeypatch, result):
    (tmp_path / "01-first.md").write_text(ASKS.replace("laser", "map-2-wins"), encoding="utf-8")
    lesson = make(tab, tmp_path, monkeypatch)
    lesson.enter()
    lesson._check()
    assert question(tab) == ("Go there.", False, STILL)
    own_run_ends(lesson, result)
    assert question(tab) == ("Go there.", False, "")
    lesson._check()
    assert question(tab) == ("Go there.", False, NOT_YET)


def test_a_tab_that_comes_back_tells_what_was_done_and_what_is_no_step_is_left_out(asking, tab):
    asking._was_done([1.0, 77.0])
    assert question(tab)[1]
    assert tab.panels.lesson.contents.call_args.args[2] == {1}


def test_the_sample_that_is_offered_is_opened(asking):
    asking._take_sample = Mock()
    asking._to_sample()
    asking._take_sample.assert_called_once_with("office_r2_r1")
