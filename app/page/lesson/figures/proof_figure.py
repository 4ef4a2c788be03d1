"""Pictures of the proof: how its bounds come down, and what it does not prove."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from math import degrees

import numpy as np
import skimage  # its parts are loaded where they are first used

from algorithms.common.pose import FloatArray, Pose2, pose_error
from algorithms.methods.steps import AugmentDetail, ProofDetail, ProvenDetail
from algorithms.optimisation.objective import PAD, Lookup
from app.drawing.grid_pixels import upright
from app.drawing.palette import Palette, css, viridis
from app.drawing.svg.svg_canvas import SvgCanvas, SvgPlot, draw_chart, ticks
from app.model import chart_data as charts
from app.model.objective_label import measure_of
from app.page.lesson.figures.search_figures import cut_out, transforms
from app.page.lesson.lesson_run import LessonRun

LOOKS = 40  # at a proof
CELLS = 3  # to both sides of the best, from near by


def looks(lesson: LessonRun) -> list[int]:
    """Numbers of the steps of the proof that are looked at, from its beginning to its end."""
    count = len(lesson.all(ProofDetail))
    return np.unique(np.linspace(0, count - 1, LOOKS).round().astype(int)).tolist() if count else []


def proof(lesson: LessonRun, at: Sequence[int], palette: Palette) -> str:
    """Map 1 pooled coarser and coarser, and what is left of every turn."""
    chosen, sheet = looks(lesson), SvgCanvas(318)
    state = lesson.all(ProofDetail)[chosen[min(at[0], len(chosen) - 1)]].state
    table = lesson.gamma.sides[0].table[PAD:-PAD, PAD:-PAD]
    lifted = lesson.get(AugmentDetail).ref
    reach = min(64, max(table.shape) // 2)
    centre = lifted.grid.grid_coordinates(lifted.x_hat) - lesson.gamma.sides[0].corner
    col, row = centre.astype(int).tolist()
    part = cut_out(table, (row - reach, col - reach), 2 * reach, np.float32(0))
    top = max(float(part.max()), 1e-12)
    sheet.text(0, 11, "map 1's levels; the highest within 1, 4, 8, 16 cells", 11, bold=True)
    for k, size in enumerate((1, 4, 8, 16)):
        pooled = skimage.measure.block_reduce(part, (size, size), np.max)
        sheet.image(upright(viridis(pooled / top)), 96.0 * k, 18, 90, 90)
        sheet.text(96.0 * k + 45, 121, f"{size} cell{'s' if size > 1 else ''}", 10, "middle")
    measure = measure_of(lesson.config)
    chart = charts.proof(state, lesson.run_until(ProofDetail).ceiling, measure)
    plot = SvgPlot(sheet, 42, 150, 324, 118, (-180, 180), chart.up)
    left = "proven" if state.proven else f"nothing above {measure.text(state.ceiling)} is left"
    sheet.text(0, 143, f"{state.nodes:,} blocks looked at: {left}", 11, bold=True)
    draw_chart(plot, chart, palette)
    unit = f" ({measure.unit})" if measure.unit else ""
    plot.axes("turn Δθ (°)", f"best{unit}", (-180, -90, 0, 90, 180), ticks(*chart.up, 4))
    x, lines, dots = 42.0, (palette.margin, palette.particle), (palette.answer, palette.rival)
    for colours, names, shape in (
        (lines, ("ceiling", "best met"), "line"),
        (dots, ("best", "rivals"), "dot"),
    ):
        for colour, name in zip(colours, names, strict=True):
            x = sheet.chip(x, 313, colour, name, shape)
    return sheet.svg("Bounds of every turn")


def between_the_lattice(lesson: LessonRun, at: Sequence[int], palette: Palette) -> str:
    """What is maximised, along x through the proven best: as the proof reads it, and smoothly."""
    proven, measure, sheet = lesson.get(ProvenDetail), measure_of(lesson.config), SvgCanvas(250)
    state, objective, window = proven.state, lesson.gamma, lesson.get(ProofDetail).window
    if lesson.config.refine.objective == "agreement":
        objective = lesson.agreement
    if state.best is None:
        sheet.text(0, 20, "No transform of the window has been met.")
        return sheet.svg("Nothing is proven")
    cell, (x, y, turn) = objective.cell, state.best.tolist()
    pivot, (goes_x, goes_y) = window.pivot, Pose2(x, y, turn).apply(window.pivot).tolist()

    def along(steps: FloatArray, lookup: Lookup) -> FloatArray:
        places = transforms(goes_x + steps, np.full(len(steps), goes_y), turn, pivot)
        return replace(objective, lookup=lookup)(places)

    fine, coarse = np.linspace(-CELLS * cell, CELLS * cell, 301), np.arange(-CELLS, CELLS + 1) * cell
    curve, tried = along(fine, Lookup.BILINEAR), along(coarse, Lookup.NEAREST)
    low, high = float(curve.min()), max(float(curve.max()), float(tried.max()), proven.peak.value)
    room = 0.12 * max(high - low, 1e-12)
    across = -100 * CELLS * cell, 100 * CELLS * cell
    plot = SvgPlot(sheet, 42, 24, 324, 110, across, (low - room, high + room))
    sheet.text(0, 13, f"{measure.name} along x, near the proven best", 11, bold=True)
    plot.curve(100 * fine, curve, css(palette.margin), 1.6)
    for step, value in zip(coarse.tolist(), tried.tolist(), strict=True):
        sheet.dot(*plot.one(100 * step, value), 4, palette.particle, "#fff", width=1)
    peak = proven.peak.T_ref_mov.apply(pivot)[0] - goes_x
    if abs(peak) <= CELLS * cell:
        sheet.star(*plot.one(100 * peak, proven.peak.value), 8, palette.answer, palette.rim)
    plot.axes("off the best of the lattice (cm)", "", None, ticks(low, high, 4))
    after = sheet.chip(42, 178, palette.particle, "places of the lattice", "dot")
    after = sheet.chip(after, 178, palette.margin, "read smoothly", "line")
    sheet.chip(after, 178, palette.answer, "climbed to", "dot")
    rows = (
        ("proven: no place of the lattice is better than", measure.text(state.best_value)),
        ("not proven: what is best between them; it was climbed to", measure.text(proven.peak.value)),
        ("not proven: that it is the truth, which is off by", _error(lesson, proven.peak.T_ref_mov, pivot)),
    )
    for row, (label, words) in enumerate(rows):
        sheet.text(0, 202 + 17 * row, label, 10.5, alpha=0.8)
        sheet.text(380, 202 + 17 * row, words, 10.5, "end")
    return sheet.svg("The objective at the places of the lattice and between them")


def _error(lesson: LessonRun, T_ref_mov: Pose2, pivot: FloatArray) -> str:
    """How far a transform is from the truth, at the (2,) seen robot; metres, mov frame."""
    truth = lesson.inputs.truth
    if truth is None or truth.T_ref_mov is None:
        return "nobody knows"
    distance, turn = pose_error(T_ref_mov, truth.T_ref_mov, pivot)
    return f"{distance:.3f} m, {degrees(turn):.2f}°"
