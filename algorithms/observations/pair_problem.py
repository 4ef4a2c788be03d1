"""What a merge of two maps begins with: the maps, and the sightings between their makers."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from math import hypot

import numpy as np

from algorithms.common.errors import SettingError
from algorithms.maps.grid_map import GridMap
from algorithms.maps.robots import Robots
from algorithms.observations.observation import Encounter, Observation, encounters_of, name_of, robots_of

OFF_THE_MAP = 5.0  # metres


@dataclass(frozen=True)
class PairProblem:
    """Two maps and the sightings between their makers; equal where the maps are the same objects and the
    sightings are equal.

    ref, mov     : the observer's map, and that of the robot it saw
    observations : one sighting or several
    raises       : SettingError where there is no observation, or where a robot stands far off the map it has
                   made itself. A map may have been cropped, so some metres are let pass; more is a mix-up of
                   files or of units
    """

    ref: GridMap
    mov: GridMap
    observations: tuple[Observation, ...]

    @staticmethod
    def of(ref: GridMap, mov: GridMap, seen: Observation | Sequence[Observation]) -> PairProblem:
        """The same of a single observation, or of any sequence of them."""
        return PairProblem(ref, mov, (seen,) if isinstance(seen, Observation) else tuple(seen))

    def __post_init__(self) -> None:
        if not self.observations:
            raise SettingError("there is no observation; give at least one")
        for number, o in enumerate(self.observations, 1):
            for who, key, point, grid in (
                ("robot 1", "observer.pose", o.observer.xy, self.ref),
                ("robot 2", "observed.pose", np.array([o.observed_x, o.observed_y]), self.mov),
            ):
                col, row = grid.grid_coordinates(point).tolist()
                beside, above = max(0.0, -col, col - grid.width), max(0.0, -row, row - grid.height)
                off = grid.resolution * hypot(beside, above)
                if off > OFF_THE_MAP:
                    raise SettingError(
                        f"{name_of(number, self.observations)} puts {who} at ({point[0]:g}, {point[1]:g}) m, "
                        f"{off:.1f} m outside its own map {grid.name!r}; check {key}, the map's origin and "
                        "resolution, and whether the two maps are swapped"
                    )

    @cached_property
    def encounters(self) -> tuple[Encounter, ...]:
        """Where robot 2 was seen, in both maps; a place per sighting."""
        return encounters_of(self.observations, self.ref, self.mov)

    def robots(self, size: float) -> Robots:
        """Where the robots stood; around them, within ``size`` metres, a map shows the robot and no wall."""
        return robots_of(self.encounters, size)
