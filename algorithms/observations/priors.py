"""What is known of a transform without a sighting: a rough pose, a rough turn, a place in both maps."""

from __future__ import annotations

from dataclasses import dataclass
from math import cos, degrees, hypot, isfinite, pi, radians, sin

import numpy as np

from algorithms.common.errors import SettingError
from algorithms.common.pose import FloatArray, Pose2, wrap_angles

SIGMA_XY = 1.0  # metres; a pose that a person remembers
SIGMA_YAW = radians(10)
SIGMAS_XY = (1e-3, 1000.0)  # metres; what a deviation may be
SIGMAS_YAW = (1e-3, pi)  # radians
NEAR_RADIUS = 2.0  # metres; "near the kitchen"
SPREADS_IN_RADIUS = 2.0  # standard deviations from the middle of a disc to its edge


@dataclass(frozen=True)
class InitialPose:
    """Where map 2's frame lies in map 1's, roughly: a Gaussian around T_ref_mov.

    pose : metres, metres, radians
    sigma_x, sigma_y, sigma_yaw : one standard deviation; metres, metres, radians
    about_x, about_y : of which point of map 2 sigma_x and sigma_y are told: its frame's origin, or another
           one where that lies far off the map and would sweep it about; metres, mov frame
    """

    pose: Pose2
    sigma_x: float = SIGMA_XY
    sigma_y: float = SIGMA_XY
    sigma_yaw: float = SIGMA_YAW
    about_x: float = 0.0
    about_y: float = 0.0

    def __post_init__(self) -> None:
        _check("initial", {"pose": self.pose.array().tolist(), "about": self.about.tolist()})
        _check_angle("initial: the yaw of pose", self.pose.theta)
        for name, value, limits, unit in (
            ("sigma_x", self.sigma_x, SIGMAS_XY, "m"),
            ("sigma_y", self.sigma_y, SIGMAS_XY, "m"),
            ("sigma_yaw", self.sigma_yaw, SIGMAS_YAW, "rad"),
        ):
            _check_sigma(f"initial: {name}", value, limits, unit)

    @property
    def sigmas(self) -> FloatArray:
        """(3,) standard deviations of x, y, yaw; metres, metres, radians."""
        return np.array([self.sigma_x, self.sigma_y, self.sigma_yaw])

    @property
    def about(self) -> FloatArray:
        """(2,) metres, mov frame."""
        return np.array([self.about_x, self.about_y])

    def deviations(self, poses: FloatArray) -> FloatArray:
        """(P,) standard deviations of (P, 3) x, y, theta of T_ref_mov from it."""
        off = poses - self.pose.array()
        c, s = np.cos(poses[:, 2]) - cos(self.pose.theta), np.sin(poses[:, 2]) - sin(self.pose.theta)
        off[:, 0] += c * self.about_x - s * self.about_y
        off[:, 1] += s * self.about_x + c * self.about_y
        off[:, 2] = wrap_angles(off[:, 2])
        return np.asarray(np.linalg.norm(off / self.sigmas, axis=1), dtype=np.float64)

    def inverse(self) -> InitialPose:
        """What it says of T_mov_ref, to first order; of two unlike deviations in x and y the larger one."""
        of_mov = self.pose.apply(self.about)
        sigma = max(self.sigma_x, self.sigma_y)
        return InitialPose(
            self.pose.inverse(), sigma, sigma, self.sigma_yaw, float(of_mov[0]), float(of_mov[1])
        )

    def slack(self, shift: float, turn: float, pivot: FloatArray) -> float:
        """Bound of how far the deviation changes where the pivot moves and turns by up to so much.

        shift, turn : metres, radians
        pivot       : (2,) metres, mov frame
        """
        moved = shift + turn * hypot(*(pivot - self.about).tolist())
        return hypot(moved / min(self.sigma_x, self.sigma_y), turn / self.sigma_yaw)


