"""Sub-cell refinement: the climb to the top of a paraboloid through the objective, and how that curves."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from itertools import combinations_with_replacement, product

import numpy as np

from algorithms.common.pose import FloatArray, Pose2
from algorithms.observations.search_window import CoupledWindow
from algorithms.optimisation.objective import Objective

ROUNDS = (1.0, 0.5, 0.25, 0.125)  # cells; width of the stencil, round by round
LEASH = 1.5  # cells from where it began: farther off is another answer, for the search to find
PAIRS = tuple(combinations_with_replacement(range(3), 2))


@dataclass(frozen=True, eq=False)
class Peak:
    """A local maximum of a smooth objective.

    curvature : (3, 3) of −objective by where the pivot goes (x, y; m) and by theta (rad)
    """

    T_ref_mov: Pose2
    value: float
    curvature: FloatArray


def climb_to_peak(objective: Objective, T_ref_mov: Pose2, window: CoupledWindow, reach: float) -> Peak:
    """Climb from a transform on the lattice to the top nearby; never to a lower value.

    window : turns are about its pivot, and it is not left: what the search was kept from is not reached
             by a step off its edge
    reach  : distance over which a turn moves a cell by one cell; metres
    """
    pivot = window.pivot
    cell = objective.cell
    scale = np.array([cell, cell, cell / reach])
    at = np.append(T_ref_mov.apply(pivot), T_ref_mov.theta)
    low, high = at - LEASH * scale, at + LEASH * scale
    value = float(objective(_transforms(at[None], pivot))[0])
    for width in ROUNDS:
        gradient, hessian, values, stencil = _paraboloid(objective, at, scale * width, pivot)
        tried = [stencil[int(values.argmax())]]
        if np.linalg.eigvalsh(hessian)[-1] < 0:
            tried.append(-np.linalg.solve(hessian, gradient))
        places = np.clip(at + np.array(tried) * scale * width, low, high)
        transforms = _transforms(places, pivot)
        found = np.where(window.contains(transforms), objective(transforms), -np.inf)
        best = int(found.argmax())
        if found[best] > value:
            at, value = places[best], float(found[best])
    return peak_at(objective, Pose2.from_array(_transforms(at[None], pivot)[0]), pivot, reach)


def peak_at(objective: Objective, T_ref_mov: Pose2, pivot: FloatArray, reach: float) -> Peak:
    """The objective and how it bends at a transform, whether that is a maximum or not.

    pivot, reach : as for ``climb_to_peak``
    """
    scale = np.array([1.0, 1.0, 1 / reach]) * objective.cell
    at = np.append(T_ref_mov.apply(pivot), T_ref_mov.theta)
    _, hessian, _, _ = _paraboloid(objective, at, scale, pivot)
    return Peak(T_ref_mov, objective.value_at(T_ref_mov), -hessian / np.outer(scale, scale))


@cache
def _stencil() -> tuple[FloatArray, FloatArray]:
    """(27, 3) the corners, edges and faces of a cube and its middle; and the least squares over them."""
    places = np.array(list(product((-1.0, 0.0, 1.0), repeat=3)))
    columns = [np.ones(len(places)), *places.T, *(places[:, i] * places[:, j] for i, j in PAIRS)]
    return places, np.linalg.pinv(np.column_stack(columns))


def _paraboloid(
    objective: Objective, at: FloatArray, step: FloatArray, pivot: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """Gradient and Hessian in steps, the stencil's values and its places in steps."""
    places, solve = _stencil()
    values = objective(_transforms(at + places * step, pivot))
    fitted = solve @ values
    hessian = np.zeros((3, 3))
    for coefficient, (i, j) in zip(fitted[4:], PAIRS, strict=True):
        hessian[i, j] += coefficient
        hessian[j, i] += coefficient
    return fitted[1:4], hessian, values, places


def _transforms(places: FloatArray, pivot: FloatArray) -> FloatArray:
    """(P, 3) x, y, theta of T_ref_mov that put the pivot at x, y and turn by theta."""
    c, s = np.cos(places[:, 2]), np.sin(places[:, 2])
    x, y = pivot
    return np.column_stack([places[:, 0] - c * x + s * y, places[:, 1] - s * x - c * y, places[:, 2]])
