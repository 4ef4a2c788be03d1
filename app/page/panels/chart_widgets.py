"""A chart of the model as a widget of a panel."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import viser
from viser import uplot

from algorithms.common.pose import FloatArray
from algorithms.common.robot_names import UNNAMED, RobotNames
from app.drawing.palette import LIGHT, css
from app.model.chart_data import Chart, Curve
from app.page.panels.html_widgets import put

RIM = "#9a8b00"  # of yellow dots; it reads on light and on dark panels alike, as the light colours do
FILLED = {"area": 0.16, "band": 0.2}  # opacity of what lies below a curve


def add_chart(gui: viser.GuiApi, form: Chart, height: int) -> Any:
    """A chart that shows nothing yet."""
    small = "11px system-ui, sans-serif"
    turns = {"incrs": (30.0, 45.0, 90.0, 180.0)} if form.across == (-180.0, 180.0) else {}
    return gui.add_uplot(
        nothing(len(form.curves)),
        _all_series(form, UNNAMED),
        title=form.title,
        scales=_scales(form),
        axes=(
            uplot.Axis(label=form.axis, labelSize=16, labelFont=small, font=small, size=26, **turns),
            uplot.Axis(font=small, size=46 if form.up is None else 42),
        ),
        legend=uplot.Legend(show=True, live=False),
        height=height,
        padding=(10, 14, 0, 0),  # room for the outermost numbers of both axes
    )


def fill(handle: Any, chart: Chart, names: RobotNames = UNNAMED) -> None:
    """Show the curves; the widget is built anew where its title or an axis changes."""
    put(handle, scales=_scales(chart), title=names.told(chart.title))
    handle.data = chart.columns


def name_curves(handle: Any, form: Chart, names: RobotNames) -> None:
    """Call the curves of two robots by their names."""
    put(handle, series=_all_series(form, names))


def nothing(curves: int) -> tuple[FloatArray, ...]:
    """The data of a chart that shows nothing."""
    return (np.array([0.0, 1.0]), *[np.full(2, np.nan)] * curves)


def _scales(chart: Chart) -> dict[str, uplot.Scale]:
    across, up = chart.across, chart.up
    return {
        "x": uplot.Scale(time=False) if across is None else uplot.Scale(time=False, range=across),
        "y": uplot.Scale(auto=True) if up is None else uplot.Scale(range=up),
    }


def _all_series(chart: Chart, names: RobotNames) -> tuple[uplot.Series, ...]:
    named = (replace(curve, name=names.told(curve.name)) for curve in chart.curves)
    return uplot.Series(label=chart.axis), *map(_series, named)


def _series(curve: Curve) -> uplot.Series:
    rgb = getattr(LIGHT, curve.colour)
    colour, points = css(rgb), {"show": False}
    if curve.kind == "dots":
        # no fill of the series itself: it would reach from mark to mark
        rim = RIM if curve.colour == "answer" else colour
        points = {"show": True, "size": curve.size, "fill": colour, "stroke": rim, "width": 1}
    width = 0 if curve.kind in ("dots", "band") else curve.size
    how: dict[str, Any] = {"dash": (3, 4), "alpha": 0.8} if curve.kind == "dash" else {}
    if curve.kind in FILLED:
        how["fill"] = css(rgb, FILLED[curve.kind] if curve.colour == "margin" else 0.55)
    return uplot.Series(label=curve.name, stroke=colour, width=width, points=points, **how)  # type: ignore[typeddict-item]
