"""A sighting as it is being placed by hand: what is known of it so far."""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import atan2, cos, hypot, radians, sin
from typing import Literal

from algorithms.common.pose import Pose2, wrap_angle
from algorithms.observations.observation import Observation

# standard deviations of a robot that a person places, until they say otherwise; metres, radians
PLACED_RANGE, PLACED_BEARING = 0.3, radians(5)

Part = Literal["observer", "seen", "observed"]
Point = tuple[float, float]

IN_BOTH = ("observer", "range", "bearing", "sigma_range", "sigma_bearing", "bearing_back")
"""Fields that a draft and an observation share."""


@dataclass(frozen=True)
class ObservationDraft:
    """An Observation of which parts may be missing; range and bearing follow what is placed.

    observer       : robot 1 in map 1
    range, bearing : of robot 2 from robot 1; metres, radians from its heading
    observed       : robot 2 in map 2; metres
    heading        : of robot 2 in map 2; radians, None where it is not known
    """

    observer: Pose2 | None = None
    range: float | None = None
    bearing: float | None = None
    observed: Point | None = None
    heading: float | None = None
    sigma_range: float = PLACED_RANGE
    sigma_bearing: float = PLACED_BEARING
    bearing_back: float | None = None

    @staticmethod
    def of(o: Observation) -> ObservationDraft:
        """The draft that makes just this observation."""
        same = {name: getattr(o, name) for name in IN_BOTH}
        return ObservationDraft(**same, observed=(o.observed_x, o.observed_y), heading=o.observed_heading)

    @property
    def missing(self) -> Part | None:
        """What is to be placed next; None where nothing is missing."""
        if self.observer is None:
            return "observer"
        if self.seen is None:
            return "seen"
        return "observed" if self.observed is None else None

    @property
    def seen(self) -> Point | None:
        """Where robot 1 saw robot 2, in map 1; metres."""
        if self.observer is None or self.range is None or self.bearing is None:
            return None
        direction = self.observer.theta + self.bearing
        return self.observer.x + self.range * cos(direction), self.observer.y + self.range * sin(direction)

    @property
    def observation(self) -> Observation | None:
        """The observation; None while something is missing. Raises SettingError where it cannot be."""
        if self.observer is None or self.range is None or self.bearing is None or self.observed is None:
            return None
        x, y = self.observed
        same = {name: getattr(self, name) for name in IN_BOTH}
        return Observation(**same, observed_x=x, observed_y=y, observed_heading=self.heading)

    def stood(self, observer: Pose2) -> ObservationDraft:
        """Robot 1 stood there; what it saw stays where it is in the map."""
        seen, moved = self.seen, replace(self, observer=observer)
        return moved if seen is None else moved.saw(seen)

    def saw(self, point: Point) -> ObservationDraft:
        """Robot 1 saw robot 2 there, in map 1; it must have stood somewhere already."""
        assert self.observer is not None
        dx, dy = point[0] - self.observer.x, point[1] - self.observer.y
        bearing = wrap_angle(atan2(dy, dx) - self.observer.theta)
        return replace(self, range=hypot(dx, dy), bearing=bearing)

    def typed(self, field: str, value: float) -> ObservationDraft:
        """One number was typed; metres, radians. ``field`` as in ``observation_panel.fields_of``."""
        if self.observer is not None and field in ("x1", "y1", "turn1"):
            name = {"x1": "x", "y1": "y", "turn1": "theta"}[field]
            return self.stood(replace(self.observer, **{name: value}))
        if self.observed is not None and field in ("x2", "y2"):
            x, y = self.observed
            return replace(self, observed=(value, y) if field == "x2" else (x, value))
        name = "heading" if field == "turn2" else field
        return replace(self, **{name: value})

    def was(self, point: Point, heading: float | None) -> ObservationDraft:
        """Robot 2 was there, in map 2."""
        return replace(self, observed=point, heading=heading)
