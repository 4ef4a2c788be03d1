"""The outline of a robot on the floor, as a laser meets it."""

from __future__ import annotations

from dataclasses import dataclass
from math import hypot, isfinite, pi

from algorithms.common.errors import SettingError

SIZES = (0.05, 5.0)  # metres; what a side or a diameter may be


@dataclass(frozen=True)
class Footprint:
    """A disc or a rectangle around the robot's centre.

    length, width : of the rectangle, both the diameter of a disc; metres
    round         : whether it is a disc
    raises        : SettingError
    """

    length: float = 0.46  # of the robots of sample_maps
    width: float = 0.40
    round: bool = False

    def __post_init__(self) -> None:
        for side in (self.length, self.width):
            if not (isfinite(side) and SIZES[0] <= side <= SIZES[1]):
                raise SettingError(
                    f"the robot's size is {side:g} m; it must be {SIZES[0]:g} to {SIZES[1]:g} m"
                )

    @staticmethod
    def disc(radius: float) -> Footprint:
        """A round robot; metres."""
        return Footprint(2 * radius, 2 * radius, True)

    @property
    def area(self) -> float:
        """m²."""
        return pi * self.length * self.width / 4 if self.round else self.length * self.width

    @property
    def narrowest(self) -> float:
        """The least width it can show; metres."""
        return min(self.length, self.width)

    @property
    def widest(self) -> float:
        """The greatest width it can show: a rectangle's diagonal; metres."""
        return self.length if self.round else hypot(self.length, self.width)

    def depth(self, shown: float) -> float:
        """How far the centre lies behind the mean of the surface that is seen, for a width that is shown.

        Of every outline that is symmetric about its centre, half of the area lies between the line across
        the centre and the surface seen: area / (2 · width), whichever way it is turned; metres.
        """
        return self.area / (2 * shown)
