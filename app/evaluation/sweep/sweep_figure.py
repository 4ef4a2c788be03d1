"""A sweep as a figure: curves over one setting, a heat map and curves over two."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, MaxNLocator, NullLocator

from app.drawing.palette import LIGHT, css
from app.evaluation.figure_style import COLOURS, MARKERS, figure_files
from app.evaluation.sweep.parameter_sweep import Spread, SweepAxis, SweepPlan, SweepPoint, in_order
from app.evaluation.sweep.sweep_axes import SPREAD, looks_even_by_factor

INDEX = "agreeing share of the overlap, eq. (23)"
MOST_CURVES = 6  # of a second setting; more can't be told apart
LEAST_SPAN = 0.05  # of an axis of eq. (23)
MOST_WRITTEN = 14  # columns of a heat map whose cells are written into


def sweep_figure(plan: SweepPlan, points: Sequence[SweepPoint], title: str, cell: float) -> dict[str, bytes]:
    """The files of the figure, by suffix.

    title : which maps, by which method
    cell  : edge of a cell; metres
    """
    ran = [point for point in in_order(plan, points) if not point.failed]
    if plan.y is not None:
        return figure_files(lambda figure: _both(figure, plan, ran, title, cell), 10, 4.2)
    width = 9.5 if any(point.right is not None for point in ran) else 7
    return figure_files(lambda figure: _curves(figure, plan, ran, title), width, 3.4)


def _curves(figure: Figure, plan: SweepPlan, points: list[SweepPoint], title: str) -> None:
    judged = [point for point in points if point.right is not None]
    panels = figure.subplots(1, 3 if judged else 2)
    figure.suptitle(title, x=0.01, ha="left")
    at, joined = [plan.x.place(point.x) for point in points], plan.x.numeric
    _line(panels[0], at, [point.index for point in points], 0, joined)
    _no_closer(panels[0])
    panels[0].set(title="How much agrees", ylabel=INDEX)
    if judged:
        seeds = len(plan.seeds)
        places, counts = [plan.x.place(point.x) for point in judged], [point.right for point in judged]
        panels[1].plot(places, counts, color=COLOURS[2], marker=MARKERS[2], linestyle="-" if joined else "")
        panels[1].yaxis.set_major_locator(MaxNLocator(integer=True))
        panels[1].set(title="How often it is right", ylabel=f"right transforms of {seeds}")
        panels[1].set_ylim(-0.03 * seeds, seeds * 1.05)
    _line(panels[-1], at, [point.seconds for point in points], 1, joined, median=True)
    panels[-1].set(title="How long it takes", ylabel="time of a merge (s)")
    panels[-1].set_ylim(bottom=0)
    for panel in panels:
        _name_x(panel, plan, plan.x)


def _both(figure: Figure, plan: SweepPlan, points: list[SweepPoint], title: str, cell: float) -> None:
    assert plan.y is not None
    heat, lines = figure.subplots(1, 2, width_ratios=[1.25, 1])
    figure.suptitle(title, x=0.01, ha="left")
    _heat(figure, heat, plan, plan.y, points, cell)
    shown = plan.y.values[:: max(1, -(-len(plan.y.values) // MOST_CURVES))]
    beside = 0.0 if plan.x.numeric else 0.08  # curves over a choice stand beside one another
    for number, y in enumerate(shown):
        mine = [point for point in points if point.y == y]
        at = [plan.x.place(point.x) + beside * number for point in mine]
        # the first is drawn widest: curves that lie on each other are all seen
        width = 1.2 + 1.3 * (len(shown) - 1 - number)
        _line(lines, at, [point.index for point in mine], number, plan.x.numeric, _short(y), width)
    lines.legend(title=plan.setting(plan.y).label, title_fontsize=8)
    _no_closer(lines)
    lines.set(title="Mean and spread over the seeds", ylabel=INDEX)
    _name_x(lines, plan, plan.x)


def _heat(
    figure: Figure, axes: Axes, plan: SweepPlan, y: SweepAxis, points: list[SweepPoint], cell: float
) -> None:
    means = np.full((len(y.values), len(plan.x.values)), np.nan)
    for point in points:
        if point.index is not None:
            means[y.values.index(point.y), plan.x.values.index(point.x)] = point.index.mean
    low, high = (float(edge(means)) if np.isfinite(means).any() else 0.0 for edge in (np.nanmin, np.nanmax))
    low = min(low, high - LEAST_SPAN)
    picture = axes.imshow(means, cmap="viridis", aspect="auto", origin="lower", vmin=low, vmax=high)
    axes.grid(visible=False)
    if len(plan.x.values) <= MOST_WRITTEN:
        for row, col in zip(*np.nonzero(np.isfinite(means)), strict=True):
            bright = means[row, col] > low + 0.6 * (high - low)
            axes.text(
                col, row, f"{means[row, col]:.3f}".removeprefix("0"), ha="center", va="center", fontsize=7,
                color=css(LIGHT.text if bright else LIGHT.free),
            )  # fmt: skip
    _ticks(axes.xaxis, plan.x.values)
    _ticks(axes.yaxis, y.values)
    across, up = plan.setting(plan.x).label, plan.setting(y).label
    axes.set(title=f"Mean of {len(plan.seeds)} seeds", xlabel=across, ylabel=up)
    if plan.x.path == SPREAD:

        def squared_cells(value: float) -> str:
            cells = (value / cell) ** 2
            return f"{cells:.0f}" if cells < 10_000 else f"{cells / 1000:.0f}k"

        above = axes.secondary_xaxis("top")
        _ticks(above.xaxis, plan.x.values, squared_cells)
        above.set_xlabel("Σ_a of the paper (squared cells)", fontsize=8)
        above.tick_params(labelsize=7)
        axes.set_title(axes.get_title("left"), loc="left", pad=6)
    figure.colorbar(picture, ax=axes, label=INDEX, pad=0.02)


def _ticks(axis: Any, values: Sequence[Any], text: Any = None) -> None:
    """A tick per value; of many, those that there is room for."""
    every = max(1, -(-len(values) // 24))
    axis.set_ticks(range(0, len(values), every), [(text or _short)(value) for value in values[::every]])


def _line(
    axes: Axes,
    at: Sequence[float],
    spreads: Sequence[Spread | None],
    number: int,
    joined: bool,
    label: str | None = None,
    width: float = 1.8,
    median: bool = False,
) -> None:
    """A number over the values of a setting, with its spread over the seeds.

    number : of its colour and marker
    joined : between choices lies nothing: they are not
    median : shown with the extremes, instead of the mean with the standard deviation within them
    """
    found = [(x, each) for x, each in zip(at, spreads, strict=True) if each is not None]
    x = [x for x, _ in found]
    if median:
        rows = [(each.median, each.low, each.high) for _, each in found]
    else:
        reach = [(each, each.mean - each.deviation, each.mean + each.deviation) for _, each in found]
        rows = [(each.mean, max(each.low, below), min(each.high, above)) for each, below, above in reach]
    middle, low, high = np.reshape(rows, (-1, 3)).T
    look: dict[str, Any] = {"color": COLOURS[number], "label": label}
    if not joined:
        edges = np.abs(np.array([low, high]) - middle)
        axes.errorbar(x, middle, edges, fmt=MARKERS[number], markersize=6, capsize=4, **look)
        return
    axes.fill_between(x, low, high, color=COLOURS[number], alpha=0.18, linewidth=0)
    axes.plot(x, middle, marker=MARKERS[number], markersize=3 + width, linewidth=width, **look)


def _no_closer(axes: Axes) -> None:
    """Keep an axis from blowing up what is next to nothing."""
    low, high = axes.get_ylim()
    if high - low < LEAST_SPAN:
        middle = (low + high) / 2
        high = min(1.0, middle + LEAST_SPAN / 2)
        axes.set_ylim(high - LEAST_SPAN, high)


def _name_x(axes: Axes, plan: SweepPlan, axis: SweepAxis) -> None:
    axes.set_xlabel(plan.setting(axis).label)
    if not axis.numeric:
        _ticks(axes.xaxis, axis.values)
        axes.set_xlim(-0.5, len(axis.values) - 0.5)
    elif len(axis.values) > 1 and looks_even_by_factor(axis.values):
        wide = max(axis.values) > 50 * min(axis.values)  # room for two numbers a decade, or three
        axes.set_xscale("log")
        axes.xaxis.set_major_locator(LogLocator(subs=(1, 3) if wide else (1, 2, 5)))
        axes.xaxis.set_major_formatter(lambda value, _: f"{value:g}")
        axes.xaxis.set_minor_locator(NullLocator())


def _short(value: Any) -> str:
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, float):
        return f"{value:.3g}" if value < 1000 else f"{value:g}"
    return str(getattr(value, "value", value))
