"""A measure over two settings as a field of colours: an image with axes, its scale, and cells to press."""

from __future__ import annotations

from html import escape
from typing import Any

import numpy as np

from app.drawing.palette import VIRIDIS, Palette, css, viridis
from app.drawing.svg.svg_canvas import SvgCanvas, worded
from app.evaluation.sweep.parameter_sweep import SweepAxis, SweepPlan
from app.page.research.sweep_curves import Points, field, reading, span, text_of, title_of, word_of

WIDE, RIGHT, TOP = 296.0, 8.0, 24.0
MOST_HIGH = 240.0  # of the field
MOST_WORDS = 9  # along an axis
LONGEST = 10  # letters of a word beside it


def heat_svg(
    plan: SweepPlan, points: Points, measure: str, judged: bool, here: int | None, palette: Palette
) -> str:
    """SVG of the field, its cells to be pressed (research.js); ``here``: the point that the sliders have."""
    columns, rows = len(plan.x.values), len(plan.y.values)
    left = 26 + 6.0 * max(4, *(len(_short(plan, value)) for value in plan.y.values))
    wide = WIDE - left - RIGHT
    high = min(MOST_HIGH, max(70.0, wide / columns * rows))
    cell = wide / columns, high / rows
    values = field(plan, points, measure)
    low, top = span(values, measure, len(plan.seeds))
    sheet, title = SvgCanvas(height=TOP + high + 78, width=WIDE), title_of(measure, plan, judged)
    sheet.text(4, 13, title, 12, bold=True)
    pixels = np.full((rows, columns, 3), palette.unknown, dtype=np.uint8)
    known = np.isfinite(values)
    pixels[known] = viridis((values[known] - low) / (top - low))
    sheet.image(pixels[::-1], left, TOP, wide, high)
    sheet.rect(left, TOP, wide, high, None, "currentColor", 0.35)
    for n, point in points.items():
        row, column = divmod(n, columns)
        found = reading(point, measure)
        x, y = left + column * cell[0], TOP + high - (row + 1) * cell[1]
        at = f"{_at(plan, plan.x, column)}, {_at(plan, plan.y, row)}"
        words = f"{at}: {point.failed if found is None else text_of(found.middle, measure)}"
        ring = f' stroke="{css(palette.best)}" stroke-width="2.5"' if n == here else ""
        sheet.parts.append(
            f'<rect data-mm-point="{n}" x="{x:.1f}" y="{y:.1f}" width="{cell[0]:.1f}" height="{cell[1]:.1f}"'
            f' fill="#000" fill-opacity="0"{ring}><title>{escape(words, quote=False)}</title></rect>'
        )
    _ticks(sheet, plan, cell, left, high)
    y = TOP + high + 52
    sheet.image(VIRIDIS[None, :, :], left, y, wide, 9, smooth=True)
    sheet.text(left, y + 21, text_of(low, measure), 10)
    sheet.text(left + wide, y + 21, text_of(top, measure), 10, "end")
    sheet.text(left, TOP + high + 34, plan.setting(plan.x).label, 11)
    colour = worded(palette.rim, palette) if not palette.dark else palette.text
    sheet.text(11, TOP + high / 2, plan.setting(plan.y).label, 11, "middle", colour, turn=-90)
    return sheet.svg(f"{title}: {plan.setting(plan.y).label} over {plan.setting(plan.x).label}")


def _at(plan: SweepPlan, axis: SweepAxis, number: int) -> str:
    return f"{plan.setting(axis).label}: {word_of(plan, axis, axis.values[number])}"


def _short(plan: SweepPlan, value: Any) -> str:
    """A value of the second setting, as it stands beside its row."""
    word = word_of(plan, plan.y, value)
    return word if len(word) <= LONGEST else f"{word[: LONGEST - 1]}…"


def _ticks(sheet: SvgCanvas, plan: SweepPlan, cell: tuple[float, float], left: float, high: float) -> None:
    """A word per row and column; of many, as many as there is room for."""
    longest = max(len(word_of(plan, plan.x, value)) for value in plan.x.values)
    every = max(-(-len(plan.x.values) // MOST_WORDS), int(-(-(6.0 * longest + 6) // cell[0])))
    for k in range(0, len(plan.x.values), every):
        word = word_of(plan, plan.x, plan.x.values[k])
        sheet.text(left + (k + 0.5) * cell[0], TOP + high + 13, word, 10, "middle")
    every = max(1, int(-(-13 // cell[1])))
    for k in range(0, len(plan.y.values), every):
        y = TOP + high - (k + 0.5) * cell[1] + 3.5
        sheet.text(left - 5, y, _short(plan, plan.y.values[k]), 10, "end")
