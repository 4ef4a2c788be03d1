"""A sweep as a figure: curves over one setting, a heat map and curves over two."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, MaxNLocator, NullLocator

from app.drawing.palette import LIGHT
from app.evaluation.figure_style import COLOURS, MARKERS, colour, figure_files
from app.evaluation.parameter_sweep import Spread, SweepAxis, SweepPlan, SweepPoint, in_order
from app.evaluation.sweep_axes import SPREAD, looks_even_by_factor

INDEX = "agreeing share of the overlap, eq. (23)"
MOST_CURVES = 6  # of a second setting; more can't be told apart
LEAST_SPAN = 0.05  # of an axis of eq. (23)
MOST_WRITTEN = 14  # columns of a heat map whose cells are written into


def sweep_figure(plan: SweepPlan, points: Sequence[SweepPoint], title: str, cell: float) -> dict[str, bytes]:
    """The files of the figure, by suffix.

    title : which maps, by which method
    cell  : edge of a cell; metres
    """
    told = [point for point in in_order(plan, points) if not point.failed]
    if plan.y is None:
        judged = any(point.right is not None for point in told)
        return figure_files(
            lambda figure: _curves(figure, plan, told, title, cell), 9.5 if judged else 7, 3.4
        )
    return figure_files(lambda figure: _both(figure, plan, told, title, cell), 10, 4.2)


def _curves(figure: Figure, plan: SweepPlan, points: list[SweepPoint], title: str, cell: float) -> None:
    judged = [point for point in points if point.right is not None]
    panels = figure.subplots(1, 3 if judged else 2)
    figure.suptitle(title, x=0.01, ha="left")
    at = _places(plan.x, points)
    joined = _is_number(plan.x)
    _line(panels[0], at, [point.index for point in points], COLOURS[0], MARKERS[0], joined=joined)
    _no_closer(panels[0])
    panels[0].set(title="How much agrees", ylabel=INDEX)
    if judged:
        seeds = len(plan.seeds)
        panels[1].plot(
            _places(plan.x, judged), [point.right for point in judged], color=COLOURS[2], marker=MARKERS[2],
            linestyle="-" if joined else "",
        )  # fmt: skip
        panels[1].yaxis.set_major_locator(MaxNLocator(integer=True))
        panels[1].set(
            title="How often it is right",
            ylabel=f"right transforms of {seeds}",
            ylim=(-0.03 * seeds, seeds * 1.05),
        )
    _line(
        panels[-1],
        at,
        [point.seconds for point in points],
        COLOURS[1],
        MARKERS[1],
        middle="median",
        joined=joined,
    )
    panels[-1].set(title="How long it takes", ylabel="time of a merge (s)")
    panels[-1].set_ylim(bottom=0)
    for panel in panels:
        _name_x(panel, plan, plan.x, cell)


def _both(figure: Figure, plan: SweepPlan, points: list[SweepPoint], title: str, cell: float) -> None:
    assert plan.y is not None
    heat, lines = figure.subplots(1, 2, width_ratios=[1.25, 1])
    figure.suptitle(title, x=0.01, ha="left")
    _heat(figure, heat, plan, plan.y, points, cell)
    shown = plan.y.values[:: max(1, -(-len(plan.y.values) // MOST_CURVES))]
    for number, y in enumerate(shown):
        mine = [point for point in points if point.y == y]
        # the first is drawn widest: curves that lie on each other are all seen
        _line(
            lines, _places(plan.x, mine, number), [point.index for point in mine], COLOURS[number],
            MARKERS[number], label=_short(y), width=1.2 + 1.3 * (len(shown) - 1 - number),
            joined=_is_number(plan.x),
        )  # fmt: skip
    lines.legend(title=_label(plan, plan.y), title_fontsize=8)
    _no_closer(lines)
    lines.set(title="Mean and spread over the seeds", ylabel=INDEX)
    _name_x(lines, plan, plan.x, cell)


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
                color=colour(LIGHT.text if bright else LIGHT.free),
            )  # fmt: skip
    _ticks(axes.xaxis, plan.x.values)
    _ticks(axes.yaxis, y.values)
    axes.set(title=f"Mean of {len(plan.seeds)} seeds", xlabel=_label(plan, plan.x), ylabel=_label(plan, y))
    if plan.x.path == SPREAD:
        above = axes.secondary_xaxis("top")
        _ticks(above.xaxis, plan.x.values, lambda value: _round((value / cell) ** 2))
        above.set_xlabel("Σ_a of the paper (squared cells)", fontsize=8)
        above.tick_params(labelsize=7)
        axes.set_title(axes.get_title("left"), loc="left", pad=6)
    figure.colorbar(picture, ax=axes, label=INDEX, pad=0.02)


def _ticks(axis: Any, values: Sequence[Any], text: Any = None) -> None:
    """A tick per value; of many, those that there is room for."""
    every = max(1, -(-len(values) // 24))
    axis.set_ticks(range(0, len(values), every), [(text or _short)(value) for value in values[::every]])


def _line(
    axes: Axes, at: list[float], spreads: Sequence[Spread | None], hue: str, marker: str, label: str = "",
    width: float = 1.8, middle: str = "mean", joined: bool = True,
) -> None:  # fmt: skip
    """A curve with a band: mean and standard deviation within the extremes, or median and extremes.

    joined : between choices lies nothing: they are not
    """
    pairs = [(x, spread) for x, spread in zip(at, spreads, strict=True) if spread is not None]
    x = [place for place, _ in pairs]
    if middle == "median":
        curve = [spread.median for _, spread in pairs]
        low, high = [spread.low for _, spread in pairs], [spread.high for _, spread in pairs]
    else:
        curve = [spread.mean for _, spread in pairs]
        low = [max(spread.low, spread.mean - spread.deviation) for _, spread in pairs]
        high = [min(spread.high, spread.mean + spread.deviation) for _, spread in pairs]
    if not joined:
        reach = np.abs(np.array([low, high]) - curve)
        axes.errorbar(x, curve, reach, color=hue, fmt=marker, markersize=6, capsize=4, label=label or None)
        return
    axes.fill_between(x, low, high, color=hue, alpha=0.18, linewidth=0)
    axes.plot(x, curve, color=hue, marker=marker, markersize=3 + width, linewidth=width, label=label or None)


def _no_closer(axes: Axes) -> None:
    """Keep an axis from blowing up what is next to nothing."""
    low, high = axes.get_ylim()
    if high - low < LEAST_SPAN:
        middle = (low + high) / 2
        high = min(1.0, middle + LEAST_SPAN / 2)
        axes.set_ylim(high - LEAST_SPAN, high)


def _places(axis: SweepAxis, points: Sequence[SweepPoint], beside: int = 0) -> list[float]:
    """Where points stand: at their number, or in a row where the setting is a choice, a little beside
    those of another curve.
    """
    if _is_number(axis):
        return [float(point.x) for point in points]
    return [axis.values.index(point.x) + 0.08 * beside for point in points]


def _is_number(axis: SweepAxis) -> bool:
    return all(isinstance(value, (int, float)) and not isinstance(value, bool) for value in axis.values)


def _name_x(axes: Axes, plan: SweepPlan, axis: SweepAxis, cell: float) -> None:
    axes.set_xlabel(_label(plan, axis))
    if not _is_number(axis):
        _ticks(axes.xaxis, axis.values)
        axes.set_xlim(-0.5, len(axis.values) - 0.5)
    elif len(axis.values) > 1 and looks_even_by_factor(axis.values):
        wide = max(axis.values) > 50 * min(axis.values)  # room for two numbers a decade, or three
        axes.set_xscale("log")
        axes.xaxis.set_major_locator(LogLocator(subs=(1, 3) if wide else (1, 2, 5)))
        axes.xaxis.set_major_formatter(lambda value, _: f"{value:g}")
        axes.xaxis.set_minor_locator(NullLocator())


def _label(plan: SweepPlan, axis: SweepAxis) -> str:
    return plan.setting(axis).label


def _round(value: float) -> str:
    return f"{value:.0f}" if value < 10_000 else f"{value / 1000:.0f}k"


def _short(value: Any) -> str:
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, float):
        return f"{value:.3g}" if value < 1000 else f"{value:g}"
    return str(getattr(value, "value", value))
