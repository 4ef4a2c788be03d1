"""Pictures of the spectra: votes, sums, and correlations."""

from __future__ import annotations

from collections.abc import Sequence
from math import degrees

import numpy as np
import scipy  # its parts are loaded where they are first used

from algorithms.common.pose import FloatArray, wrap_angle
from algorithms.methods.steps import AugmentDetail, HoughDetail, ShiftDetail
from app.drawing.palette import Palette, viridis
from app.drawing.svg.map_plot import draw_map, map_panel, view_of, walls
from app.drawing.svg.svg_canvas import INK, SvgCanvas, SvgPlot, turn_label, worded
from app.drawing.svg.svg_grip import grip_in
from app.model.chart_data import to_one
from app.page.lesson.figures.figure_slider import FigureSlider, shown
from app.page.lesson.lesson_run import LessonRun

CELL_X = FigureSlider("cell, x from x̂ (m)", 161, 100, -8, 0.1)
CELL_Y = FigureSlider("cell, y from x̂ (m)", 161, 95, -8, 0.1)
WAVE_VIEW = 8.5  # metres to each side
DEGREES = (0, 30, 60, 90, 120, 150, 180)
LINES = 3  # the strongest ones of each map that are marked
APART = 8.0, 0.5  # degrees and metres in which two spots of the votes are one line


