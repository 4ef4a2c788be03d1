"""The lesson's picture of what a sighting buys: the pair merged with less and more known, side by side."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from algorithms.common.pose import Pose2
from algorithms.methods.merge_result import MergeResult
from algorithms.methods.steps import PlaneDetail
from app.drawing.draw_items import ellipse
from app.drawing.palette import Palette
from app.drawing.scene_layout import known_hull, rect_of, union
from app.drawing.svg.map_plot import RasterView, around, draw_map, scale_bar, scene
from app.drawing.svg.svg_canvas import INK, SvgCanvas, SvgPlot
from app.drawing.svg.thumbnail import laid_over
from app.model.run_state import RunState
from app.model.verdict_text import likelihood
from app.page.lesson.lesson_run import LessonRun
from app.page.lesson.side_runs import SideRun, SideRuns, knowledge_runs

NAME = "knowledge"
SIDE, APART, TOP = 120.0, 130.0, 18.0
ROW = 29.0  # height of a row of numbers
ROWS = (
    "shifts that are left, averaged over the turns",
    "transforms on the raster, N",
    "best places, which are climbed (100 at most)",
    "different answers held against the whole maps",
    "time of the merge",
    "how likely right, and the verdict",
)


def knowledge(lesson: LessonRun, at: Sequence[int], palette: Palette) -> str:
    """The merges as far as they have come: where map 2 lies, the best places, and the numbers of each."""
    runs = runs_of(lesson)
    numbers = TOP + SIDE + 16
    sheet = SvgCanvas(numbers + ROW * len(ROWS) + 22)
    view = _view(lesson)
    for k, one in enumerate(runs.each):
        _panel(sheet, APART * k, view, lesson, one, palette)
        for row, words in enumerate(_numbers(one)):
            bold = row == len(ROWS) - 1
            sheet.text(APART * k, numbers + ROW * row + 13, words, 11, bold=bold)
    for row, label in enumerate(ROWS):
        sheet.text(0, numbers + ROW * row, label, 10, alpha=0.75)
    y = numbers + ROW * len(ROWS) + 8
    after = sheet.chip(0, y, palette.particle, "x̂₂ at the best places", "dot")
    after = sheet.chip(after, y, palette.best, "at the answer", "dot")
    sheet.chip(after, y, palette.margin, "what is known of it", "line")
    return sheet.svg(
        "The pair merged with nothing known, with the place known roughly, and with the sighting"
    )


def shown_on_map(lesson: LessonRun, at: Sequence[int]) -> RunState:
    """The merge at work; once all are over the chosen one; before them the lesson's own."""
    runs = runs_of(lesson)
    one = runs.at_work or runs.each[min(at[0], len(runs.each) - 1) if at else -1]
    own = lesson.run_until(MergeResult)
    return one.run if one.run is not None and one.run.last is not None else own


def runs_of(lesson: LessonRun) -> SideRuns:
    """The merges, none of them begun where the lesson has not come to them."""
    return lesson.sides.get(NAME) or knowledge_runs(lesson.inputs, lesson.seed)


def _view(lesson: LessonRun) -> RasterView:
    """Both maps as the lesson's own run has laid them, in the middle of a square."""
    i, T = lesson.inputs, lesson.get(MergeResult).T_ref_mov
    x0, y0, x1, y1 = union(rect_of(known_hull(i.ref)), rect_of(T.apply(known_hull(i.mov))))
    half = 0.53 * max(x1 - x0, y1 - y0, 1.0)
    return RasterView(around(np.array([x0 + x1, y0 + y1]) / 2, half), int(2 * SIDE), int(2 * SIDE))


def _panel(
    sheet: SvgCanvas, x: float, view: RasterView, lesson: LessonRun, one: SideRun, palette: Palette
) -> None:
    """Map 2 at the answer, or at the best place so far, and where all the best places put x̂₂."""
    i, plane = lesson.inputs, one.run.get(PlaneDetail) if one.run else None
    poses = np.zeros((0, 3)) if plane is None else plane.poses
    T = one.result.T_ref_mov if one.result else Pose2.from_array(poses[0]) if len(poses) else None
    if T is None:
        pixels = draw_map(view, palette, i.ref, palette.ref)
    else:
        pixels = laid_over(view, i.ref, i.mov, T, palette)
    sheet.text(x, 11, one.title, 11, bold=True)
    plot = scene(sheet, x, TOP, SIDE, SIDE, view)
    plot.image(pixels)
    x_hat = i.encounters[0].x_mov
    for pose in poses[::-1]:
        _dot(plot, Pose2.from_array(pose), x_hat, 2.2, palette.particle, "#fff")
    if one.place is not None and one.covariance is not None:
        ring = plot.at(ellipse(one.place, one.covariance, one.job.config.window.deviations))
        sheet.path(ring, palette.margin, 1.4, close=True)
    if T is not None:
        _dot(plot, T, x_hat, 4.0, palette.best, "#fff")
    sheet.rect(x, TOP, SIDE, SIDE, None, INK, 0.35)
    scale_bar(plot)
    waits = "no answer" if one.failed else "" if one.over else _progress(plane)
    if waits:
        middle = x + SIDE / 2
        sheet.text(middle, TOP + 16, waits, 11, "middle", palette.text, True, halo=palette.free)


def _dot(plot: SvgPlot, T: Pose2, point: np.ndarray, r: float, colour: object, rim: str) -> None:
    px, py = plot.one(*T.apply(point).tolist())
    if plot.x <= px <= plot.x + plot.wide and plot.y <= py <= plot.y + plot.high:
        plot.sheet.dot(px, py, r, colour, rim, width=0.8)


def _progress(plane: PlaneDetail | None) -> str:
    if plane is None:
        return "waits …"
    return f"{plane.done} of {plane.total} turns" if plane.done < plane.total else "climbs …"


def _rounded(value: float) -> str:
    """Three digits and no exponent."""
    return f"{float(f'{value:.3g}'):,.10g}"


def _numbers(one: SideRun) -> tuple[str, ...]:
    """A text per row; an ellipsis where it is not known yet."""
    plane, result = one.run.get(PlaneDetail) if one.run else None, one.result
    told = ["…"] * len(ROWS)
    if plane is not None and plane.done == plane.total:
        count = plane.searched / plane.cell**2 * plane.total
        told[:3] = f"{_rounded(plane.searched)} m²", _rounded(count), f"{len(plane.poses)}"
    if result is not None:
        told[3] = f"{len(result.weighed)}"
        told[4] = f"{sum(result.timings_s.values()):.1f} s"
        told[5] = f"{likelihood(result.verdict.probability)}, {result.verdict.outcome.value}"
    return tuple("–" if words == "…" and one.failed else words for words in told)
