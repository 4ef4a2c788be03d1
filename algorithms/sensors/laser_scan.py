"""One turn of a laser scanner: ranges by bearing, as ROS's LaserScan holds them."""

from __future__ import annotations

from dataclasses import dataclass, field
from math import inf, isfinite, pi

import numpy as np

from algorithms.common.errors import SettingError
from algorithms.common.pose import FloatArray, Pose2

LEAST_BEAMS, MOST_BEAMS = 8, 100_000
SECOND_DIFFERENCE = 6**0.5  # what noise of one range becomes in r[i−1] − 2 r[i] + r[i+1]
MEDIAN_OF_NORMAL = 0.6745  # median of |z|, z normal with standard deviation 1
LEAST_NOISE = 0.002  # metres; no scanner of robots is better


@dataclass(frozen=True, eq=False)
class LaserScan:
    """What a scanner measured at one moment.

    angle_min       : bearing of the first beam from the scanner's axis; radians, counter-clockwise
    angle_increment : from beam to beam; radians, negative where the scanner turns clockwise
    ranges          : (N,) metres; NaN where a beam gave nothing useful, inf where nothing was within reach
    range_min, range_max : what the scanner can measure; metres
    mounting        : T_robot_laser; metres, radians
    raises          : SettingError
    """

    angle_min: float
    angle_increment: float
    ranges: FloatArray
    range_min: float = 0.0
    range_max: float = inf
    mounting: Pose2 = field(default_factory=Pose2)

    def __post_init__(self) -> None:
        n = len(self.ranges)
        if self.ranges.ndim != 1 or not LEAST_BEAMS <= n <= MOST_BEAMS:
            raise SettingError(f"the scan has {n} beams; it must have {LEAST_BEAMS} to {MOST_BEAMS:,}")
        if not (isfinite(self.angle_min) and isfinite(self.angle_increment) and self.angle_increment != 0):
            raise SettingError("the scan's angle_min and angle_increment must be finite, the second not 0")
        if abs(self.angle_increment) * (n - 1) > 2 * pi + 2 * abs(self.angle_increment):
            raise SettingError(
                f"the scan's {n} beams, {abs(self.angle_increment):g} rad apart, span more than a whole turn"
            )

    @property
    def angles(self) -> FloatArray:
        """(N,) bearings of the beams; radians, from the scanner's axis."""
        return np.asarray(self.angle_min + self.angle_increment * np.arange(len(self.ranges)))

    @property
    def valid(self) -> np.ndarray[tuple[int], np.dtype[np.bool_]]:
        """(N,) which beams hit something that the scanner can measure."""
        with np.errstate(invalid="ignore"):
            good = np.isfinite(self.ranges) & (self.ranges > max(self.range_min, 0.0))
            return np.asarray(good & (self.ranges < self.range_max))

    def points(self) -> FloatArray:
        """(N, 2) what the beams hit; metres, the robot's frame. NaN where they hit nothing."""
        ranges = np.where(self.valid, self.ranges, np.nan)
        angles = self.angles
        return self.mounting.apply(np.stack([ranges * np.cos(angles), ranges * np.sin(angles)], axis=1))

    def noise(self) -> float:
        """Standard deviation of one range, told from how ranges jump from beam to beam; metres.

        The median of second differences: flat and round things add nothing to it, and edges are few.
        """
        ranges = np.where(self.valid, self.ranges, np.nan)
        jumps = np.abs(ranges[:-2] - 2 * ranges[1:-1] + ranges[2:])
        jumps = jumps[np.isfinite(jumps)]
        if len(jumps) < LEAST_BEAMS:
            return LEAST_NOISE * 10
        return max(LEAST_NOISE, float(np.median(jumps)) / (SECOND_DIFFERENCE * MEDIAN_OF_NORMAL))
