"""Pictures in which map 2 is laid on map 1 by hand: turned about the meeting place, and fitted."""

from __future__ import annotations

from collections.abc import Sequence
from math import cos, radians, sin

import numpy as np

from algorithms.common.pose import FloatArray, Pose2
from app.drawing.palette import Palette, Rgb
from app.drawing.svg.map_plot import draw_map, map_panel, view_of, walls
from app.drawing.svg.svg_canvas import SvgCanvas, SvgPlot, turn_label, worded
from app.drawing.svg.svg_grip import grip, grip_in
from app.model.objective_label import AGREEMENT, GAMMA
from app.page.lesson.figures.figure_slider import FigureSlider, shown
from app.page.lesson.figures.search_figures import best_of, transforms
from app.page.lesson.lesson_run import LessonRun

TURN = FigureSlider("turn Δθ (°)", 361, 180, -180)
ALONG_X = FigureSlider("x̂₂ off x̂₁ in x (m)", 81, 56, -2, 0.05)
ALONG_Y = FigureSlider("in y (m)", 81, 24, -2, 0.05)
SIDE = 236.0  # pixels of the map
ARM = 0.8  # of half the map, from the meeting place to the knob that turns


def laid(lesson: LessonRun, at: Sequence[int], palette: Palette) -> str:
    """Map 2 on map 1 with x̂₂ on x̂₁, turned as far as the knob is."""
    sheet, turn = SvgCanvas(SIDE + 24), radians(shown(TURN, at[0]))
    _laid(sheet, lesson, np.zeros(2), turn, 0, palette)
    sheet.text(252, 40, f"Δθ = {turn_label(turn)}", 13, bold=True)
    lines = ("Turn map 2 by its knob.", "x̂₂ stays on x̂₁: the", "sighting agrees with", "every turn.")
    for row, words in enumerate(lines):
        sheet.text(252, 66 + 16 * row, words, 11)
    sheet.chip(252, 150, palette.agreed, "wall on wall")
    return sheet.svg("Map 2 laid on map 1 at the meeting place, turned by hand")


def fit(lesson: LessonRun, at: Sequence[int], palette: Palette) -> str:
    """Map 2 on map 1 where it is held, and what both objectives say of that, against the best place."""
    sheet = SvgCanvas(SIDE + 24)
    shift = np.array([shown(ALONG_X, at[0]), shown(ALONG_Y, at[1])])
    turn = radians(shown(TURN, at[2]))
    x_hat, pivot = _meeting(lesson)
    _laid(sheet, lesson, shift, turn, 2, palette)
    here = transforms(*(x_hat + shift)[:, None], turn, pivot)
    best = best_of(lesson).array()[None]
    rows = ((lesson.gamma, GAMMA, palette.best), (lesson.agreement, AGREEMENT, palette.particle))
    for row, (value, measure, colour) in enumerate(rows):
        now, top = float(value(here)[0]), max(float(value(best)[0]), 1e-12)
        _bar(sheet, 40 + 92 * row, now / top, colour, palette)
        sheet.text(252, 32 + 92 * row, f"{measure.name}: {measure.text(now)}", 10.5, bold=True)
        sheet.text(380, 76 + 92 * row, f"the best: {measure.text(top)}", 10, "end", alpha=0.8)
    sheet.text(252, 222, f"Δθ = {turn_label(turn)}", 11)
    sheet.chip(252, 242, palette.agreed, "wall on wall")
    return sheet.svg("Map 2 laid on map 1 by hand, and what both objectives say of it")


def _meeting(lesson: LessonRun) -> tuple[FloatArray, FloatArray]:
    """x̂₁ and x̂₂."""
    met = lesson.inputs.encounters[0]
    return met.x_ref, met.x_mov


def _laid(
    sheet: SvgCanvas, lesson: LessonRun, shift: FloatArray, turn: float, dial: int, palette: Palette
) -> SvgPlot:
    """Both maps, x̂₂ so far off x̂₁; handles for the shift, where the turn's dial is not the first."""
    ref, mov, (x_hat, pivot) = lesson.inputs.ref, lesson.inputs.mov, _meeting(lesson)
    assert ref is not None
    assert mov is not None
    place = x_hat + shift
    T = Pose2.from_array(transforms(*place[:, None], turn, pivot)[0])
    half = 2.0 * lesson.config.augment.spread
    view = view_of(x_hat, half, SIDE, SIDE)
    pixels = draw_map(view, palette, ref, palette.ref)
    pixels = draw_map(view, palette, mov, palette.mov, T, pixels)
    pixels[walls(ref, view) & walls(mov, view, T)] = palette.agreed
    plot = map_panel(sheet, 0, SIDE, SIDE, view, pixels, "map 1, and map 2 in the hand")
    knob = place + ARM * half * np.array([cos(turn), sin(turn)])
    (px, py), (kx, ky) = plot.at([place, knob]).tolist()
    sheet.path([(px, py), (kx, ky)], palette.text, 1.4, dash="4 3")
    grip(sheet, kx, ky, palette.conflict, a=(dial, px, py, 0, -180))
    if dial:
        grip_in(plot, place, palette.mov, (0, 1), x_hat)
    else:
        sheet.dot(px, py, 6, None, palette.conflict, width=2)
    return plot


def _bar(sheet: SvgCanvas, y: float, share: float, colour: Rgb, palette: Palette) -> None:
    """From −1 to 1 of the value at the best place."""
    left, wide, zero = 252.0, 128.0, 252.0 + 40.0
    sheet.rect(left, y, wide, 18, palette.margin, None, 0.18)
    end = zero + 88.0 * min(1.0, max(-0.45, share))
    sheet.rect(min(zero, end), y, abs(end - zero), 18, colour if share >= 0 else palette.conflict)
    sheet.path([(zero, y - 3), (zero, y + 21)], palette.text if not palette.dark else "#fff", 1.5)
    if share < 0:
        sheet.text(zero + 5, y + 13, "it denies this", 10, colour=worded(palette.conflict, palette))
