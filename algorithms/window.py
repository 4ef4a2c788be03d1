"""Search boxes: what the observation leaves of the shift, eqs. (6)–(10), and the margins (18)–(20)."""

from __future__ import annotations

from dataclasses import dataclass
from math import hypot, pi
from typing import Annotated, Literal

import numpy as np

from algorithms.bounds import Bounds, check_bounds
from algorithms.observation import Encounter
from algorithms.pose import FloatArray, Pose2


@dataclass(frozen=True)
class WindowConfig:
    """The paper's window for the shift, eqs. (6)–(10)."""

    margin: Annotated[float, Bounds(0, 10, 0.05, "m", "σ", "window margin")] = 0.1
    """Added on every side of the window for what the sighting's own deviations do not tell: how well
    each robot knew where it stood, and how well its map fits there."""
    deviations: Annotated[float, Bounds(0, 10, 0.5, "σ", "k", "sighting deviations")] = 3.0
    """Added on every side of the window: so many standard deviations of the range and the bearing."""
    pivot: Literal["encounter", "origin"] = "encounter"
    """Which point of map 2 the shift is the shift of. Encounter: the seen robot; the window is then
    as small as the sighting is good. Origin: map 2's origin, as printed; the window then grows with
    the distance between that origin and the seen robot, which says nothing about the world."""

    def __post_init__(self) -> None:
        check_bounds(self)


@dataclass(frozen=True)
class BoxConfig:
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

    def __post_init__(self) -> None:
        check_bounds(self)


@dataclass(frozen=True, eq=False)
class Window:
    """Where T may put the pivot, whatever the turn.

    low, high : (2,) x, y; metres, ref frame. With the pivot at the mov frame's origin these are the
                bounds of (Δx, Δy)
    pivot     : (2,) metres, mov frame
    """

    low: FloatArray
    high: FloatArray
    pivot: FloatArray


@dataclass(frozen=True, eq=False)
class Box:
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
        c, s = np.cos(poses[:, 2]), np.sin(poses[:, 2])
        x, y = self.pivot
        return np.column_stack([poses[:, 0] - c * x + s * y, poses[:, 1] - s * x - c * y, poses[:, 2]])

    def transform(self, pose: FloatArray) -> Pose2:
        """T_ref_mov from (3,) coordinates in the box, its angle wrapped."""
        return Pose2.from_array(self.transforms(pose[None])[0])


def paper_window(at: Encounter, config: WindowConfig) -> Window:
    """Shift window of eqs. (6)–(10): around x̂1, half as wide as x̂2 lies from the pivot, plus σ.

    ‖·‖ in (6) is the Euclidean norm: the turned vector's component can reach it, so the
    component-wise absolute value the print may be read as would cut the truth off.
    """
    pivot = at.x_mov if config.pivot == "encounter" else np.zeros(2)
    sigma = config.margin + config.deviations * np.sqrt(np.diag(at.covariance))
    reach = hypot(*(at.x_mov - pivot).tolist()) + sigma  # eqs. (6), (9), (10)
    return Window(at.x_ref - reach, at.x_ref + reach, pivot)  # eqs. (7), (8)


def box_around(T_ref_mov: Pose2, window: Window, config: BoxConfig) -> Box:
    """The optimiser's box, eqs. (18)–(20): around a candidate, inside the window (Fig. 11)."""
    half = np.array([config.sigma_x, config.sigma_y, config.sigma_theta * pi / 180])
    centre = np.append(T_ref_mov.apply(window.pivot), T_ref_mov.theta)
    low, high = centre - half, centre + half
    # the candidate lies in the window, so what is left is never empty
    low[:2], high[:2] = np.maximum(low[:2], window.low), np.minimum(high[:2], window.high)
    return Box(low, high, window.pivot)
