"""Transforms with their covariances, one after the other: T_a_c = T_a_b T_b_c, to first order."""

from __future__ import annotations

from dataclasses import dataclass
from math import cos, sin

import numpy as np

from algorithms.common.pose import FloatArray, Pose2, wrap_angle


@dataclass(frozen=True, eq=False)
class UncertainTransform:
    """A transform and the (3, 3) covariance of its x, y, theta; metres, radians."""

    T: Pose2
    covariance: FloatArray

    def then(self, other: UncertainTransform) -> UncertainTransform:
        """T_a_c of this T_a_b and another's T_b_c; their errors are independent."""
        c, s = cos(self.T.theta), sin(self.T.theta)
        x, y = other.T.x, other.T.y
        first = np.array([[1.0, 0.0, -s * x - c * y], [0.0, 1.0, c * x - s * y], [0.0, 0.0, 1.0]])
        second = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
        covariance = first @ self.covariance @ first.T + second @ other.covariance @ second.T
        return UncertainTransform(self.T @ other.T, covariance)

    def inverse(self) -> UncertainTransform:
        """T_b_a of this T_a_b."""
        T, c, s = self.T, cos(self.T.theta), sin(self.T.theta)
        # x' = −(c x + s y), y' = s x − c y, theta' = −theta
        jacobian = np.array([[-c, -s, s * T.x - c * T.y], [s, -c, c * T.x + s * T.y], [0.0, 0.0, -1.0]])
        return UncertainTransform(T.inverse(), jacobian @ self.covariance @ jacobian.T)

    def loosened(self, pivot: FloatArray, distance: float, angle: float) -> UncertainTransform:
        """With so much more error, independent of the rest: where it puts a point of b, and of its turn.

        pivot           : (2,) metres, in b
        distance, angle : standard deviations; metres, radians
        """
        c, s = cos(self.T.theta), sin(self.T.theta)
        x, y = pivot.tolist()
        lever = np.array([s * x + c * y, -c * x + s * y])  # what a turn about the pivot does to the origin
        more = np.diag([distance**2, distance**2, angle**2])
        more[:2, 2] = more[2, :2] = lever * angle**2
        more[:2, :2] += np.outer(lever, lever) * angle**2
        return UncertainTransform(self.T, self.covariance + more)

    def difference(self, other: UncertainTransform) -> tuple[FloatArray, FloatArray]:
        """(3,) other less this one, x, y, theta, and its (3, 3) covariance."""
        off = other.T.array() - self.T.array()
        off[2] = wrap_angle(float(off[2]))
        return off, self.covariance + other.covariance


EXACT = UncertainTransform(Pose2(), np.zeros((3, 3)))
