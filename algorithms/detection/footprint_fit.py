"""How well a robot's outline, put somewhere, explains the beams around it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from algorithms.common.parallel_kernels import kernel
from algorithms.common.pose import FloatArray
from algorithms.detection.footprint import Footprint

ON_ROBOT, PAST_ROBOT = 0, 1
UNLIKELY = 0.01  # how likely a beam does what the outline does not explain: it grazed an edge, or is noise
FARTHEST = 4.0  # standard deviations of a range, beyond which it counts as one of those


@dataclass(frozen=True, eq=False)
class BeamsAround:
    """The beams near a robot, in the laser's frame.

    directions : (B, 2) unit vectors
    ranges     : (B,) metres; inf where nothing was within reach
    kinds      : (B,) uint8: ON_ROBOT for a beam that ended on it, PAST_ROBOT for one that went by
    noise      : standard deviation of one range; metres
    """

    directions: FloatArray
    ranges: FloatArray
    kinds: NDArray[np.uint8]
    noise: float

    def likelihoods(self, poses: FloatArray, body: Footprint, slack: float = 0.0) -> FloatArray:
        """(K,) log-likelihood of these beams for a robot at each of (K, 3) poses x, y, heading.

        slack : standard deviation that the poses themselves add to a range; metres
        """
        sigma = float(np.hypot(self.noise, slack))
        return self._explain(poses, body, sigma)[0]

    def unexplained(self, pose: FloatArray, body: Footprint) -> float:
        """Share of the beams that this (3,) pose of the robot does not explain, 0 … 1."""
        return float(self._explain(pose[None], body, self.noise)[1][0]) / len(self.ranges)

    def _explain(
        self, poses: FloatArray, body: Footprint, sigma: float
    ) -> tuple[FloatArray, NDArray[np.int64]]:
        half = np.array([body.length / 2, body.width / 2])
        poses = np.ascontiguousarray(poses)
        return _explain(poses, self.directions, self.ranges, self.kinds, sigma, half, body.round)


@kernel
def _first_on_disc(x: float, y: float, dx: float, dy: float, radius: float) -> float:
    """Range of a beam from the origin to a disc at (x, y), inf where it misses; metres."""
    along = x * dx + y * dy
    missed = x * x + y * y - along * along
    if along <= 0 or missed > radius * radius:
        return np.inf
    return float(along - np.sqrt(radius * radius - missed))


@kernel
def _first_on_box(
    x: float, y: float, c: float, s: float, dx: float, dy: float, length: float, width: float
) -> float:
    """The same to a box of half sides ``length`` and ``width``, turned by an angle of cosine c, sine s."""
    from_x, from_y = -(x * c + y * s), -(y * c - x * s)
    to_x, to_y = dx * c + dy * s, dy * c - dx * s
    low, high = 0.0, np.inf
    for start, step, half in ((from_x, to_x, length), (from_y, to_y, width)):
        if abs(step) < 1e-12:
            if abs(start) > half:
                return np.inf
            continue
        enter, leave = (-half - start) / step, (half - start) / step
        if enter > leave:
            enter, leave = leave, enter
        low, high = max(low, enter), min(high, leave)
    return low if 0.0 < low <= high else np.inf


@kernel
def _explain(
    poses: FloatArray,
    directions: FloatArray,
    ranges: FloatArray,
    kinds: NDArray[np.uint8],
    sigma: float,
    half: FloatArray,
    is_round: bool,
) -> tuple[FloatArray, NDArray[np.int64]]:
    """Log-likelihood of the beams for each pose, and how many beams it does not explain."""
    total = np.zeros(len(poses))
    strange = np.zeros(len(poses), dtype=np.int64)
    odd = np.log(UNLIKELY)
    for k in range(len(poses)):
        x, y, turn = poses[k, 0], poses[k, 1], poses[k, 2]
        c, s = np.cos(turn), np.sin(turn)
        for b in range(len(ranges)):
            dx, dy = directions[b, 0], directions[b, 1]
            if is_round:
                hit = _first_on_disc(x, y, dx, dy, half[0])
            else:
                hit = _first_on_box(x, y, c, s, dx, dy, half[0], half[1])
            if kinds[b] == ON_ROBOT:
                z = (ranges[b] - hit) / sigma
                if abs(z) <= FARTHEST:  # false for a beam that misses
                    total[k] += np.log((1 - UNLIKELY) * np.exp(-0.5 * z * z) + UNLIKELY)
                else:
                    total[k] += odd
                    strange[k] += 1
            elif hit < ranges[b] - FARTHEST * sigma:  # it should have ended on the robot
                total[k] += odd
                strange[k] += 1
    return total, strange
