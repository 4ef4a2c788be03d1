"""Pictures of the search: the landscape, darts, the swarm and its pulls."""

from __future__ import annotations

from collections.abc import Sequence
from math import degrees, hypot

import numpy as np

from algorithms.common.pose import FloatArray, Pose2, wrap_angle
from algorithms.methods.steps import WindowDetail
from algorithms.optimisation.objective import Objective
from algorithms.optimisation.optimiser import SearchState
from app.drawing.draw_items import ellipse, rectangle
from app.drawing.palette import Palette, css, viridis
from app.drawing.svg.svg_canvas import INK, SvgCanvas, SvgPlot, ticks, turn_label
from app.model.chart_data import to_one
from app.model.objective_label import AGREEMENT, GAMMA, ObjectiveLabel, measure_of
from app.page.lesson.lesson_run import FEW, LessonRun

SIDE = 61  # samples of a landscape along each axis
TURN_STEPS, TURN_STEP = 41, 0.5  # of the slider; degrees
NEAR = 1  # cell of map 1 to both sides of the best, from near by
LEAST_NEAR = 0.85  # of the best, the foot of that picture
PALED = (17, 24, 39)  # a landscape is darkened with it, so that marks over it stand out
PLACES = "where x̂₂ goes, x (m)"


def transforms(x: FloatArray, y: FloatArray, turn: FloatArray | float, pivot: FloatArray) -> FloatArray:
    """(P, 3) Δx, Δy, Δθ of the transforms that put a pivot at (x, y) and turn by ``turn``."""
    turn = np.broadcast_to(turn, x.shape)
    c, s = np.cos(turn), np.sin(turn)
    px, py = pivot.tolist()
    return np.column_stack([x - c * px + s * py, y - s * px - c * py, turn])


def best_of(lesson: LessonRun) -> Pose2:
    """The best transform that the run has come to."""
    answer = lesson.run_until(type(lesson.steps[-1].detail)).answer if lesson.steps else None
    return lesson.box.transform(lesson.box.centre) if answer is None else answer


def _landscape(
    value: Objective, middle: FloatArray, half: float, turn: float, pivot: FloatArray
) -> FloatArray:
    """(SIDE, SIDE) values at one turn where the pivot goes around a place, row 0 at the top."""
    x0, y0 = middle.tolist()
    offset = (np.arange(SIDE) + 0.5) / SIDE * 2 * half - half
    x, y = np.meshgrid(x0 + offset, y0 - offset)
    return value(transforms(x.ravel(), y.ravel(), turn, pivot)).reshape(SIDE, SIDE)


