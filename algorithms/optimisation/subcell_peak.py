"""Sub-cell refinement: the climb to the top of a paraboloid through the objective, and how that curves."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from itertools import product

import numpy as np

from algorithms.common.pose import FloatArray, Pose2
from algorithms.observations.search_window import CoupledWindow
from algorithms.optimisation.objective import Objective
from algorithms.optimisation.search_box import pose_about, transforms_about

ROUNDS = (1.0, 0.5, 0.25, 0.125)  # cells; width of the stencil, round by round
LEASH = 1.5  # cells from where it began: farther off is another answer, for the search to find


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
    at = pose_about(pivot, T_ref_mov)
    low, high = at - LEASH * scale, at + LEASH * scale
    value = float(objective(transforms_about(pivot, at[None]))[0])
    for width in ROUNDS:
        values = objective(transforms_about(pivot, at + STENCIL * (scale * width)))
        gradient, hessian = paraboloid(values)
        tried = [STENCIL[int(values.argmax())]]
        if np.linalg.eigvalsh(hessian)[-1] < 0:
            tried.append(-np.linalg.solve(hessian, gradient))
        places = np.clip(at + np.array(tried) * scale * width, low, high)
        transforms = transforms_about(pivot, places)
        found = np.where(window.contains(transforms), objective(transforms), -np.inf)
        best = int(found.argmax())
        if found[best] > value:
            at, value = places[best], float(found[best])
    return peak_at(objective, Pose2.from_array(transforms_about(pivot, at[None])[0]), pivot, reach)


def peak_at(objective: Objective, T_ref_mov: Pose2, pivot: FloatArray, reach: float) -> Peak:
    """The objective and how it bends at a transform, whether that is a maximum or not.

    pivot, reach : as for ``climb_to_peak``
    """
    scale = np.array([1.0, 1.0, 1 / reach]) * objective.cell
    at = pose_about(pivot, T_ref_mov)
    _, hessian = paraboloid(objective(transforms_about(pivot, at + STENCIL * scale)))
    return Peak(T_ref_mov, objective.value_at(T_ref_mov), -hessian / np.outer(scale, scale))


STENCIL = np.array(list(product((-1.0, 0.0, 1.0), repeat=3)))
"""(27, 3) the corners, edges and faces of a cube and its middle."""
_PAIRS = np.triu_indices(3)


@cache
def _least_squares() -> FloatArray:
    """(10, 27) from values at the stencil to the middle's value, slope, and factors of the products."""
    products = STENCIL[:, _PAIRS[0]] * STENCIL[:, _PAIRS[1]]
    return np.linalg.pinv(np.column_stack([np.ones(len(STENCIL)), STENCIL, products]))


def paraboloid(values: FloatArray) -> tuple[FloatArray, FloatArray]:
    """(3,) gradient and (3, 3) Hessian, in steps, of what fits (27,) values at the stencil best."""
    fitted = _least_squares() @ values
    hessian = np.zeros((3, 3))
    hessian[_PAIRS] += fitted[4:]
    hessian.T[_PAIRS] += fitted[4:]
    return fitted[1:4], hessian
