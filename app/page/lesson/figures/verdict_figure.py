"""The lesson's pictures of the verdict: its bars, and the answers that it chose from."""

from __future__ import annotations

from collections.abc import Sequence

from algorithms.methods.merge_result import MergeResult
from algorithms.verdict.probability_model import probability
from algorithms.verdict.wall_evidence import Evidence
from app.drawing.palette import Palette
from app.drawing.svg.svg_canvas import WIDE, SvgCanvas
from app.drawing.svg.verdict_bars import bars
from app.model import status_text as words
from app.model import verdict_text
from app.page.lesson.lesson_run import LessonRun

ANSWER = 54.0  # height of an answer's row
MOST_ANSWERS = 5


def verdict(lesson: LessonRun, at: Sequence[int], palette: Palette) -> str:
    """What speaks for the merge and what against it, and from which probability on it is accepted."""
    least = f"accepted from {lesson.config.verdict.accept_from:.1%} on"
    return bars(lesson.get(MergeResult).verdict, palette, remark=least)


def evidence_says(found: Evidence) -> str:
    """What the walls of the whole maps say of an answer, patches slipped."""
    metres = f"{found.agreeing:.0f} m agree, {found.contradicting:.1f} m contradict"
    return f"{metres}; {found.floor:.0f} m² of floor in common"


def answers(lesson: LessonRun, at: Sequence[int], palette: Palette) -> str:
    """The best few answers: what agrees with each on the whole maps, and what contradicts it."""
    result = lesson.get(MergeResult)
    answers = result.weighed[:MOST_ANSWERS]
    most = max(each.evidence.shared_wall for each in answers) or 1.0
    sheet = SvgCanvas(30 + ANSWER * len(answers) + 22)
    sheet.text(0, 12, "place", 10.5, alpha=0.7)
    sheet.text(WIDE, 12, "how likely right, were there no other", 10.5, "end", alpha=0.7)
    for row, each in enumerate(answers):
        y, found = 30 + ANSWER * row, each.evidence
        name = "named" if row == 0 else words.apart(each.T_ref_mov, answers[0].T_ref_mov, result) + " away"
        sheet.text(0, y + 12, name, 12, bold=row == 0)
        sheet.text(WIDE, y + 12, f"by itself {verdict_text.likelihood(probability(each.score))}", 11, "end")
        wide = 0.0
        for metres, colour in ((found.agreeing, palette.agreed), (found.contradicting, palette.conflict)):
            sheet.rect(wide, y + 18, WIDE * metres / most, 11, colour)
            wide += WIDE * metres / most
        sheet.text(0, y + 42, evidence_says(found), 10.5, alpha=0.85)
    y = 30 + ANSWER * len(answers) + 8
    after = sheet.chip(0, y, palette.agreed, "wall that agrees")
    sheet.chip(after, y, palette.conflict, "wall that contradicts")
    return sheet.svg("The best few answers by the walls of the whole maps")
