"""Pictures of what the sighting leaves of the shift: both windows, and what they are of map 2's origin."""

from __future__ import annotations

from collections.abc import Sequence
from math import atan2, degrees, hypot, tau

import numpy as np

from algorithms.common.pose import FloatArray, rotation
from algorithms.methods.steps import CandidatesDetail, WindowDetail
from algorithms.observations.search_window import CoupledWindow
from app.drawing.draw_items import ellipse, rectangle
from app.drawing.palette import Palette
from app.drawing.scene_layout import known_corners
from app.drawing.svg.map_plot import draw_map, map_panel, view_of
from app.drawing.svg.svg_canvas import SvgCanvas, SvgPlot, number, turn_label
from app.drawing.svg.svg_grip import grip
from app.page.lesson.lesson_run import LessonRun

SIDE, SMALL = 206.0, 156.0  # pixels of the two plots
TURNS = 72  # over which map 2's origin is shown


def best_turn(lesson: LessonRun) -> float:
    """Of the best candidate, which the map shows, too; radians."""
    return lesson.get(CandidatesDetail).candidates[0].T_ref_mov.theta


def window(lesson: LessonRun, at: Sequence[int], palette: Palette) -> str:
    """Both windows to scale over map 1, where candidates put robot 2, and the coupled one from near by."""
    windows, found = lesson.get(WindowDetail), lesson.get(CandidatesDetail)
    coupled, paper = windows.coupled, windows.paper
    off = rotation(best_turn(lesson)) @ (coupled.pivot - paper.pivot)
    corners = rectangle(paper.low + off, paper.high + off)
    in_use = isinstance(windows.window, CoupledWindow)
    sheet = SvgCanvas(236)
    plot = _over_map_1(lesson, sheet, corners, "both windows, for robot 2", palette)
    sheet.path(plot.at(corners), palette.conflict, 1.4 if in_use else 2.4, dash="6 4", close=True)
    px, py = plot.one(*coupled.x_ref[0].tolist())
    sheet.dot(px, py, 7, None, palette.best, width=2)
    inset = _near_by(lesson, sheet, palette, in_use)
    for candidate in reversed(found.candidates):
        place = candidate.T_ref_mov.apply(coupled.pivot)
        for each in (plot, inset):
            if each.holds(place):
                sheet.dot(*each.one(*place.tolist()), 3.5, palette.particle, "#fff", width=1)
    sheet.path([(px + 7, py), (222, 18 + SMALL / 2)], palette.best, 1, dash="2 3")
    sheet.chip(222, 192, palette.conflict, "eqs. (6)–(10)" + ("" if in_use else ", in use"), "line")
    sheet.chip(222, 208, palette.best, "eq. (3), turn known" + (", in use" if in_use else ""), "line")
    sheet.chip(222, 224, palette.particle, "candidates", "dot")
    return sheet.svg("The paper's window and the coupled window, to scale")


