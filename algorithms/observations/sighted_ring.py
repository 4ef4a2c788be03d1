"""A vague sighting as what it is: a ring, or a piece of one, around the observer."""

from __future__ import annotations

from dataclasses import dataclass
from math import cos, exp, hypot, inf, pi

import numpy as np

from algorithms.common.pose import FloatArray, wrap_angles
from algorithms.observations.observation import Observation

STEEPEST = 1 + pi  # how much faster than the place itself the bearing's deviation changes at the observer


def is_curved(o: Observation, k: float) -> bool:
    """Whether within k standard deviations of its bearing the ring bends by more than its own thickness, so
    that an ellipse does not describe it.
    """
    return o.range * (1 - cos(min(pi, k * o.sigma_bearing))) > o.sigma_range


@dataclass(frozen=True)
class SightedRing:
    """Where a sighting puts robot 2, in range and bearing instead of x and y.

    margin : standard deviation of what range and bearing do not tell; metres
    most   : deviations from which on a place is of no interest
    """

    observation: Observation
    margin: float
    most: float = inf

    @property
    def _across(self) -> float:
        """What is not known across the bearing, however near the robots stood; metres."""
        o = self.observation
        return hypot(self.margin, o.sigma_range * exp(-0.5 * (o.range / o.sigma_range) ** 2))

    def deviations(self, poses: FloatArray) -> FloatArray:
        """(P,) standard deviations of (P, 3) x, y, theta of T_ref_mov from it."""
        o = self.observation
        c, s = np.cos(poses[:, 2]), np.sin(poses[:, 2])
        x = c * o.observed_x - s * o.observed_y + poses[:, 0] - o.observer.x
        y = s * o.observed_x + c * o.observed_y + poses[:, 1] - o.observer.y
        away = np.hypot(x, y)
        along = (away - o.range) / hypot(o.sigma_range, self.margin)
        off = wrap_angles(np.arctan2(y, x) - o.observer.theta - o.bearing)
        return np.hypot(along, off * away / np.hypot(o.sigma_bearing * away, self._across))

    def slack(self, shift: float, turn: float, pivot: FloatArray) -> float:
        """Bound of how far the deviation changes where the pivot moves and turns by up to so much, from or to
        a place of interest. All of those lie some way off the observer, where the bearing changes slowly.

        shift, turn : metres, radians
        pivot       : (2,) metres, mov frame
        """
        o = self.observation
        lever = hypot(o.observed_x - float(pivot[0]), o.observed_y - float(pivot[1]))
        moved = shift + turn * lever
        thick = hypot(o.sigma_range, self.margin)
        nearest = max(0.0, o.range - self.most * thick - moved)
        across = hypot(o.sigma_bearing * nearest, self._across)
        return hypot(moved / thick, STEEPEST * moved / across)
