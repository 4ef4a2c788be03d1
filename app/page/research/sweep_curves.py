"""The numbers of a sweep as they are drawn: over one setting a curve with its spread, over two a field."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from math import ceil, floor, log10
from typing import Any

import numpy as np
from numpy.typing import NDArray

from app.evaluation.sweep.parameter_sweep import SweepAxis, SweepPlan, SweepPoint
from app.evaluation.sweep.sweep_axes import looks_even_by_factor
from app.model.settings import text_for

AGREEMENT, RIGHT, ACCEPTED, TIME = "Agreement", "Right", "Accepted", "Time"

MOST_TICKS = 7

Numbers = NDArray[np.float64]
Points = Mapping[int, SweepPoint]
"""Points by the number of their place in ``plan.places()``."""


@dataclass(frozen=True)
class MeasuredValue:
    """What is read off a point: in the middle, and the extremes over the seeds."""

    middle: float
    low: float
    high: float


def measures(judged: bool) -> tuple[str, ...]:
    """What can be drawn; ``judged`` where a truth is known."""
    return (AGREEMENT, *((RIGHT,) if judged else ()), ACCEPTED, TIME)


def title_of(measure: str, plan: SweepPlan, judged: bool) -> str:
    """What a measure is, as a heading."""
    seeds = f"{len(plan.seeds)} seeds" if len(plan.seeds) > 1 else "1 seed"
    return {
        AGREEMENT: f"Eq. (23) over the {'true overlap' if judged else 'overlap found'}; {seeds}",
        RIGHT: f"Right transforms of {seeds}",
        ACCEPTED: f"Merges accepted of {seeds}",
        TIME: f"Time of a merge (s); {seeds}",
    }[measure]


def reading(point: SweepPoint, measure: str) -> MeasuredValue | None:
    """The measure of a point; None where there is none."""
    if point.failed:
        return None
    if measure == AGREEMENT:
        index = point.index
        return None if index is None else MeasuredValue(index.mean, index.low, index.high)
    if measure == TIME:
        return MeasuredValue(point.seconds.median, point.seconds.low, point.seconds.high)
    count = point.right if measure == RIGHT else point.accepted
    return None if count is None else MeasuredValue(count, count, count)


def text_of(value: float, measure: str) -> str:
    return {AGREEMENT: f"{value:.1%}", TIME: f"{value:.2f} s"}.get(measure, f"{value:.0f}")


def row(plan: SweepPlan, point: SweepPoint, listed: Sequence[str]) -> list[str]:
    """A point in a table: the value of the first setting, and these measures."""
    values = [(measure, reading(point, measure)) for measure in listed]
    words = ("–" if found is None else text_of(found.middle, measure) for measure, found in values)
    return [word_of(plan, plan.x, point.x), *words]


# ---- where points stand


def by_factor(axis: SweepAxis) -> bool:
    """Whether the axis is logarithmic."""
    if len(axis.values) < 2 or not axis.numeric or min(axis.values) <= 0:
        return False
    factors = [b / a for a, b in pairwise(sorted(axis.values))]
    even = len(factors) > 1 and min(factors) > 1.3 and max(factors) < 1.15 * min(factors)
    return even or looks_even_by_factor(axis.values)


def reach(axis: SweepAxis) -> tuple[float, float]:
    """Both ends of an axis, a little beyond its values."""
    places = [axis.place(value) for value in axis.values]
    low, high = min(places), max(places)
    if by_factor(axis):
        more = (high / low) ** 0.06
        return low / more, high * more
    more = 0.06 * (high - low) if high > low else 0.5
    return low - more, high + more


def share_of(axis: SweepAxis, value: Any) -> float:
    """How far along the axis a value stands, 0 … 1."""
    low, high = reach(axis)
    at = axis.place(value)
    if by_factor(axis):
        low, high, at = log10(low), log10(high), log10(at)
    return (at - low) / (high - low)


def nearest(plan: SweepPlan, points: Points, share: float) -> int | None:
    """Number of the point that stands nearest to a place along the x axis; None where there is none."""
    places = plan.places()
    return min(points, key=lambda n: abs(share_of(plan.x, places[n][0]) - share), default=None)


def word_of(plan: SweepPlan, axis: SweepAxis, value: Any) -> str:
    """A value of a setting, as a person reads it."""
    return text_for(plan.setting(axis), value, "on", "off")


def ticks(plan: SweepPlan, most: int = MOST_TICKS) -> tuple[tuple[float, str], ...]:
    """Places along the x axis that are named: where points stand, some of many of them."""
    values = plan.x.values[:: max(1, -(-len(plan.x.values) // most))]
    return tuple((plan.x.place(value), word_of(plan, plan.x, value)) for value in values)


# ---- a curve


def columns(plan: SweepPlan, points: Points, measure: str, here: int | None) -> tuple[Numbers, ...]:
    """x, highest, lowest, middle over the points that are there, rising; and the middle of ``here`` alone.

    Two columns of NaN where there is nothing yet: a chart wants something.
    """
    places = plan.places()
    rows = []
    for n, point in points.items():
        value = reading(point, measure)
        if value is not None:
            mark = value.middle if n == here else np.nan
            rows.append((plan.x.place(places[n][0]), value.high, value.low, value.middle, mark))
    if not rows:
        return np.array(reach(plan.x)), *(np.full(2, np.nan) for _ in range(4))
    return tuple(np.array(column, dtype=np.float64) for column in zip(*sorted(rows), strict=True))


def height(plan: SweepPlan, points: Points, measure: str) -> tuple[float, float]:
    """Lower and upper end of the y axis, in whole steps, so that it seldom changes while a curve grows."""
    if measure in (RIGHT, ACCEPTED):
        return -0.04 * len(plan.seeds), 1.04 * len(plan.seeds)
    values = [value for point in points.values() if (value := reading(point, measure)) is not None]
    low, high = min((v.low for v in values), default=0.0), max((v.high for v in values), default=1.0)
    if measure == TIME:
        step = 10.0 ** floor(log10(max(high, 1e-3)))
        return 0.0, step * ceil(1.05 * high / step)
    low, high = floor(20 * low - 1e-9) / 20, ceil(20 * high + 1e-9) / 20
    return max(0.0, low), max(min(high, 1.02 if high > 0.99 else 1.0), low + 0.05)


# ---- a field


def field(plan: SweepPlan, points: Points, measure: str) -> Numbers:
    """(rows, columns) the measure over both settings, row 0 the first value of the second; NaN: not yet."""
    cells = np.full(len(plan.y.values) * len(plan.x.values), np.nan)
    for n, point in points.items():
        value = reading(point, measure)
        if value is not None:
            cells[n] = value.middle
    return cells.reshape(len(plan.y.values), len(plan.x.values))


def span(values: Numbers, measure: str, seeds: int) -> tuple[float, float]:
    """What the ends of the colour scale stand for."""
    if measure in (RIGHT, ACCEPTED):
        return 0.0, float(seeds)
    known: Sequence[float] = values[np.isfinite(values)].tolist()
    if not known:
        return 0.0, 1.0
    low, high = (0.0 if measure == TIME else min(known)), max(known)
    return low, high if high > low else low + (0.01 if measure == AGREEMENT else 1.0)
