"""What a person asks a sweep for, in the words of its fields, as a plan."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from algorithms.common.errors import SettingError
from app.evaluation.sweep import sweep_axes as axes
from app.evaluation.sweep.parameter_sweep import SweepAxis, SweepPlan
from app.model.settings import Setting, value_at

MOST_POINTS = 400  # of a sweep on the page; the command takes any number


@dataclass(frozen=True)
class Wanted:
    """The values that a setting is to take; of a choice or a switch all of them, whatever stands here."""

    label: str
    low: float
    high: float
    count: int
    by_factor: bool


def planned(
    method: str,
    config: Any,
    settings: Mapping[str, Setting],
    x: Wanted | None,
    y: Wanted | None,
    seeds: tuple[int, ...],
) -> SweepPlan:
    """The sweep that is asked for of settings by their labels; raises SettingError."""
    if x is None or x.label not in settings:
        raise SettingError("no setting is chosen")
    if y is not None and y.label == x.label:
        raise SettingError("both settings are the same; choose another second one, or none")
    second = None if y is None else _axis(settings[y.label], y)
    plan = SweepPlan(method, config, _axis(settings[x.label], x), second, seeds)
    count = len(plan.places())
    if count > MOST_POINTS:
        raise SettingError(
            f"{count} points are asked for, more than {MOST_POINTS}; take fewer values, or mapmeld sweep"
        )
    return plan


def _axis(setting: Setting, wanted: Wanted) -> SweepAxis:
    if setting.bounds is None:
        return SweepAxis(setting.path, tuple(setting.choices.values()) if setting.choices else (False, True))
    try:
        values = axes.spaced(setting, wanted.low, wanted.high, wanted.count, wanted.by_factor)
    except SettingError as error:  # by the name of its flag; here it has another
        raise SettingError(str(error).replace(".".join(setting.path), setting.label)) from error
    return SweepAxis(setting.path, values)


def labelled(settings: Sequence[Setting]) -> dict[str, Setting]:
    """Settings by their labels, with the name of their group where two have the same."""
    labels = [each.label for each in settings]
    return {
        each.label if labels.count(each.label) == 1 else f"{each.label}, {each.path[0]}": each
        for each in settings
    }


def suggestion(setting: Setting | None, config: Any) -> tuple[float, float, bool]:
    """A range about the value that a setting has, within its bounds, and whether by equal factors."""
    if setting is None or setting.bounds is None:
        return 0.0, 1.0, False
    low, high, value = setting.bounds.low, setting.bounds.high, value_at(config, setting.path)
    if value <= 0:
        return float(low), float(high), False
    first, last = max(low, value / 4), min(high, value * 4)
    if setting.whole:
        first, last = max(low, round(first)), round(last)
    return (float(first), float(last), first > 0) if first < last else (float(low), float(high), False)
