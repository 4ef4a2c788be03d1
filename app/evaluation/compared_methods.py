"""What stands in a comparison: each method with all that is known of a pair, or without it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from algorithms.methods.registry import METHODS, Family


@dataclass(frozen=True)
class ComparedMethod:
    """A row of a comparison, a card of the page.

    method   : its name in METHODS
    title    : what a person reads
    informed : whether it is told what is known; without, it has the walls alone
    """

    method: str
    title: str
    informed: bool = True

    @property
    def family(self) -> Family:
        return METHODS[self.method].family

    @property
    def defaults(self) -> Any:
        """The settings that it has unless others are given."""
        return METHODS[self.method].defaults


def _rows() -> dict[str, ComparedMethod]:
    """Every method, and once more without knowledge those that use it and need none."""
    rows = {}
    for name, method in METHODS.items():
        rows[name] = ComparedMethod(name, method.title)
        if method.uses_observation and not method.needs_sighting:
            title = f"{method.title.split(',')[0]}, walls alone"
            rows[f"{name}-walls-alone"] = ComparedMethod(name, title, informed=False)
    return rows


COMPARED = _rows()
"""By the names that they have in tables and files."""
