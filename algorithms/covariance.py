"""How sharp the peak of Γ is: the covariance that goes with a transform."""

from __future__ import annotations

import numpy as np

from algorithms.pose import FloatArray, Pose2
from algorithms.search import Value
from algorithms.window import Box


def peak_covariance(value: Value, T_ref_mov: Pose2, box: Box, cell: float, reach: float) -> FloatArray:
    """Width of the peak of Γ: inverse of the curvature of −log Γ at the transform.

    It takes Γ for a likelihood, which it is not: this is the width of the peak, about a wall's
    thickness, and not a calibrated error. Where Γ has no peak in some direction, the box's own
    variance stands for that direction.

    cell    : step of the differences in x and y; metres
    reach   : distance over which a turn moves a cell by one step; metres
    returns : (3, 3) of x, y, theta; metres and radians; positive definite
    """
    step = np.array([cell, cell, cell / reach])
    centre = T_ref_mov.array()
    unit = np.eye(3)
    offsets = [np.zeros(3)]
    pairs = [(0, 1), (0, 2), (1, 2)]
    offsets += [sign * unit[i] for i in range(3) for sign in (1, -1)]
    offsets += [a * unit[i] + b * unit[j] for i, j in pairs for a in (1, -1) for b in (1, -1)]
    values = value(centre + np.array(offsets) * step)
    widest = ((box.high - box.low) / step) ** 2 / 12  # variance of a pose anywhere in the box
    if values.min() <= 0:
        return np.asarray(np.diag(widest * step**2), dtype=np.float64)
    bend = -np.log(values)
    curvature = np.diag([bend[1 + 2 * i] + bend[2 + 2 * i] - 2 * bend[0] for i in range(3)])
    for number, (i, j) in enumerate(pairs):
        pp, pm, mp, mm = bend[7 + 4 * number : 11 + 4 * number]
        curvature[i, j] = curvature[j, i] = (pp - pm - mp + mm) / 4
    strengths, directions = np.linalg.eigh(curvature)
    least = 1 / np.max(widest)
    covariance = (directions / np.maximum(strengths, least)) @ directions.T
    return np.asarray(covariance * np.outer(step, step), dtype=np.float64)
