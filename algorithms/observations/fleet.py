"""Robots that never agreed on a frame: their maps by name, who saw whom, and what else is known of two."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from algorithms.common.errors import SettingError
from algorithms.common.robot_names import check_name
from algorithms.maps.grid_map import GridMap
from algorithms.observations.observation import Observation
from algorithms.observations.priors import Prior

MOST_ROBOTS = 50
MOST_SIGHTINGS = 1000
MOST_PRIORS = 200


@dataclass(frozen=True)
class FleetSighting:
    """One robot saw another: names, and the observation in the frames of their two maps."""

    observer: str
    observed: str
    observation: Observation


@dataclass(frozen=True)
class FleetPrior:
    """What is roughly known of how the map of robot ``mov`` lies in that of robot ``ref``, by name."""

    ref: str
    mov: str
    prior: Prior


@dataclass(frozen=True, eq=False)
class Fleet:
    """What there is to be merged.

    maps      : by the robot's name
    sightings : of one robot by another; any number, in either direction
    priors    : what else is known of two of them
    anchor    : whose frame the result is in
    raises    : SettingError where there are fewer than two robots or too many, or one of a name that it
                cannot have, or where a sighting, a prior or the anchor names a robot that has no map, or one
                robot for both
    """

    maps: Mapping[str, GridMap]
    sightings: tuple[FleetSighting, ...] = ()
    priors: tuple[FleetPrior, ...] = ()
    anchor: str = ""

    def __post_init__(self) -> None:
        if not 2 <= len(self.maps) <= MOST_ROBOTS:
            raise SettingError(f"a fleet has 2 to {MOST_ROBOTS} robots, not {len(self.maps)}")
        for name in self.maps:
            check_name(name)
        if len(self.sightings) > MOST_SIGHTINGS:
            raise SettingError(f"a fleet has at most {MOST_SIGHTINGS} sightings, not {len(self.sightings)}")
        if len(self.priors) > MOST_PRIORS:
            found = f"not {len(self.priors)}"
            raise SettingError(f"at most {MOST_PRIORS} things are known of a fleet beside sightings, {found}")
        if not self.anchor:
            object.__setattr__(self, "anchor", next(iter(self.maps)))
        named = [("anchor", self.anchor)]
        for number, seen in enumerate(self.sightings, 1):
            named += [(f"sighting {number}", seen.observer), (f"sighting {number}", seen.observed)]
            if seen.observer == seen.observed:
                raise SettingError(f"sighting {number}: {seen.observer} cannot have seen itself")
        for number, told in enumerate(self.priors, 1):
            named += [(f"known {number}", told.ref), (f"known {number}", told.mov)]
            if told.ref == told.mov:
                raise SettingError(f"known {number}: {told.ref} is named twice; it takes two robots")
        for where, name in named:
            if name not in self.maps:
                robots = ", ".join(list(self.maps)[:8]) + (", …" if len(self.maps) > 8 else "")
                raise SettingError(f"{where} names {name!r}, which is no robot; there are {robots}")
