"""The box of transforms that an optimiser searches, eqs. (18)–(20), and its settings."""

from __future__ import annotations

from dataclasses import dataclass
from math import pi
from typing import Annotated

import numpy as np

from algorithms.common.pose import FloatArray, Pose2, rotation
from algorithms.common.setting_bounds import Bounds, CheckedConfig
from algorithms.observations.search_window import CoupledWindow, Window


@dataclass(frozen=True)
class BoxConfig(CheckedConfig):
    """Half-widths of the optimiser's box around a candidate, eqs. (18)–(20).

    The box never leaves the window, so wide margins cost nothing where the sighting is good; narrow
    ones shut the truth out where the X and Y spectra pick the wrong end of the window.
    """

    sigma_x: Annotated[float, Bounds(0.05, 5, 0.05, "m", "σ_x", "margin in x")] = 1.0
    """Half-width of the optimiser's box in x. Wider finds more and takes longer."""
    sigma_y: Annotated[float, Bounds(0.05, 5, 0.05, "m", "σ_y", "margin in y")] = 1.0
    """Half-width of the optimiser's box in y. Wider finds more and takes longer."""
    sigma_theta: Annotated[float, Bounds(0.5, 45, 0.5, "°", "σ_θ", "margin in angle")] = 5.0
    """Half-width of the optimiser's box in the turn."""


@dataclass(frozen=True, eq=False)
class SearchBox:
    """An axis-parallel box of transforms, written as where they put a pivot and how they turn.

    A transform has the coordinates (x, y, theta): it puts the pivot of the mov frame at (x, y) of the
    ref frame and turns by theta. With the pivot at the mov frame's origin these are the paper's
    (Δx, Δy, Δθ). With the pivot at x̂2 a turn leaves the encounter in place, however far away the mov
    frame has its origin: 1° at 30 m is half a metre of Δx.

    low, high : (3,) x, y, theta; metres, metres, radians; theta is kept unwrapped inside the box
    pivot     : (2,) metres, mov frame
    """

    low: FloatArray
    high: FloatArray
    pivot: FloatArray

    @property
    def centre(self) -> FloatArray:
        """(3,) middle of the box; metres, metres, radians."""
        return np.asarray((self.low + self.high) / 2, dtype=np.float64)

    def transforms(self, poses: FloatArray) -> FloatArray:
        """(P, 3) Δx, Δy, Δθ of T_ref_mov from (P, 3) coordinates in the box; theta stays unwrapped."""
        return transforms_about(self.pivot, poses)

    def transform(self, pose: FloatArray) -> Pose2:
        """T_ref_mov from (3,) coordinates in the box, its angle wrapped."""
        return Pose2.from_array(self.transforms(pose[None])[0])


def transforms_about(pivot: FloatArray, poses: FloatArray) -> FloatArray:
    """(P, 3) x, y, theta of T_ref_mov that put the (2,) pivot at x, y of (P, 3) poses and turn by theta."""
    c, s = np.cos(poses[:, 2]), np.sin(poses[:, 2])
    x, y = pivot
    return np.column_stack([poses[:, 0] - c * x + s * y, poses[:, 1] - s * x - c * y, poses[:, 2]])


def pose_about(pivot: FloatArray, T_ref_mov: Pose2) -> FloatArray:
    """(3,) where T_ref_mov puts the pivot, and its turn: the inverse of ``transforms_about``."""
    return np.append(T_ref_mov.apply(pivot), T_ref_mov.theta)


def shift_covariance(at_pivot: FloatArray, pivot: FloatArray, T_ref_mov: Pose2) -> FloatArray:
    """(3, 3) covariance of Δx, Δy, Δθ from that of where the pivot goes, and of the turn."""
    to_shift = np.eye(3)  # d (Δx, Δy, Δθ) / d (where the pivot goes, Δθ): Δ = that − C(Δθ) pivot
    to_shift[:2, 2] = -rotation(T_ref_mov.theta + pi / 2) @ pivot
    return np.asarray(to_shift @ at_pivot @ to_shift.T, dtype=np.float64)


def box_around(T_ref_mov: Pose2, window: Window | CoupledWindow, config: BoxConfig) -> SearchBox:
    """The optimiser's box, eqs. (18)–(20): around a candidate, inside the window (Fig. 11)."""
    half = np.array([config.sigma_x, config.sigma_y, config.sigma_theta * pi / 180])
    centre = pose_about(window.pivot, T_ref_mov)
    low, high = centre - half, centre + half
    low[:2] = np.minimum(np.maximum(low[:2], window.low), centre[:2])  # whatever is cut off, it holds the
    high[:2] = np.maximum(np.minimum(high[:2], window.high), centre[:2])  # candidate
    return SearchBox(low, high, window.pivot)
