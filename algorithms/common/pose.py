"""Rigid motions of the plane: the map transformation matrix (MTM) of eq. (1) as a value."""

from __future__ import annotations

from dataclasses import dataclass
from math import atan2, cos, hypot, pi, remainder, sin
from typing import Any

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]


def wrap_angle(angle: float) -> float:
    """The same direction in (−π, π]; radians."""
    wrapped = remainder(angle, 2 * pi)
    return pi if wrapped == -pi else wrapped


def wrap_angles(angles: FloatArray) -> FloatArray:
    """``wrap_angle`` for an array of any shape; radians."""
    return np.asarray(np.pi - np.mod(np.pi - angles, 2 * np.pi), dtype=np.float64)


def rotation(angle: float) -> FloatArray:
    """C(angle): the (2, 2) matrix that turns column vectors counter-clockwise; radians."""
    c, s = cos(angle), sin(angle)
    return np.array([[c, -s], [s, c]])


@dataclass(frozen=True)
class Pose2:
    """Rigid motion of the plane, p_ref = C(theta) p_mov + (x, y). A variable of it is T_ref_mov.

    As a pose it is where a thing stands in the ref frame and which way it looks.
    """

    x: float = 0.0  # metres, ref frame
    y: float = 0.0  # metres, ref frame
    theta: float = 0.0  # radians, counter-clockwise

    @property
    def xy(self) -> FloatArray:
        """(2,) translation; metres, ref frame."""
        return np.array([self.x, self.y])

    def apply(self, points: FloatArray) -> FloatArray:
        """Take (N, 2) or (2,) points in the mov frame to the ref frame; metres."""
        return np.asarray(points @ rotation(self.theta).T + self.xy, dtype=np.float64)

    def inverse(self) -> Pose2:
        """T_mov_ref of T_ref_mov."""
        c, s = cos(self.theta), sin(self.theta)
        return Pose2(-(c * self.x + s * self.y), s * self.x - c * self.y, wrap_angle(-self.theta))

    def __matmul__(self, other: Pose2) -> Pose2:
        """Chain: T_a_b @ T_b_c is T_a_c."""
        c, s = cos(self.theta), sin(self.theta)
        return Pose2(
            self.x + c * other.x - s * other.y,
            self.y + s * other.x + c * other.y,
            wrap_angle(self.theta + other.theta),
        )

    def matrix(self) -> FloatArray:
        """The (3, 3) MTM, eq. (1)."""
        mtm = np.eye(3)
        mtm[:2, :2] = rotation(self.theta)
        mtm[:2, 2] = self.xy
        return mtm

    @staticmethod
    def from_matrix(mtm: FloatArray) -> Pose2:
        """The pose of a (3, 3) MTM, eq. (1); the inverse of ``matrix``."""
        return Pose2(float(mtm[0, 2]), float(mtm[1, 2]), atan2(mtm[1, 0], mtm[0, 0]))

    @staticmethod
    def from_array(pose: Any) -> Pose2:
        """The pose of three numbers x, y, theta (metres, metres, radians)."""
        x, y, theta = (float(value) for value in pose)
        return Pose2(x, y, wrap_angle(theta))

    def array(self) -> FloatArray:
        """(3,) x, y, theta; metres, metres, radians."""
        return np.array([self.x, self.y, self.theta])


def chord(angle: float) -> float:
    """How far a turn by so many radians moves a point at a distance of one."""
    return 2 * sin(min(angle, pi) / 2)


def pose_error(T_a: Pose2, T_b: Pose2, at_mov: FloatArray) -> tuple[float, float]:
    """How far two answers to one question lie apart.

    at_mov  : (2,) point of the mov frame where the distance is taken; the observed robot's position
    returns : (distance in metres between where the two put the point, angle in radians, both >= 0)
    """
    dx, dy = (T_a.apply(at_mov) - T_b.apply(at_mov)).tolist()
    return hypot(dx, dy), abs(wrap_angle(T_a.theta - T_b.theta))
