"""The table of buildings: a seed makes a building of a kind."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from algorithms.errors import SettingError
from algorithms.simulator.apartment import apartment
from algorithms.simulator.canvas import Building
from algorithms.simulator.dice import stream
from algorithms.simulator.halls import corridor, warehouse
from algorithms.simulator.office import campus, office

__all__ = [
    "BUILDINGS",
    "Building",
    "apartment",
    "build",
    "campus",
    "corridor",
    "office",
    "warehouse",
]

BUILDINGS: dict[str, Callable[[np.random.Generator], Building]] = {
    "office": office,
    "apartment": apartment,
    "warehouse": warehouse,
    "corridor": corridor,
}


def build(kind: str, seed: int) -> Building:
    """The building of a kind and a seed; the same one every time.

    kind : a key of BUILDINGS
    raises SettingError for a kind that is not there
    """
    if kind not in BUILDINGS:
        raise SettingError(f"no building is called {kind!r}; choose one of {', '.join(BUILDINGS)}")
    return BUILDINGS[kind](stream(seed, kind, "building"))