@dataclass(frozen=True)
class TurnPrior:
    """How map 2's frame is turned in map 1's, roughly: a Gaussian around the yaw of T_ref_mov.

    yaw, sigma : radians, counter-clockwise; one standard deviation
    """

    yaw: float
    sigma: float = SIGMA_YAW

    def __post_init__(self) -> None:
        _check("turn", {"yaw": [self.yaw]})
        _check_angle("turn: yaw", self.yaw)
        _check_sigma("turn: sigma", self.sigma, SIGMAS_YAW, "rad")

    def deviations(self, poses: FloatArray) -> FloatArray:
        """(P,) standard deviations of (P, 3) x, y, theta of T_ref_mov from it."""
        return np.asarray(np.abs(wrap_angles(poses[:, 2] - self.yaw)) / self.sigma, dtype=np.float64)

    def inverse(self) -> TurnPrior:
        """What it says of T_mov_ref."""
        return TurnPrior(-self.yaw, self.sigma)

    def slack(self, shift: float, turn: float, pivot: FloatArray) -> float:
        """Bound of how far the deviation changes; arguments as in ``InitialPose.slack``."""
        return turn / self.sigma


@dataclass(frozen=True)
class NearPlace:
    """A place in each map, and that they are one place, give or take a radius.

    ref_x, ref_y : metres, ref frame
    mov_x, mov_y : metres, mov frame
    radius       : metres; of the disc in which the one lies around the other
    """

    ref_x: float
    ref_y: float
    mov_x: float
    mov_y: float
    radius: float = NEAR_RADIUS

    def __post_init__(self) -> None:
        _check("near", {"map1": [self.ref_x, self.ref_y], "map2": [self.mov_x, self.mov_y]})
        _check_sigma("near: radius", self.radius, SIGMAS_XY, "m")

    def deviations(self, poses: FloatArray) -> FloatArray:
        """(P,) standard deviations of (P, 3) x, y, theta of T_ref_mov from it."""
        c, s = np.cos(poses[:, 2]), np.sin(poses[:, 2])
        x = c * self.mov_x - s * self.mov_y + poses[:, 0] - self.ref_x
        y = s * self.mov_x + c * self.mov_y + poses[:, 1] - self.ref_y
        return np.asarray(np.hypot(x, y) * (SPREADS_IN_RADIUS / self.radius), dtype=np.float64)

    def inverse(self) -> NearPlace:
        """What it says of T_mov_ref."""
        return NearPlace(self.mov_x, self.mov_y, self.ref_x, self.ref_y, self.radius)

    def slack(self, shift: float, turn: float, pivot: FloatArray) -> float:
        """Bound of how far the deviation changes; arguments as in ``InitialPose.slack``."""
        lever = hypot(self.mov_x - float(pivot[0]), self.mov_y - float(pivot[1]))
        return (shift + turn * lever) * SPREADS_IN_RADIUS / self.radius


Prior = InitialPose | TurnPrior | NearPlace


def _check(what: str, numbers: dict[str, list[float]]) -> None:
    for name, values in numbers.items():
        if not all(isfinite(value) for value in values):
            raise SettingError(f"{what}: {name} is {values}; it must be finite numbers")


def _check_angle(what: str, angle: float) -> None:
    if abs(angle) > 2 * pi:
        raise SettingError(
            f"{what} is {angle:g} rad, more than a whole turn; it looks like degrees: give radians, "
            f"{radians(angle):.4g} for {angle:g}°"
        )


def _check_sigma(what: str, value: float, limits: tuple[float, float], unit: str) -> None:
    low, high = limits
    if not (isfinite(value) and low <= value <= high):
        hint = ""
        if unit == "rad" and value > high and degrees(high) >= value:
            hint = f"; it looks like degrees: give radians, {radians(value):.4g} for {value:g}°"
        raise SettingError(f"{what} is {value:g} {unit}; it must be {low:g} to {high:.5g} {unit}{hint}")