def origins(lesson: LessonRun, at: Sequence[int], palette: Palette) -> str:
    """Where map 2's origin may go: the paper's window, in it the ring of all turns, and the disc of one."""
    windows = lesson.get(WindowDetail)
    coupled, paper = windows.coupled, windows.paper
    x_hat, lever, disc = coupled.x_ref[0], coupled.pivot, coupled.covariances[0]
    turn = best_turn(lesson) + at[0] * tau / TURNS
    origin = x_hat - rotation(turn) @ lever  # eq. (3)
    corners, sheet = rectangle(paper.low, paper.high), SvgCanvas(236)
    plot = _over_map_1(lesson, sheet, corners, "where map 2's origin may go", palette)
    sheet.path(plot.at(corners), palette.conflict, 1.4, dash="6 4", close=True)
    around = np.linspace(0, tau, 361)
    ring = x_hat - np.stack([rotation(each) @ lever for each in around])
    sheet.path(plot.at(ring), palette.best, 3, alpha=0.45, close=True)
    sheet.path(plot.at([x_hat, origin]), palette.text, 1.4, dash="4 3")
    sheet.dot(*plot.one(*x_hat.tolist()), 4, None, palette.conflict, width=2)
    px, py = plot.one(*x_hat.tolist())
    (ox, oy), best = plot.one(*origin.tolist()), x_hat - rotation(best_turn(lesson)) @ lever
    zero = degrees(atan2(*(best - x_hat)[::-1].tolist()))
    grip(sheet, ox, oy, palette.best, a=(0, px, py, zero, 0))
    half = 1.6 * coupled.disc
    view = view_of(origin, half, SMALL, SMALL)
    inset = map_panel(sheet, 222, SMALL, SMALL, view, view.blank(palette), "the ring, near by")
    near = turn + np.linspace(-2, 2, 41) * half / max(hypot(*lever.tolist()), half)
    for each in near:
        spot = inset.at(ellipse(x_hat - rotation(each) @ lever, disc, coupled.k))
        sheet.path(np.clip(spot, *_inside(inset)), None, 0, palette.best, close=True, fill_alpha=0.08)
    sheet.path(inset.at(ellipse(origin, disc, coupled.k)), palette.best, 2.2, close=True)
    sheet.dot(*inset.one(*origin.tolist()), 4.5, palette.best, "#fff", width=1)
    sheet.text(222, 190, f"turn Δθ = {turn_label(turn)}", 11, bold=True)
    sheet.text(222, 205, f"‖x̂₂‖ = {hypot(*lever.tolist()):.2f} m", 11)
    sheet.chip(222, 224, palette.best, "of all turns; one of them", "line")
    return sheet.svg("The ring of places where map 2's origin may go, and the disc of one turn on it")


def _inside(plot: SvgPlot) -> tuple[tuple[float, float], tuple[float, float]]:
    """Upper left and lower right corner of a plot; pixels."""
    return (plot.x, plot.y), (plot.x + plot.wide, plot.y + plot.high)


def _over_map_1(
    lesson: LessonRun, sheet: SvgCanvas, corners: FloatArray, title: str, palette: Palette
) -> SvgPlot:
    """Map 1 with room for these corners."""
    grid = lesson.inputs.ref
    assert grid is not None
    ends = np.concatenate([corners, known_corners(grid)])
    middle = (ends.min(axis=0) + ends.max(axis=0)) / 2
    view = view_of(middle, 0.54 * float(np.ptp(ends, axis=0).max()), SIDE, SIDE)
    return map_panel(sheet, 0, SIDE, SIDE, view, draw_map(view, palette, grid, palette.ref), title)


def _near_by(lesson: LessonRun, sheet: SvgCanvas, palette: Palette, in_use: bool) -> SvgPlot:
    """The disc of the coupled window, with the line of sight."""
    coupled, grid = lesson.get(WindowDetail).coupled, lesson.inputs.ref
    assert grid is not None
    x_hat = coupled.x_ref[0]
    near = max(0.6, 1.5 * float((coupled.high - coupled.low).max()) / 2)
    view = view_of(x_hat, near, SMALL, SMALL)
    pixels = draw_map(view, palette, grid, palette.ref)
    inset = map_panel(sheet, 222, SMALL, SMALL, view, pixels, "the coupled one, near by")
    for k, name in ((1.0, "1 σ"), (coupled.k, f"{number(coupled.k)} σ")):
        ring = inset.at(ellipse(x_hat, coupled.covariances[0], k))
        strong = k == coupled.k
        width = 1.0 if not strong else 2.4 if in_use else 1.4
        sheet.path(ring, palette.best, width, dash="" if strong else "3 3", close=True)
        top = ring[int(ring[:, 1].argmin())]
        sheet.text(top[0], top[1] - 3, name, 10, "middle", palette.best, True, halo=palette.free)
    away = lesson.inputs.observations[0].observer.xy - x_hat
    end = x_hat + away * min(1.0, 0.98 * near / max(float(np.hypot(*away)), 1e-12))
    sheet.path(inset.at([end, x_hat]), palette.text, 1.5, dash="5 4")
    sheet.dot(*inset.one(*x_hat.tolist()), 4, None, palette.conflict, width=2)
    return inset
