"""Search boxes: what the observation leaves of the shift, eqs. (6)–(10), and the margins (18)–(20)."""

from __future__ import annotations

from dataclasses import dataclass
from math import hypot, pi
from typing import Annotated

import numpy as np

from algorithms.bounds import Bounds, check_bounds
from algorithms.observation import Encounter
from algorithms.pose import FloatArray, Pose2


@dataclass(frozen=True)
class WindowConfig:
    """Margin of the paper's window, eqs. (9), (10)."""

    margin: Annotated[float, Bounds(0, 10, 0.05, "m", "σ", "window margin")] = 0.5
    """Added on every side of the shift window for the error of the range measurement."""

    def __post_init__(self) -> None:
        check_bounds(self)


@dataclass(frozen=True)
class BoxConfig:
    """Half-widths of the optimiser's box around a candidate, eqs. (18)–(20)."""

    sigma_x: Annotated[float, Bounds(0.05, 5, 0.05, "m", "σ_x", "margin in x")] = 1.0
    """Half-width of the optimiser's box in x. Wider finds more and takes longer."""
    sigma_y: Annotated[float, Bounds(0.05, 5, 0.05, "m", "σ_y", "margin in y")] = 1.0
    """Half-width of the optimiser's box in y. Wider finds more and takes longer."""
    sigma_theta: Annotated[float, Bounds(0.5, 45, 0.5, "°", "σ_θ", "margin in angle")] = 5.0
    """Half-width of the optimiser's box in the turn."""

    def __post_init__(self) -> None:
        check_bounds(self)


@dataclass(frozen=True)
class Window:
    """The shifts that the observation allows, whatever the turn; metres, ref frame."""

    x_low: float
    x_high: float
    y_low: float
    y_high: float


@dataclass(frozen=True, eq=False)
class Box:
    """An axis-parallel box of poses around a centre; the turn is kept unwrapped inside it.

    low, high : (3,) x, y, theta; metres, metres, radians
    """

    low: FloatArray
    high: FloatArray

    @property
    def centre(self) -> FloatArray:
        """(3,) middle of the box; metres, metres, radians."""
        return np.asarray((self.low + self.high) / 2, dtype=np.float64)


def paper_window(at: Encounter, margin: float) -> Window:
    """Shift window of eqs. (6)–(10) around x̂1, half as wide as x̂2 lies from its origin; metres.

    ‖·‖ in (6) is the Euclidean norm: the turned vector's component can reach it, so the
    component-wise absolute value the print may be read as would cut the truth off.
    """
    reach = hypot(*at.x_mov.tolist()) + margin  # eqs. (6), (9), (10)
    x, y = at.x_ref.tolist()
    return Window(x - reach, x + reach, y - reach, y + reach)  # eqs. (7), (8)


def box_around(T_ref_mov: Pose2, config: BoxConfig) -> Box:
    """The optimiser's box, eqs. (18)–(20)."""
    half = np.array([config.sigma_x, config.sigma_y, config.sigma_theta * pi / 180])
    centre = T_ref_mov.array()
    return Box(centre - half, centre + half)
