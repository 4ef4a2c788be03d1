"""Whether maps show what a step of the lesson is about; where not, the page offers a sample that does."""

from __future__ import annotations

from collections.abc import Callable
from math import hypot

from algorithms.maps.map_fusion import Fusion
from algorithms.methods.merge_result import MergeResult
from algorithms.methods.steps import HoughDetail, WindowDetail
from app.page.lesson.figures.verdict_figure import verdict_without
from app.page.lesson.lesson_run import LessonRun


def _several_turns(lesson: LessonRun) -> bool:
    """More peaks than the highest are followed up, twins left out."""
    return sum(not twin for twin in lesson.get(HoughDetail).match.twins) > 1


def _wide_ring(lesson: LessonRun) -> bool:
    """Map 2's origin is far from x̂₂, against what the sighting leaves open: else the ring is no ring."""
    coupled = lesson.get(WindowDetail).coupled
    return hypot(*coupled.pivot.tolist()) > 2 * coupled.disc


def _several_answers(lesson: LessonRun) -> bool:
    return len(lesson.get(MergeResult).weighed) > 1


def _contradictions(lesson: LessonRun) -> bool:
    return lesson.get(Fusion).conflicting > 0


def _verdict_turns(lesson: LessonRun) -> bool:
    """The merge is accepted, and would not be without agreeing wall."""
    return lesson.get(MergeResult).verdict.accepted and not verdict_without(lesson, (0, 0)).accepted


EFFECTS: dict[str, tuple[tuple[type, ...], Callable[[LessonRun], bool]]] = {
    "several-turns": ((HoughDetail,), _several_turns),
    "wide-ring": ((WindowDetail,), _wide_ring),
    "several-answers": ((MergeResult,), _several_answers),
    "contradictions": ((Fusion,), _contradictions),
    "verdict-turns": ((MergeResult,), _verdict_turns),
}
"""By their names in the front matter of a step: what the run must have come to, and the test."""


def missing(name: str, lesson: LessonRun) -> bool:
    """Whether maps do not show it; not told before the run has come to it."""
    needs, there = EFFECTS[name]
    return lesson.possible and lesson.reached(*needs) and not there(lesson)