def strongest(votes: FloatArray, step: float, count: int = LINES) -> list[tuple[float, float]]:
    """θ (radians) and ρ (metres) of the lines with the most votes, each apart from those before it.

    votes : (K, R) M_H; the middle column is ρ = 0
    step  : width of a bin of ρ; metres
    """
    directions, bins = votes.shape
    # a ridge beside a spot that is taken is no line: only the tops of hills are asked
    size = 2 * round(APART[0] * directions / 180) + 1, 2 * round(APART[1] / step) + 1
    edge = size[0] // 2
    round_ = np.concatenate([votes[-edge:, ::-1], votes, votes[:edge, ::-1]])
    left = np.where(scipy.ndimage.maximum_filter(round_, size)[edge : edge + directions] == votes, votes, 0.0)
    rho = (np.arange(bins) - bins // 2) * step
    found: list[tuple[float, float]] = []
    for _ in range(count):
        k, r = np.unravel_index(int(left.argmax()), left.shape)
        if left[k, r] <= 0:
            break
        found.append((float(k) * np.pi / directions, float(rho[r])))
        off = (np.arange(directions) - k + directions / 2) % directions - directions / 2
        near = np.abs(off) * 180 / directions <= APART[0]
        wraps = np.abs(np.arange(directions) - k) > directions / 2  # past 180° a line has the other sign of ρ
        for row in np.flatnonzero(near):
            at = -rho[r] if wraps[row] else rho[r]
            left[row, np.abs(rho - at) <= APART[1]] = 0.0
    return found


def _votes(plot: SvgPlot, votes: FloatArray, step: float) -> None:
    """The accumulator in a plot of θ in degrees and ρ in metres; brightness is the root of the votes."""
    bins, reach = votes.shape[1], plot.up[1]
    rho = (np.arange(bins) - bins // 2) * step
    wanted = np.linspace(reach, -reach, int(2 * plot.high))
    columns = np.stack([np.interp(wanted, rho, row, left=0, right=0) for row in votes], axis=1)
    top = float(columns.max())
    plot.image(viridis(np.sqrt(columns / top if top > 0 else columns)))


def hough(lesson: LessonRun, at: Sequence[int], palette: Palette) -> str:
    """Both accumulators, their strongest lines marked."""
    first, second, step = lesson.votes
    reach, sheet = 2.5 * float(lesson.config.augment.spread), SvgCanvas(308)
    rows = ((18.0, first, palette.ref, "map 1"), (164.0, second, palette.mov, "map 2"))
    for y, votes, colour, name in rows:
        plot = SvgPlot(sheet, 42, y, 324, 100, (0, 180), (-reach, reach))
        sheet.text(0, y - 7, name, 11, colour=worded(colour, palette), bold=True)
        sheet.text(380, y - 7, "votes of the wall cells (bright: many)", 10.5, "end", alpha=0.8)
        _votes(plot, votes, step)
        plot.axes("θ, direction of the normal (°)" if y > 100 else "", "ρ (m)", DEGREES)
        for k, (theta, rho) in enumerate(strongest(votes, step)):
            px, py = plot.one(degrees(theta), rho)
            chosen = k == at[0]
            sheet.dot(px, py, 8 if chosen else 6, None, palette.conflict if chosen else "#fff", width=2)
            side, anchor = (-11, "end") if chosen else (10, "start")
            sheet.text(px + side, py + 4, str(k + 1), 13 if chosen else 10, anchor, "#fff", True)
    return sheet.svg("Hough accumulators of both maps over θ and ρ")


def wave(lesson: LessonRun, at: Sequence[int], palette: Palette) -> str:
    """The wall cell nearest to the handle, its wave among the votes, and the line with most of them."""
    lifted, (votes, _, step) = lesson.get(AugmentDetail).ref, lesson.votes
    sheet, reach, x_hat = SvgCanvas(252), 2.5 * float(lesson.config.augment.spread), lifted.x_hat
    handle = x_hat + (shown(CELL_X, at[0]), shown(CELL_Y, at[1]))
    view = view_of(x_hat, WAVE_VIEW, 168, 168)
    plot = map_panel(sheet, 0, 168, 168, view, draw_map(view, palette, lifted.grid, palette.ref), "map 1")
    space = SvgPlot(sheet, 224, 18, 146, 168, (0, 180), (-reach, reach))
    sheet.text(192, 11, "its votes, and one cell's wave", 11, bold=True)
    _votes(space, votes, step)
    space.axes("θ (°)", "ρ (m)", (0, 60, 120, 180))
    if len(lifted.points):
        cell = lifted.points[int(np.hypot(*(lifted.points - handle).T).argmin())]
        x, y = (cell - x_hat).tolist()
        theta = np.arange(votes.shape[0] + 1) * np.pi / votes.shape[0]
        rho = x * np.cos(theta) + y * np.sin(theta)
        bins = np.clip(np.rint(rho[:-1] / step).astype(int) + votes.shape[1] // 2, 0, votes.shape[1] - 1)
        k = int(votes[np.arange(votes.shape[0]), bins].argmax())
        space.curve(np.degrees(theta), rho, palette.particle, 2.2)
        sheet.dot(*space.one(degrees(theta[k]), rho[k]), 6, None, palette.conflict, width=2.5)
        ends = plot.at(line_through(theta[k], rho[k], x_hat, 2 * WAVE_VIEW))
        sheet.path(np.array(_cut(ends, plot)), palette.conflict, 1.8)
        sheet.path(plot.at([handle, cell]), palette.particle, 1.4, dash="3 3")
        sheet.dot(*plot.one(*cell.tolist()), 4, palette.particle, "#fff")
        where = f"The cell at ({x:.1f}, {y:.1f}) m from x̂: ρ = {x:.1f} cos θ + {y:.1f} sin θ."
        sheet.text(0, 226, where.replace("-", "−").replace("+ −", "− "), 11, bold=True)
        brightest = (
            f"Most votes on its wave: θ = {degrees(theta[k]):.0f}°, ρ = {rho[k]:.1f} m, the line drawn."
        )
        sheet.text(0, 243, brightest.replace("-", "−"), 11)
    sheet.dot(*plot.one(*x_hat.tolist()), 4, None, palette.conflict, width=2)
    grip_in(plot, handle, palette.particle, (0, 1), x_hat)
    return sheet.svg("A wall cell of map 1 in the hand, and its wave in Hough space")


def _cut(ends: FloatArray, plot: SvgPlot) -> list[FloatArray]:
    """The part of a line, given by two pixels far off, that lies in a plot."""
    t = np.linspace(0, 1, 801)[:, None]
    points = ends[0] + t * (ends[1] - ends[0])
    low, high = np.array([plot.x, plot.y]), np.array([plot.x + plot.wide, plot.y + plot.high])
    inside = np.flatnonzero(((points >= low) & (points <= high)).all(axis=1))
    return [points[inside[0]], points[inside[-1]]] if len(inside) else []


def spectrum(lesson: LessonRun, at: Sequence[int], palette: Palette) -> str:
    """The votes of each map, and below them what is left when each column is squared and summed."""
    match, sheet = lesson.get(HoughDetail).match, SvgCanvas(286)
    reach = 2.5 * float(lesson.config.augment.spread)
    first, second, step = lesson.votes
    x = np.degrees(match.angles)
    for y, votes, name in ((14.0, first, "map 1"), (80.0, second, "map 2")):
        plot = SvgPlot(sheet, 42, y, 324, 54, (0, 180), (-reach, reach))
        _votes(plot, votes, step)
        plot.axes("", "ρ (m)", (), (-5 * (reach // 5), 0, 5 * (reach // 5)) if reach >= 5 else (0,))
        sheet.text(46, y + 12, name, 11, colour="#fff", bold=True)
    top = max(float(match.ref.max()), float(match.mov.max()), 1e-12)
    plot = SvgPlot(sheet, 42, 154, 324, 88, (0, 180), (0, 1.08))
    plot.curve(x, match.ref / top, palette.ref, 2, fill=True)
    plot.curve(x, match.mov / top, palette.mov, 2, fill=True)
    plot.axes("θ, direction of the normal (°)", "HS, of its highest", DEGREES, (0, 0.5, 1))
    after = sheet.chip(262, 167, palette.ref, "map 1", "line")
    sheet.chip(after, 167, palette.mov, "map 2", "line")
    sheet.text(0, 282, "A column's votes, squared and summed. A peak: long walls run so.", 10)
    return sheet.svg("Hough spectra of both maps")


def correlation(lesson: LessonRun, at: Sequence[int], palette: Palette) -> str:
    """Map 2's spectrum slid over map 1's by the chosen turn, and the correlation at every turn."""
    match, sheet = lesson.get(HoughDetail).match, SvgCanvas(282)
    size = len(match.angles)
    x, turn = np.degrees(match.angles), float(at[0])
    k = round(turn / 180 * size) % size
    top = max(float(match.ref.max()), float(match.mov.max()), 1e-12)
    ref, mov = match.ref / top, np.roll(match.mov, k) / top
    plot = SvgPlot(sheet, 42, 18, 324, 86, (0, 180), (0, 1.08))
    sheet.text(0, 11, f"map 2's spectrum, slid by {turn:.0f}°", 11, bold=True)
    after = sheet.chip(238, 11, palette.ref, "map 1", "line")
    sheet.chip(after, 11, palette.mov, "map 2, slid", "line")
    plot.curve(x, np.minimum(ref, mov), palette.margin, 0, fill=True)
    plot.curve(x, ref, palette.ref, 2)
    plot.curve(x, mov, palette.mov, 2)
    plot.axes("direction (°)", "HS", DEGREES, (0, 0.5, 1))
    low = float(match.correlation.min())
    low = low - 0.06 * (1 - low) if low < 0.99 else 0.0
    plot = SvgPlot(sheet, 42, 158, 324, 78, (0, 360), (low, 1 + 0.12 * (1 - low)))
    sheet.text(0, 151, "their correlation CC; shaded: the same again, the twins", 11, bold=True)
    twice = np.concatenate([match.correlation, match.correlation])
    plot.band(180, 360, palette.margin, 0.12)
    plot.curve(np.arange(2 * size) * 180 / size, twice, INK, 1.6)
    plot.axes("turn Δθ (°)", "CC", (0, 45, 90, 135, 180, 225, 270, 315, 360), (round(low, 2), 1))
    for turn_, strength in zip(match.turns, match.strengths, strict=True):
        px, py = plot.one(np.mod(degrees(turn_), 360.0), strength)
        sheet.dot(px, py, 4, palette.particle, "#fff", width=1)
    value = float(match.correlation[k])
    for there in (turn, turn + 180):
        plot.upright(there, palette.best, 1.5, "3 3")
        sheet.dot(*plot.one(there, value), 4.5, palette.best, "#fff", width=1)
    after = sheet.chip(42, 279, palette.particle, "candidates", "dot")
    sheet.chip(after, 279, palette.best, f"slid by {turn:.0f}°, or {turn + 180:.0f}°: {value:.0%}", "dot")
    return sheet.svg("Correlation of the two Hough spectra")


def shift(lesson: LessonRun, at: Sequence[int], palette: Palette) -> str:
    """Both maps at a candidate's turn and shift with their sums beside them, and the correlations."""
    tried, lifted = lesson.all(ShiftDetail), lesson.get(AugmentDetail)
    candidate = tried[min(at[0], len(tried) - 1)].candidate
    sheet, wide, high = SvgCanvas(320), 210.0, 120.0
    half = 2.2 * lesson.config.augment.spread
    view = view_of(lifted.ref.x_hat, half, wide, high)
    pixels = draw_map(view, palette, lifted.ref.grid, palette.ref)
    pixels = draw_map(view, palette, lifted.mov.grid, palette.mov, candidate.T_ref_mov, pixels)
    both = walls(lifted.ref.grid, view) & walls(lifted.mov.grid, view, candidate.T_ref_mov)
    pixels[both] = palette.agreed
    words = f"candidate {min(at[0], len(tried) - 1) + 1}: turned by {turn_label(candidate.T_ref_mov.theta)}"
    map_panel(sheet, 42, wide, high, view, pixels, words)
    x0, y0, x1, y1 = view.rect
    below = SvgPlot(sheet, 42, 18 + high + 4, wide, 40, (x0, x1), (0, 1.08))
    beside = SvgPlot(sheet, 42 + wide + 4, 18, 76, high, (0, 1.08), (y0, y1))
    x, y = candidate.x, candidate.y
    for xs, ys, x_at, y_at, colour in (
        (x.ref, y.ref, x.ref_at, y.ref_at, palette.ref),
        (x.mov, y.mov, x.mov_at + x.shift, y.mov_at + y.shift, palette.mov),
    ):
        below.curve(x_at, to_one(xs), colour, 1.6)
        inside = (y_at >= y0) & (y_at <= y1)
        sheet.path(beside.at(np.column_stack([to_one(ys)[inside], y_at[inside]])), colour, 1.6)
    for frame in (below, beside):
        sheet.rect(frame.x, frame.y, frame.wide, frame.high, None, INK, 0.35)
    sheet.text(38, 18 + high + 28, "XS", 11, "end")
    sheet.text(42 + wide + 42, 11, "YS", 11, "middle")
    for n, words in enumerate(("sums of all", "levels in a", "column, a row")):
        sheet.text(300, 158 + 13 * n, words, 10, alpha=0.8)
    for left, match, name in ((30.0, x, "x"), (218.0, y, "y")):
        pad = max(3.0, 0.3 * (match.high - match.low))
        plot = SvgPlot(sheet, left, 208, 150, 70, (match.low - pad, match.high + pad), (0, 1.15))
        sheet.text(left, 201, f"C{name.upper()}: sliding along {name}", 11, bold=True)
        plot.band(match.low, match.high, palette.margin, 0.3)
        near = (match.shifts >= plot.across[0]) & (match.shifts <= plot.across[1])
        plot.curve(match.shifts[near], match.correlation[near], INK, 1.6)
        plot.upright(match.shift, palette.best, 1.5, "3 3")
        top = float(np.interp(match.shift, match.shifts, match.correlation))
        sheet.dot(*plot.one(match.shift, min(1.1, top)), 4.5, palette.best, "#fff", width=1)
        middle = (match.low + match.high) / 2
        marks = [round(middle - pad, 1), round(middle, 1), round(middle + pad, 1)]
        plot.axes(f"where x̂₂ goes, {name} (m)", "", marks, (0, 0.5, 1))
    return sheet.svg("X and Y spectra of map 1 and of the turned map 2, and their correlations")


def first_turn(lesson: LessonRun) -> int:
    """The turn that the correlation prefers; whole degrees in 0 … 179."""
    turn = lesson.get(HoughDetail).match.turns[0]
    return round(degrees(wrap_angle(turn))) % 180


def line_through(theta: float, rho: float, x_hat: FloatArray, reach: float) -> FloatArray:
    """(2, 2) ends of the line (θ, ρ) about x̂, ``reach`` metres to both sides; the map's frame."""
    normal = np.array([np.cos(theta), np.sin(theta)])
    along = np.array([-normal[1], normal[0]])
    return np.array([x_hat + rho * normal - reach * along, x_hat + rho * normal + reach * along])
