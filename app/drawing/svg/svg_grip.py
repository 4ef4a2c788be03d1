"""Handles in a picture, which lesson.js lets be dragged; what they move are the sliders of the picture."""

from __future__ import annotations

from collections.abc import Sequence
from html import escape
from json import dumps

from algorithms.common.pose import FloatArray
from app.drawing.svg.svg_canvas import Colour, SvgCanvas, SvgPlot


def grip(sheet: SvgCanvas, x: float, y: float, colour: Colour, /, **moves: Sequence[float]) -> None:
    """A handle at a pixel of a sheet; what it moves, in words of that script:

    x, y : number of a slider, the pixel and the value of one place, and those of another
    r    : number of a slider, two pixels of a centre, and the value of a pixel's distance from there
    a    : number of a slider, two pixels of a centre, the degrees of the value 0, and the least value
    """
    sheet.dot(x, y, 6.5, "#fff", colour, width=3)
    sheet.parts.append(
        f'<circle class="mm-grip" cx="{x:.1f}" cy="{y:.1f}" r="18" fill="#fff" fill-opacity="0" '
        f'data-mm-grip="{escape(dumps(moves))}"/>'
    )


def grip_in(
    plot: SvgPlot, place: FloatArray, colour: Colour, dials: tuple[int, int], zero: FloatArray
) -> None:
    """At a (2,) place of a plot; two sliders get how far it is to the right of ``zero``, and above."""
    (px, py), (left, low), (right, high) = plot.at([place, zero, zero + 1]).tolist()
    i, j = dials
    grip(plot.sheet, px, py, colour, x=(i, left, 0, right, 1), y=(j, low, 0, high, 1))
