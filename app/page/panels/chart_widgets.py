"""Charts as widgets of a panel: their lines, marks and axes."""

from __future__ import annotations

from typing import Any

import numpy as np
import viser
from viser import uplot

from algorithms.common.pose import FloatArray

_NOTHING = (np.array([0.0, 1.0]), np.full(2, np.nan))


def dots(label: str, colour: str, size: float, rim: str | None = None) -> uplot.Series:
    """A series that is drawn as marks."""
    # no fill of the series itself: it would reach from mark to mark
    points = {"show": True, "size": size, "fill": colour, "stroke": rim or colour, "width": 1}
    return uplot.Series(label=label, width=0, stroke=colour, points=points)  # type: ignore[typeddict-item]


def line(label: str, colour: str, width: float = 1.5, **more: Any) -> uplot.Series:
    """A series that is drawn as a line."""
    return uplot.Series(label=label, stroke=colour, width=width, points={"show": False}, **more)


def entitle(chart: Any, title: str) -> None:
    """Give a chart this title."""
    if chart.title != title:  # a chart is built anew for a new title
        chart.title = title


def plot(
    gui: viser.GuiApi,
    title: str,
    label: str,
    series: tuple[uplot.Series, ...],
    height: int,
    top: float | None = 1.1,
    ticks: tuple[float, ...] = (),
) -> Any:
    """An empty chart.

    label : of the x axis
    top   : of the y axis, which begins at 0; None: it follows what is drawn
    ticks : steps between the numbers of the x axis that read well; any if empty
    """
    small = "11px system-ui, sans-serif"
    return gui.add_uplot(
        empty(len(series)),
        (uplot.Series(label=label), *series),
        title=title,
        scales={
            "x": uplot.Scale(time=False),
            "y": uplot.Scale(auto=True) if top is None else uplot.Scale(range=(0.0, top)),
        },
        axes=(
            uplot.Axis(
                label=label,
                labelSize=16,
                labelFont=small,
                font=small,
                size=26,
                **({"incrs": ticks} if ticks else {}),
            ),
            uplot.Axis(font=small, size=46 if top is None else 42),
        ),
        legend=uplot.Legend(show=True, live=False),
        height=height,
        padding=(10, 14, 0, 0),  # room for the outermost numbers of both axes
    )


def empty(series: int) -> tuple[FloatArray, ...]:
    """The data of a chart of so many series that shows nothing."""
    return (_NOTHING[0], *(_NOTHING[1] for _ in range(series)))
