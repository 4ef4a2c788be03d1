"""Robots that never agreed on a frame: their maps by name, and who saw whom."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from algorithms.common.errors import SettingError
from algorithms.maps.grid_map import GridMap
from algorithms.observations.observation import Observation
from algorithms.observations.priors import InitialPose

MOST_ROBOTS = 50
MOST_SIGHTINGS = 1000
LONGEST_NAME = 64  # letters of a robot's name
NAME_RULE = f"give 1 to {LONGEST_NAME} letters, without a slash"


def is_name(text: str) -> bool:
    """Whether a robot can be called so: it goes into names of frames, and is shown to people."""
    return 1 <= len(text) <= LONGEST_NAME and text.isprintable() and "/" not in text


@dataclass(frozen=True)
class FleetSighting:
    """One robot saw another: names, and the observation in the frames of their two maps."""

    observer: str
    observed: str
    observation: Observation


@dataclass(frozen=True, eq=False)
class Fleet:
    """What there is to be merged.

    maps      : by the robot's name
    sightings : of one robot by another; any number, in either direction
    known     : by name, where a robot's frame lies in the anchor's, roughly
    anchor    : whose frame the result is in
    raises    : SettingError where there are fewer than two robots or too many, or where a sighting, a known
                pose or the anchor names a robot that has no map, or a robot that sees itself
    """

    maps: Mapping[str, GridMap]
    sightings: tuple[FleetSighting, ...] = ()
    known: Mapping[str, InitialPose] = field(default_factory=dict)
    anchor: str = ""

    def __post_init__(self) -> None:
        if not 2 <= len(self.maps) <= MOST_ROBOTS:
            raise SettingError(f"a fleet has 2 to {MOST_ROBOTS} robots, not {len(self.maps)}")
        if len(self.sightings) > MOST_SIGHTINGS:
            raise SettingError(f"a fleet has at most {MOST_SIGHTINGS} sightings, not {len(self.sightings)}")
        if not self.anchor:
            object.__setattr__(self, "anchor", next(iter(self.maps)))
        named = [("anchor", self.anchor), *(("known", name) for name in self.known)]
        for number, seen in enumerate(self.sightings, 1):
            named += [(f"sighting {number}", seen.observer), (f"sighting {number}", seen.observed)]
            if seen.observer == seen.observed:
                raise SettingError(f"sighting {number}: {seen.observer} cannot have seen itself")
        for where, name in named:
            if name not in self.maps:
                robots = ", ".join(list(self.maps)[:8]) + (", …" if len(self.maps) > 8 else "")
                raise SettingError(f"{where} names {name!r}, which is no robot; there are {robots}")
