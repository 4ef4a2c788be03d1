"""What a sweep may run over: a setting by its name, its values written short; and the paper's two sweeps."""

from __future__ import annotations

from difflib import get_close_matches
from math import isfinite, log, sqrt
from typing import Any

from algorithms.common.errors import SettingError
from app.evaluation.sweep.parameter_sweep import SEEDS, SweepAxis, SweepPlan
from app.model.settings import Setting, settings_of, what_became_of, with_value

MOST_VALUES = 200  # of one setting
GRAMMAR = "NAME=V1,V2,… or NAME=LOW:HIGH:COUNT or NAME=LOW:HIGH:COUNT:log"

SPREAD, INTENSITY, PARTICLES = ("augment", "spread"), ("augment", "intensity"), ("swarm", "particles")

# Section IV-B of the paper. Its Σ_a is in squared cells; 74 and 105 are the two values that it names.
PAPER_PARTICLES = 200
PAPER_INTENSITY = 100.0
PAPER_SQUARED_CELLS = 105
SQUARED_CELLS = (16, 36, 74, 105, 225, 400, 900, 1600, 3600, 6400, 14400, 25600)
INTENSITIES = (1.0, 10.0, 100.0, 1000.0)
PARTICLE_COUNTS = (10, 20, 50, 100, 200, 300, 400, 600, 800, 1200, 2000)


def axis_from(text: str, config: Any) -> SweepAxis:
    """The axis that a person wrote, e.g. ``augment.spread=1:8:8``; raises SettingError, out of bounds too."""
    name, equals, values = text.partition("=")
    if not equals or not values:
        raise SettingError(f"{text} is no range of a setting; write {GRAMMAR}")
    setting = setting_named(name, config)
    axis = SweepAxis(setting.path, _values(values, setting, name))
    for value in axis.values:
        with_value(config, axis.path, value)
    return axis


def setting_named(name: str, config: Any) -> Setting:
    """The setting that a flag of this name sets; raises SettingError."""
    known = {".".join(setting.path).replace("_", "-"): setting for setting in settings_of(config)}
    found = known.get(name.strip().replace("_", "-"))
    if found is None:
        if became := what_became_of(name.strip()):
            raise SettingError(f"there is no setting {name} any more; {became}")
        near = get_close_matches(name, list(known), n=1)
        remedy = f"did you mean {near[0]}?" if near else f"known are {', '.join(known)}"
        raise SettingError(f"this method has no setting {name}; {remedy}")
    return found


def spaced(setting: Setting, low: float, high: float, count: int, by_factor: bool = False) -> tuple[Any, ...]:
    """``count`` values from low to high, by equal steps or by equal factors; whole numbers where the
    setting is one, so that there can be fewer.

    raises : SettingError
    """
    name = ".".join(setting.path)
    if setting.bounds is None:
        raise SettingError(f"{name} is no number; name its values: {name}=V1,V2")
    if not 2 <= count <= MOST_VALUES:
        raise SettingError(f"{name}: {count} values are asked for; let it be 2 to {MOST_VALUES}")
    if not low < high:
        raise SettingError(f"{name}: the range goes from {low:g} to {high:g}; let it go up")
    if by_factor and low <= 0:
        raise SettingError(f"{name}: steps by a factor start above 0, not at {low:g}")
    steps = [step / (count - 1) for step in range(count)]
    if by_factor:
        values = [low * (high / low) ** step for step in steps]
    else:
        values = [low + (high - low) * step for step in steps]
    short = [low, *(float(f"{value:.6g}") for value in values[1:-1]), high]
    return tuple(dict.fromkeys(round(value) if setting.whole else float(value) for value in short))


def looks_even_by_factor(values: tuple[Any, ...]) -> bool:
    """Whether numbers are told apart better on a logarithmic axis."""
    low, high = min(values), max(values)
    return low > 0 and log(high / low) > log(20)


def intensity_and_spread(method: str, config: Any, cell: float, seeds: tuple[int, ...] = SEEDS) -> SweepPlan:
    """Fig. 13: eq. (23) over I_a × Σ_a; ``cell`` is the edge of a cell in metres."""
    bounds = next(setting.bounds for setting in settings_of(config) if setting.path == SPREAD)
    assert bounds is not None
    spreads = (in_metres(squared, cell) for squared in SQUARED_CELLS)
    x = SweepAxis(SPREAD, tuple(spread for spread in spreads if bounds.low <= spread <= bounds.high))
    return SweepPlan(method, config, x, SweepAxis(INTENSITY, INTENSITIES), seeds)


def particles(method: str, config: Any, seeds: tuple[int, ...] = SEEDS) -> SweepPlan:
    """Fig. 14: eq. (23) and time over the number of particles."""
    return SweepPlan(method, config, SweepAxis(PARTICLES, PARTICLE_COUNTS), None, seeds)


def in_metres(squared_cells: float, cell: float) -> float:
    """A Σ_a of so many squared cells as our spread, a standard deviation."""
    return float(f"{sqrt(squared_cells) * cell:.4g}")


def _values(text: str, setting: Setting, name: str) -> tuple[Any, ...]:
    words = [word.strip() for word in text.split(":")]
    if setting.bounds is not None and len(words) in (3, 4):
        if words[3:] not in ([], ["log"]) or not words[2].isdecimal():
            raise SettingError(f"{name}={text} is no range; write {GRAMMAR}")
        low, high = (_number(word, setting, name) for word in words[:2])
        return spaced(setting, low, high, int(words[2]), by_factor=bool(words[3:]))
    values = tuple(dict.fromkeys(_value(word.strip(), setting, name) for word in text.split(",")))
    if len(values) > MOST_VALUES:
        raise SettingError(f"{name}: {len(values)} values are too many; let it be {MOST_VALUES} at most")
    return values


def _value(word: str, setting: Setting, name: str) -> Any:
    if setting.bounds is not None:
        return _number(word, setting, name)
    options = {"yes": True, "no": False} if setting.choices is None else setting.options
    if word not in options:
        raise SettingError(f"{name}: {word or 'nothing'} is none of {', '.join(options)}")
    return options[word]


def _number(word: str, setting: Setting, name: str) -> Any:
    try:
        value = float(word)
    except ValueError:
        value = float("nan")
    if not isfinite(value):
        raise SettingError(f"{name}: {word or 'nothing'} is no number; write {GRAMMAR}")
    if setting.whole and value != round(value):
        raise SettingError(f"{name}: {word} is no whole number")
    return round(value) if setting.whole else value
