"""One robot saw another once: what that says about the two maps, section III-A and eqs. (2), (3)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import cos, exp, hypot, isfinite, pi, sin

import numpy as np

from algorithms.common.errors import SettingError
from algorithms.common.pose import FloatArray, Pose2, rotation, wrap_angle
from algorithms.maps.grid_map import GridMap
from algorithms.maps.robots import Robots

SIGMA_RANGE = 0.05  # metres; a laser range taken from the mean of a few salient points
SIGMA_BEARING = 0.034907  # radians, 2°
SIGMA_RANGES = (1e-6, 100.0)  # metres; what a deviation may be
SIGMA_BEARINGS = (1e-6, pi)  # radians
MOST_RANGE = 1e5  # metres


@dataclass(frozen=True)
class Observation:
    """Robot R1 (observer, maker of the ref map) saw robot R2 (observed, maker of the mov map).

    With ``bearing_back`` the observation is bilateral: R2 saw R1 too.
    """

    observer: Pose2  # R1 in G1, the ref map's frame
    observed_x: float  # metres; R2 in G2, the mov map's frame
    observed_y: float  # metres; R2 in G2
    range: float  # metres; of R2 from R1
    bearing: float  # radians, counter-clockwise from R1's heading
    observed_heading: float | None = None  # radians, R2's in G2; the method does not need it
    sigma_range: float = SIGMA_RANGE  # metres, one standard deviation
    sigma_bearing: float = SIGMA_BEARING  # radians, one standard deviation
    bearing_back: float | None = None  # radians; R1 as R2 saw it, from R2's heading

    def __post_init__(self) -> None:
        numbers = {
            "observer.pose": self.observer.array().tolist(),
            "observed.pose": [self.observed_x, self.observed_y, self.observed_heading or 0.0],
            "range": [self.range],
            "bearing": [self.bearing],
            "sigma_range": [self.sigma_range],
            "sigma_bearing": [self.sigma_bearing],
            "bearing_back": [self.bearing_back or 0.0],
        }
        for name, values in numbers.items():
            if not all(isfinite(value) for value in values):
                raise SettingError(f"observation: {name} is {values}; it must be finite numbers")
        if self.range < 0:
            raise SettingError(f"observation: range is {self.range} m; it must not be negative")
        for name, bearing in (("bearing", self.bearing), ("bearing_back", self.bearing_back or 0.0)):
            if abs(bearing) > 2 * pi:
                raise SettingError(
                    f"observation: {name} is {bearing:g} rad, more than a whole turn; "
                    "it looks like degrees: give radians"
                )
        if self.sigma_range <= 0 or self.sigma_bearing <= 0:
            raise SettingError(
                f"observation: sigma_range is {self.sigma_range} m and sigma_bearing "
                f"{self.sigma_bearing} rad; both must be positive"
            )


def mirrored(o: Observation) -> Observation:
    """The same with map 2, and what robot 2 knows of itself in it, flipped: (x, y) becomes (−x, y)."""
    heading = None if o.observed_heading is None else wrap_angle(pi - o.observed_heading)
    back = None if o.bearing_back is None else -o.bearing_back
    return replace(o, observed_x=-o.observed_x, observed_heading=heading, bearing_back=back)


def name_of(number: int, observations: Sequence[Observation]) -> str:
    """What to call an observation before a person: with its number, from 1, where there are several."""
    return f"observation {number}" if len(observations) > 1 else "the observation"


@dataclass(frozen=True, eq=False)
class Encounter:
    """The place where R2 stood, in both frames: the one thing the two maps surely share.

    x_ref      : (2,) x̂1 in the ref frame; metres
    x_mov      : (2,) x̂2 in the mov frame; metres
    covariance : (2, 2) of x̂1 from range, bearing and the maps' cells, first order; m²
    observer   : (2,) P_R1 in the ref frame; metres; None where it is not known
    """

    x_ref: FloatArray
    x_mov: FloatArray
    covariance: FloatArray
    observer: FloatArray | None = None


def robots_of(encounters: Sequence[Encounter], size: float) -> Robots:
    observers = [at.observer for at in encounters if at.observer is not None]
    observed = [at.x_mov for at in encounters]
    return Robots(np.array(observers).reshape(-1, 2), np.array(observed).reshape(-1, 2), size)


def encounters_of(
    observations: Sequence[Observation], ref: GridMap | None, mov: GridMap | None
) -> tuple[Encounter, ...]:
    """The encounter of each observation, in these two maps; a map that is not there yet is exact."""
    cell = hypot(*(grid.resolution for grid in (ref, mov) if grid is not None))
    return tuple(encounter(observation, cell) for observation in observations)


def encounter(observation: Observation, cell: float = 0.0) -> Encounter:
    """x̂1 = P_R1 + C(φ1) R1_P_R2 and x̂2 = P_R2 (section III-B), with the covariance of x̂1.

    Where the range's own deviation reaches back to 0, the robots may have stood at one place, and then a
    bearing says nothing: the nearer to that, the more the range's deviation holds across, too. And a map
    knows its walls to a cell, so that robots stand among them no better than that.

    cell : edge of a square over which both maps' cells together spread a place evenly; metres
    """
    o = observation
    direction = o.observer.theta + o.bearing
    along = np.array([cos(direction), sin(direction)])
    across = rotation(pi / 2) @ along
    jacobian = np.column_stack([along, o.range * across])  # d x̂1 / d (r, β)
    covariance = jacobian @ np.diag([o.sigma_range**2, o.sigma_bearing**2]) @ jacobian.T
    at_one_place = exp(-0.5 * (o.range / o.sigma_range) ** 2)  # likelihood of range 0 over the likeliest
    covariance += np.outer(across, across) * (at_one_place * o.sigma_range) ** 2
    covariance += np.eye(2) * cell**2 / 12
    return Encounter(
        x_ref=o.observer.xy + o.range * along,
        x_mov=np.array([o.observed_x, o.observed_y]),
        covariance=covariance,
        observer=o.observer.xy,
    )


def bilateral_transform(observation: Observation) -> Pose2:
    """T_ref_mov of a bilateral observation, without looking at the maps.

    Δθ = φ1 − φ2 + θ with θ = ¹θ₂ − ²θ₁ − π, eq. (2): ¹θ₂ is the bearing of R2 from R1 and ²θ₁ of R1
    from R2 (the print drops the raised indices; read the other way round, the turn comes out
    mirrored, which a test with a known pose shows). The shift is eq. (3).

    raises SettingError where ``bearing_back`` or ``observed_heading`` is missing
    """
    o = observation
    if o.bearing_back is None or o.observed_heading is None:
        raise SettingError(
            "the bilateral method needs measurement.bearing_back and the yaw of observed.pose "
            "in the observation; without them choose a method for unilateral observations"
        )
    theta = o.bearing - o.bearing_back - pi
    turn = wrap_angle(o.observer.theta - o.observed_heading + theta)  # eq. (2)
    at = encounter(o)
    x, y = at.x_ref - rotation(turn) @ at.x_mov  # eq. (3)
    return Pose2(float(x), float(y), turn)


def bilateral_covariance(observation: Observation) -> FloatArray:
    """(3, 3) covariance of ``bilateral_transform`` from range and bearings, first order; m and rad.

    The bearing back is taken to be as good as the bearing.
    """
    o = observation
    T = bilateral_transform(o)
    at = encounter(o)
    direction = o.observer.theta + o.bearing
    lever = rotation(T.theta + pi / 2) @ at.x_mov  # d (C(Δθ) x̂2) / d Δθ
    jacobian = np.zeros((3, 3))  # of (Δx, Δy, Δθ) by (r, β, β_back)
    jacobian[:2, 0] = cos(direction), sin(direction)
    jacobian[:2, 1] = o.range * np.array([-sin(direction), cos(direction)]) - lever
    jacobian[:2, 2] = lever
    jacobian[2] = 0.0, 1.0, -1.0
    noise = np.diag([o.sigma_range**2, o.sigma_bearing**2, o.sigma_bearing**2])
    return np.asarray(jacobian @ noise @ jacobian.T, dtype=np.float64)
