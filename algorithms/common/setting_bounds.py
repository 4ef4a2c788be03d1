"""Legal range, step, unit and symbol of a setting: the slider, the flag and the check read the same."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, fields
from typing import Any, get_type_hints

from algorithms.common.errors import SettingError


@dataclass(frozen=True)
class Bounds:
    """What a numeric field of a config may hold; goes into its ``Annotated`` type."""

    low: float
    high: float
    step: float
    unit: str = ""  # as shown to a person: "m", "°", "cells"; empty for a pure number
    symbol: str = ""  # as printed in the paper: "Σ_aug"
    label: str = ""  # the words beside the symbol: "spread"


def bounds_of(config_type: Any) -> Iterator[tuple[str, Bounds]]:
    """Yield (field name, Bounds) of a config dataclass, in the order of its fields."""
    hints = get_type_hints(config_type, include_extras=True)
    for field in fields(config_type):
        for extra in getattr(hints[field.name], "__metadata__", ()):
            if isinstance(extra, Bounds):
                yield field.name, extra


@dataclass(frozen=True)
class CheckedConfig:
    """Settings of a stage; raises SettingError where a number lies outside its Bounds."""

    def __post_init__(self) -> None:
        for name, bounds in bounds_of(type(self)):
            value = getattr(self, name)
            if isinstance(value, bool) or not isinstance(value, (int, float)):
                raise SettingError(f"{type(self).__name__}.{name} is {value!r}; it must be a number")
            if not (math.isfinite(value) and bounds.low <= value <= bounds.high):
                unit = f" {bounds.unit}" if bounds.unit else ""
                raise SettingError(
                    f"{type(self).__name__}.{name} is {value:g}{unit}; "
                    f"it must lie in [{bounds.low:g}, {bounds.high:g}]{unit}"
                )