def objective(lesson: LessonRun, at: Sequence[int], palette: Palette) -> str:
    """Γ and the agreement over the shift at a turn, and over the turn at the best shift."""
    best, coupled = best_of(lesson), lesson.get(WindowDetail).coupled
    half = max(1.0, 0.75 * float((coupled.high - coupled.low).max()))
    off = np.radians(TURN_STEP) * (at[0] - TURN_STEPS // 2)
    turn = best.theta + off
    place = best.apply(coupled.pivot)
    x0, y0 = coupled.x_ref[0].tolist()
    sheet, side = SvgCanvas(336), 124.0
    turns = np.radians(np.arange(0.0, 360.0, 0.5))
    round_ = transforms(np.full(720, place[0]), np.full(720, place[1]), turns, coupled.pivot)
    order = np.argsort(np.mod(np.degrees(turns) + 180, 360))
    below = SvgPlot(sheet, 42, 226, 196, 68, (-180, 180), (-0.35, 1.1))
    sheet.text(0, 219, "over the turn", 11, bold=True)
    reach = NEAR * lesson.inputs.ref.resolution
    beside = SvgPlot(sheet, 274, 226, 92, 68, (-100 * reach, 100 * reach), (LEAST_NEAR, 1.01))
    sheet.text(262, 219, "near the star, in x", 11, bold=True)
    steps = np.linspace(-reach, reach, 241)
    near = transforms(place[0] + steps, np.full(len(steps), place[1]), turn, coupled.pivot)
    rows: tuple[tuple[float, Objective, ObjectiveLabel, str], ...] = (
        (42.0, lesson.gamma, GAMMA, css(palette.best)),
        (226.0, lesson.agreement, AGREEMENT, css(palette.particle)),
    )
    for x, value, measure, colour in rows:
        grid = _landscape(value, coupled.x_ref[0], half, turn, coupled.pivot)
        plot = SvgPlot(sheet, x, 18, side, side, (x0 - half, x0 + half), (y0 - half, y0 + half))
        top = float(value(transforms(*place[:, None], turn, coupled.pivot))[0])
        highest = max(top, float(grid.max()), 1e-12)
        name = "Γ, eq. (17)" if measure is GAMMA else "A"
        sheet.text(x, 11, f"{name}: {measure.text(top)} at the star", 11, bold=True)
        plot.image(viridis(np.clip(grid / highest, 0, 1)))
        ring = plot.at(ellipse(coupled.x_ref[0], coupled.covariances[0], coupled.k))
        sheet.path(ring, "#fff", 1.4, dash="4 3", close=True)
        sheet.star(*plot.one(*place.tolist()), 7, palette.answer, palette.rim)
        plot.axes(PLACES, "y (m)" if x < 100 else "", _few(x0, half), _few(y0, half))
        curve = to_one(value(round_))
        below.curve(np.mod(np.degrees(turns) + 180, 360)[order] - 180, curve[order], colour, 1.5)
        beside.curve(100 * steps, to_one(value(near)), colour, 1.5)
    here = f"at Δθ = {turn_label(wrap_angle(turn))}, {turn_label(off)} off the best"
    sheet.text(0, 186, f"{here}. Dashed: the window. Star: the best.", 10)
    sheet.text(0, 200, "Dark: nothing fits, or more is denied than agrees.", 10, alpha=0.8)
    below.upright((degrees(turn) + 180) % 360 - 180, INK, 1, "3 3")
    below.axes("turn Δθ (°)", "", (-180, -90, 0, 90, 180), (0, 0.5, 1), grid=True)
    beside.axes("x (cm)", "", (round(-100 * reach), 0, round(100 * reach)), (LEAST_NEAR, 1), grid=True)
    after = sheet.chip(96, 219, palette.best, "Γ", "line")
    sheet.chip(after, 219, palette.particle, "A, each of its highest", "line")
    return sheet.svg("Landscapes of both objectives")


def cut_out(cells: np.ndarray, corner: tuple[int, int], side: int, outside: np.generic) -> np.ndarray:
    """(side, side) cells from row and column ``corner`` on; beyond the array those of ``outside``."""
    rows, cols = (np.arange(side) + first for first in corner)
    inside = np.ix_((rows >= 0) & (rows < cells.shape[0]), (cols >= 0) & (cols < cells.shape[1]))
    part = np.full((side, side), outside)
    part[inside] = cells[np.ix_(rows[inside[0].ravel()], cols[inside[1].ravel()])]
    return part


def _few(middle: float, half: float) -> list[float]:
    return [round(middle - half / 2, 1), round(middle + half / 2, 1)]


def _box_plot(lesson: LessonRun, sheet: SvgCanvas, x: float, y: float, side: float) -> SvgPlot:
    """The box over x and y, a landscape of what is maximised behind it, its longer edge filling the plot."""
    box = lesson.box
    half = 0.5 * float((box.high - box.low)[:2].max()) * 1.02
    cx, cy = box.centre[:2].tolist()
    plot = SvgPlot(sheet, x, y, side, side, (cx - half, cx + half), (cy - half, cy + half))
    value = lesson.agreement if lesson.config.refine.objective == "agreement" else lesson.gamma
    grid = _landscape(value, box.centre[:2], half, best_of(lesson).theta, box.pivot)
    share = np.clip(grid / max(float(grid.max()), 1e-12), 0, 1)
    plot.image(np.asarray(0.55 * viridis(share) + 0.45 * np.array(PALED), dtype=np.uint8))
    sheet.path(plot.at(rectangle(box.low[:2], box.high[:2])), "#fff", 1.5, dash="6 4", close=True)
    coupled = lesson.get(WindowDetail).coupled
    sheet.path(plot.at(ellipse(coupled.x_ref[0], coupled.covariances[0], coupled.k)), "#fff", 1.2, close=True)
    plot.axes(PLACES, "y (m)", _few(cx, 0.5), _few(cy, 0.5))
    return plot


def samples(lesson: LessonRun, at: Sequence[int], palette: Palette) -> str:
    """The darts so far in the box, the best of them, and how the best value climbed."""
    states, sheet = lesson.samples, SvgCanvas(232)
    k = min(at[0], len(states) - 1)
    plot = _box_plot(lesson, sheet, 42, 18, 160)
    shown = states[max(0, k - 3) : k + 1]  # the newest ones; all of them would be a blot
    count = (k + 1) * len(states[0].poses)
    sheet.text(0, 11, f"{count:,} darts", 11, bold=True)
    for age, state in enumerate(reversed(shown)):
        for px, py in plot.at(state.poses[:120, :2]).tolist():
            sheet.dot(px, py, 1.7, palette.particle, None, 0.9 - 0.22 * age)
    sheet.star(*plot.one(*states[k].best[:2].tolist()), 7, palette.answer, palette.rim)
    measure, best = measure_of(lesson.config), np.array([state.best_value for state in states])
    known = np.where(np.isfinite(best), best, 0.0)
    low, high = float(known.min()), max(float(known.max()), 1e-12)
    low = min(low, 0.9 * high)
    chart = SvgPlot(sheet, 252, 18, 118, 160, (0, len(states)), (low, high + 0.08 * (high - low)))
    sheet.text(376, 11, f"best so far: {measure.text(float(best[k]))}", 11, "end", bold=True)
    chart.curve(np.arange(1.0, len(states) + 1), known, css(palette.margin), 1, alpha=0.6)
    chart.curve(np.arange(1.0, k + 2), known[: k + 1], css(palette.particle), 2.2)
    chart.axes(f"throws of {len(states[0].poses):,}", "", ticks(0, len(states), 3), ticks(low, high, 4))
    return sheet.svg("Samples in the box and the best of them")


def swarm(lesson: LessonRun, at: Sequence[int], palette: Palette) -> str:
    """One move of the swarm: all particles in the box, and the pulls on the chosen one from near by."""
    states = lesson.few
    k, j = min(at[0] + 1, len(states) - 1), min(at[1], FEW - 1)
    before, after = states[max(0, k - 1)], states[k]
    sheet = SvgCanvas(284)
    plot = _box_plot(lesson, sheet, 42, 18, 160)
    sheet.text(0, 11, f"move {k} of {len(states) - 1}: all {FEW} particles", 11, bold=True)
    ends = (plot.at(state.poses[:, :2]).tolist() for state in (before, after))
    for n, (start, end) in enumerate(zip(*ends, strict=True)):
        sheet.path([start, end], palette.particle, 1, alpha=0.8)
        sheet.dot(*end, 3, palette.particle)
        if n == j:
            sheet.dot(*end, 6, None, "#fff", width=2)
    sheet.star(*plot.one(*before.best[:2].tolist()), 6, palette.best, "#fff")
    if after.pulls is not None:
        _pulls(sheet, before, after, j, palette)
    return sheet.svg("A move of the swarm and what pulls at one particle")


def _pulls(sheet: SvgCanvas, before: SearchState, after: SearchState, j: int, palette: Palette) -> None:
    """The three terms of eq. (21) from where the particle is, and the step that they add up to."""
    here, there = before.poses[j], after.poses[j]
    terms = after.pulls[:, j]
    ends = here + np.array([*terms, terms.sum(axis=0)])
    places = np.array([here, *ends, there, before.best, before.own_poses[j]])[:, :2]
    low, high = places.min(axis=0), places.max(axis=0)
    half = max(0.004, 0.62 * float((high - low).max()))
    cx, cy = ((low + high) / 2).tolist()
    plot = SvgPlot(sheet, 216, 18, 158, 158, (cx - half, cx + half), (cy - half, cy + half))
    sheet.text(216, 11, f"particle {j + 1}, near by", 11, bold=True)
    sheet.rect(plot.x, plot.y, plot.wide, plot.high, palette.free, INK, 0.35)
    sheet.rect(plot.x, plot.y, plot.wide, plot.high, None, INK, 0.35)
    sheet.star(*plot.one(*before.best[:2].tolist()), 7, palette.best, palette.rim)
    sheet.star(*plot.one(*before.own_poses[j, :2].tolist()), 6, palette.particle, palette.rim)
    names = ("ω · own motion", "ω κτ · to the swarm's best", "ω κτ · to its own best")
    colours = (palette.ref, palette.best, palette.particle)
    start, *tips = plot.at([here[:2], *ends[:, :2]]).tolist()
    sheet.arrow(start, tips[3], palette.text, 1.6, dash="4 3")
    for tip, colour in zip(tips, colours, strict=False):
        sheet.arrow(start, tip, colour, 2.4)
    sheet.dot(*start, 4, palette.text, "#fff", width=1)
    sheet.dot(*plot.one(*there[:2].tolist()), 5, None, palette.text, width=1.8)
    sheet.text(374, 190, f"{_length(2 * half)} across", 10, "end", alpha=0.8)
    for n, (name, colour) in enumerate(zip(names, colours, strict=True)):
        sheet.path([(0, 222 + 16 * n), (16, 222 + 16 * n)], colour, 3)
        sheet.text(24, 226 + 16 * n, f"{name}: {_motion(terms[n])}", 11)
    sheet.path([(0, 270), (16, 270)], palette.text, 1.6, dash="4 3")
    step = terms.sum(axis=0)
    bounded = not np.allclose(here + step, there, atol=1e-9)
    sheet.text(24, 274, f"the step: {_motion(step)}{'; the box stops it' if bounded else ''}", 11)


def _motion(step: FloatArray) -> str:
    x, y, turn = step.tolist()
    return f"{_length(hypot(x, y))}, {degrees(turn):.2f}°".replace("-", "−")


def _length(metres: float) -> str:
    if metres >= 0.1:
        return f"{metres:.2f} m"
    return f"{100 * metres:.1f} cm" if metres >= 0.01 else f"{1000 * metres:.1f} mm"
