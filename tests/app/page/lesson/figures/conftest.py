"""Runs of the lesson that its pictures are drawn from."""

from __future__ import annotations

import pytest
from looks import lesson_of

from app.page.lesson.lesson_run import LessonRun


@pytest.fixture(scope="session")
def lesson(small_case) -> LessonRun:
    return lesson_of(small_case)


@pytest.fixture(scope="session")
def refused(strangers) -> LessonRun:
    """Maps of two buildings: nothing fits, and every picture has to stand that."""
    return lesson_of(strangers)
