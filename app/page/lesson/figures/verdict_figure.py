"""The lesson's pictures of the verdict: its bars, and the answers that it chose from."""

from __future__ import annotations

from collections.abc import Sequence

from algorithms.methods.merge_result import MergeResult
from algorithms.verdict.decision import Verdict
from algorithms.verdict.probability_model import probability
from algorithms.verdict.wall_evidence import Evidence
from app.drawing.palette import Palette
from app.drawing.svg.svg_canvas import WIDE, SvgCanvas
from app.drawing.svg.svg_grip import grip
from app.drawing.svg.verdict_bars import bars, draw_bars, height_of
from app.model import status_text as words
from app.model import verdict_text
from app.page.lesson.figures.figure_slider import FigureSlider, shown
from app.page.lesson.lesson_run import LessonRun
from app.page.panels.what_if_panel import supposed

LEFT = FigureSlider("agreeing wall that is left (%)", 101, 100, 0)
ADDED = FigureSlider("wall that contradicts, added (m)", 81, 0, 0, 0.25)
ANSWER = 54.0  # height of an answer's row
MOST_ANSWERS = 5


def verdict(lesson: LessonRun, at: Sequence[int], palette: Palette) -> str:
    """What speaks for the merge and what against it, and from which probability on it is accepted."""
    least = f"accepted from {lesson.config.verdict.accept_from:.1%} on"
    return bars(lesson.get(MergeResult).verdict, palette, remark=least)


def without(lesson: LessonRun, at: Sequence[int], palette: Palette) -> str:
    """The same with agreeing wall taken away and contradicting wall added, by hand."""
    result = lesson.get(MergeResult)
    verdict = verdict_without(lesson, at)
    top = height_of(verdict)
    sheet = SvgCanvas(top + 84)
    draw_bars(sheet, verdict, palette, remark=f"accepted from {lesson.config.verdict.accept_from:.1%} on")
    left, added, found = shown(LEFT, at[0]), shown(ADDED, at[1]), result.weighed[0].evidence
    wide = WIDE - 16
    rows = (
        (
            f"wall that agrees: {found.rigid_agreeing * left / 100:.0f} m, {left:g} %",
            left / 100,
            palette.agreed,
        ),
        (f"more wall that contradicts: {added:g} m", added / shown(ADDED, ADDED.count - 1), palette.conflict),
    )
    for row, (title, share, colour) in enumerate(rows):
        y = top + 18 + 40 * row
        sheet.text(0, y - 5, title, 11, bold=True)
        sheet.rect(0, y, wide, 14, palette.margin, alpha=0.18)
        sheet.rect(0, y, wide * share, 14, colour)
        most = 100 if row == 0 else shown(ADDED, ADDED.count - 1)
        grip(sheet, wide * share, y + 7, palette.particle, x=(row, 0, 0, wide, most))
    return sheet.svg("The verdict with a part of the evidence")


def verdict_without(lesson: LessonRun, at: Sequence[int]) -> Verdict:
    """The verdict where only a share of the agreeing wall is left, and more contradicts."""
    result = lesson.get(MergeResult)
    share, added, found = shown(LEFT, at[0]) / 100, shown(ADDED, at[1]), result.weighed[0].evidence
    changed = {name: share * getattr(found, name) for name in ("rigid_agreeing", "across", "floor")}
    changed |= {name: added + getattr(found, name) for name in ("rigid_contradicting", "contradicting")}
    return supposed(result, lesson.config.verdict, changed)


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
