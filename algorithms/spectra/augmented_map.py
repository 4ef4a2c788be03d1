"""Lift the walls near the robot that was seen: the augmented maps of section III-B, eqs. (4), (5)."""

from __future__ import annotations

from dataclasses import dataclass
from math import log, pi, sqrt
from typing import Annotated

import numpy as np

from algorithms.common.errors import SettingError
from algorithms.common.pose import FloatArray, rotation
from algorithms.common.setting_bounds import Bounds, CheckedConfig
from algorithms.maps.grid_map import GridMap

# Levels are summed in 32-bit floats, so what lies below 2^-24 of the peak can't change a sum. Such
# cells are left out: cost then grows with what was seen near the encounter, not with the building.
CUT_AT = sqrt(2 * 24 * log(2))  # in standard deviations, 5.77


@dataclass(frozen=True)
class AugmentConfig(CheckedConfig):
    """Settings of the augmentation, eq. (4)."""

    intensity: Annotated[float, Bounds(1, 1000, 1, "", "I_aug", "intensity")] = 100.0
    """Scales every level, and Γ with its square. It cannot move the best transform."""
    spread: Annotated[float, Bounds(0.2, 20, 0.1, "m", "σ_aug", "spread")] = 3.0
    """Standard deviation of the Gaussian around the seen robot. Small: only the walls beside the
    encounter count. Large: the whole of both maps counts."""
    aspect: Annotated[float, Bounds(0.2, 5, 0.1, "", "Σ_aug", "aspect")] = 1.0
    """Long axis over short axis of Σ_aug, its area kept. 1 is the paper's round Gaussian."""
    tilt: Annotated[float, Bounds(-90, 90, 1, "°", "Σ_aug", "tilt")] = 0.0
    """Direction of the long axis in each map's own frame; no effect while the aspect is 1."""

    def covariance(self) -> FloatArray:
        """Σ_aug: (2, 2); m²."""
        turn = rotation(np.deg2rad(self.tilt))
        axes = np.diag([self.aspect, 1 / self.aspect]) * self.spread**2
        return np.asarray(turn @ axes @ turn.T, dtype=np.float64)


@dataclass(frozen=True, eq=False)
class AugmentedMap:
    """An augmented map M^a in dual form: its occupied cells and their levels, eq. (5).

    grid    : the map it was made from
    points  : (N, 2) centres of the occupied cells that count; metres, the map's frame
    rows, cols : (N,) int, which cells of the grid they are
    levels  : (N,) float64 > 0, Aug(m) of eq. (4); 1/m² times I_aug
    x_hat   : (2,) where R2 stood; metres, the map's frame
    peak    : the level a wall at x_hat would have
    """

    grid: GridMap
    points: FloatArray
    rows: np.ndarray[tuple[int], np.dtype[np.intp]]
    cols: np.ndarray[tuple[int], np.dtype[np.intp]]
    levels: FloatArray
    x_hat: FloatArray
    peak: float


def augment(grid: GridMap, x_hat: FloatArray, sigma: FloatArray, intensity: float) -> AugmentedMap:
    """Give every occupied cell its level, eqs. (4) and (5).

    x_hat     : (2,) metres, the map's frame
    sigma     : (2, 2) Σ_aug, symmetric and positive definite; m²
    intensity : I_aug, any positive number
    raises SettingError where Σ_aug is not positive definite
    """
    determinant = float(np.linalg.det(sigma))
    if not (determinant > 0 and sigma[0, 0] > 0 and np.allclose(sigma, sigma.T)):
        raise SettingError(f"Σ_aug is {sigma.tolist()}; it must be symmetric, positive definite")
    peak = intensity / (2 * pi * sqrt(determinant))
    rows, cols = _window(grid, x_hat, CUT_AT * sqrt(float(np.linalg.eigvalsh(sigma)[-1])))
    points = grid.centres(rows, cols)
    offset = points - x_hat
    squared = np.einsum("ni,ij,nj->n", offset, np.linalg.inv(sigma), offset)
    near = squared <= CUT_AT**2
    return AugmentedMap(
        grid=grid,
        points=points[near],
        rows=rows[near],
        cols=cols[near],
        levels=peak * np.exp(-0.5 * squared[near]),  # eq. (4)
        x_hat=x_hat,
        peak=peak,
    )


def _window(
    grid: GridMap, x_hat: FloatArray, radius: float
) -> tuple[np.ndarray[tuple[int], np.dtype[np.intp]], np.ndarray[tuple[int], np.dtype[np.intp]]]:
    """Rows and columns of the occupied cells in the square of ``radius`` metres around x_hat."""
    col, row = grid.grid_coordinates(x_hat)
    reach = radius / grid.resolution + 1
    top, left = max(0, int(row - reach)), max(0, int(col - reach))
    bottom, right = max(0, int(row + reach) + 1), max(0, int(col + reach) + 1)
    rows, cols = np.nonzero(grid.occupied[top:bottom, left:right])
    return rows + top, cols + left
