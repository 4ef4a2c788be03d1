"""The lesson's pictures of one sighting: the image, what the detector sees in it, the laser, and both."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial

from app.drawing.palette import Palette
from app.drawing.svg.svg_canvas import WIDE, SvgCanvas
from app.page.lesson.figures.camera_figure import TOP, what, which_way
from app.page.lesson.figures.laser_figure import both, how_far
from app.page.lesson.lesson_run import LessonRun
from app.page.lesson.side_runs import SideRuns
from app.page.lesson.sighting_look import SIGHTING, SightingLook, sighting_runs

WHICH_WAY, WHAT, HOW_FAR, BOTH = range(4)
PARTS = 4
TITLES = (
    "1 of 4: which way? The camera",
    "2 of 4: what is it? The detector",
    "3 of 4: how far? The laser",
    "4 of 4: why the two together",
)


def sighting(lesson: LessonRun, at: Sequence[int], palette: Palette) -> str:
    """One of the four parts."""
    return _sheet(lesson, at, palette, which_way, what, how_far, both)


def counted(lesson: LessonRun, at: Sequence[int], palette: Palette) -> str:
    """The same with bearings counted in pixels."""
    return _sheet(lesson, at, palette, partial(which_way, by_counting=True), what, how_far, both)


def mean_taken(lesson: LessonRun, at: Sequence[int], palette: Palette) -> str:
    """The same with the mean of the points taken for the robot's centre."""
    return _sheet(lesson, at, palette, which_way, what, partial(how_far, mean=True), both)


def runs_of(lesson: LessonRun) -> SideRuns:
    """The look, not begun where the lesson has not come to it."""
    return lesson.sides.get(SIGHTING) or sighting_runs(lesson.inputs, lesson.config)


Part = Callable[[SightingLook, Palette], SvgCanvas]


def _sheet(lesson: LessonRun, at: Sequence[int], palette: Palette, *parts: Part) -> str:
    number, look = (min(at[0], PARTS - 1) if at else 0), lesson.look
    if look is None:
        sheet, failed = SvgCanvas(TOP + 60), runs_of(lesson).each[0].failed
        sheet.rect(0, TOP, WIDE, 60, palette.unknown)
        words = failed or "the detector looks at the picture …"
        sheet.text(WIDE / 2, TOP + 34, words, 11, "middle", palette.text)
    elif look.calibrated.one is None:
        sheet = SvgCanvas(TOP + 300)
        sheet.photo(look.photo, 0, TOP, WIDE, 285)
        sheet.text(0, TOP + 297, look.calibrated.seen.reason, 10.5)
    else:
        sheet = parts[number](look, palette)
        sheet.text(WIDE, 11, look.name, 10.5, "end", alpha=0.7)
    sheet.text(0, 11, TITLES[number], 11, bold=True)
    return sheet.svg(TITLES[number])
