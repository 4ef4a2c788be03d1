"""A link opens a place of the lesson, and is shown as a code that phones read."""

from __future__ import annotations

from dataclasses import replace
from unittest.mock import Mock

import pytest
from tabs import event, noting_tab

from app.page.lesson.lesson_controller import LessonController
from app.page.lesson.link_controller import LinkController


@pytest.fixture
def tab(inputs):
    return noting_tab(inputs)


@pytest.fixture
def lesson() -> Mock:
    return Mock(LessonController)


@pytest.fixture
def taken(tab, lesson) -> list[str]:
    """Names of the samples that are taken."""
    names: list[str] = []
    LinkController(tab, lesson, names.append)
    return names


def test_a_link_takes_its_sample_and_opens_its_step(tab, lesson, taken):
    event(tab, "place")(lesson=9, sample="corridor_r3_r2")
    assert taken == ["corridor_r3_r2"]
    lesson.open_at.assert_called_once_with(9)


def test_a_link_without_a_sample_or_with_the_one_at_hand_leaves_the_maps(tab, lesson, taken):
    tab.state.update(inputs=replace(tab.state.inputs, name="office_r2_r1"))
    for sample in ("", "office_r2_r1"):
        event(tab, "place")(lesson=3, sample=sample)
    assert taken == []
    assert lesson.open_at.call_count == 2


def test_a_link_to_a_sample_that_is_not_here_says_so_and_opens_nothing(tab, lesson, taken):
    event(tab, "place")(lesson=3, sample="palace_r2_r1")
    assert "palace_r2_r1" in str(tab.notices.report.call_args)
    assert taken == []
    lesson.open_at.assert_not_called()


def test_an_address_is_shown_as_a_code_and_what_is_none_is_not(tab, taken):
    show, told = event(tab, "link"), tab.display.messages.link
    show(address="javascript:alert(1)")
    told.assert_not_called()
    show(address="http://lab:8080/#lesson=9&sample=corridor_r3_r2")
    address, code = told.call_args.args
    assert address.endswith("corridor_r3_r2")
    assert code.startswith("<svg")
