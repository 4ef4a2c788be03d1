"""A chart of the model as SVG."""

from __future__ import annotations

import numpy as np

from app.drawing.palette import Palette
from app.drawing.svg.svg_canvas import SvgPlot
from app.model.chart_data import Chart


def draw_chart(plot: SvgPlot, chart: Chart, palette: Palette) -> None:
    """The curves of a chart in a plot of its axes; dots over lines, the first curve on top."""
    x, *columns = chart.columns
    for curve, y in zip(chart.curves, columns, strict=True):
        if curve.kind != "dots":
            dash = "3 4" if curve.kind == "dash" else ""
            colour = getattr(palette, curve.colour)
            plot.curve(x, y, colour, curve.size, fill=curve.kind == "area", dash=dash)
    for curve, y in reversed(list(zip(chart.curves, columns, strict=True))):
        for n in np.flatnonzero(np.isfinite(y)) if curve.kind == "dots" else ():
            at = plot.one(float(x[n]), float(y[n]))
            if curve.colour == "answer":
                plot.sheet.star(*at, 8, palette.answer, palette.rim)
            else:
                plot.sheet.dot(*at, curve.size / 2, getattr(palette, curve.colour), "#fff", width=1)
