"""The table of buildings: a seed makes a building of a kind."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from algorithms.common.errors import SettingError
from algorithms.simulator.buildings.apartment import apartment, home
from algorithms.simulator.buildings.corridor import corridor
from algorithms.simulator.buildings.floor_plan import Building
from algorithms.simulator.buildings.office import office, university
from algorithms.simulator.buildings.warehouse import warehouse
from algorithms.simulator.portable_random import stream

Draw = Callable[[np.random.Generator, np.random.Generator], Building]

BUILDINGS: dict[str, Draw] = {
    "office": office,
    "apartment": apartment,
    "warehouse": warehouse,
    "corridor": corridor,
    "home": home,
    "university": university,
}
"""Each draws a floor from two streams: what its floors have in common, and what is this floor's own."""


def build(kind: str, seed: int, floor: int = 0) -> Building:
    """The building of a kind and a seed; the same one every time.

    kind  : a key of BUILDINGS
    floor : another floor has the same outer walls and corridors, but other rooms
    raises SettingError for a kind that is not there
    """
    if kind not in BUILDINGS:
        raise SettingError(f"no building is called {kind!r}; choose one of {', '.join(BUILDINGS)}")
    shell = stream(seed, kind, "building")
    return BUILDINGS[kind](shell, stream(seed, kind, f"floor {floor}") if floor else shell)
