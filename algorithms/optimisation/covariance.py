"""Both ways to a transform's covariance: how wide a peak of Γ is, and the error that metres of wall leave."""

from __future__ import annotations

from itertools import combinations

import numpy as np

from algorithms.common.pose import FloatArray, Pose2
from algorithms.optimisation.objective import Objective
from algorithms.optimisation.search_box import SearchBox, pose_about, shift_covariance
from algorithms.optimisation.subcell_peak import Peak


def peak_covariance(objective: Objective, T_ref_mov: Pose2, box: SearchBox, reach: float) -> FloatArray:
    """Width of the peak of Γ: inverse of the curvature of −log Γ at the transform.

    It takes Γ for a likelihood, which it is not: this is the width of the peak, about a wall's
    thickness, and not a calibrated error. Where Γ has no peak in some direction, the box's own
    variance stands for that direction.

    box     : the optimiser's box; the curvature is taken in its coordinates, where turn and shift are
              least entangled
    reach   : distance over which a turn moves a cell by one cell; metres. The spread Σ_aug is fitting
    returns : (3, 3) of Δx, Δy, Δθ; metres and radians; positive definite
    """
    cell = objective.cell
    step = np.array([cell, cell, cell / reach])
    centre = pose_about(box.pivot, T_ref_mov)
    unit = np.eye(3)
    offsets = [np.zeros(3)]
    offsets += [sign * unit[i] for i in range(3) for sign in (1, -1)]
    pairs = list(combinations(range(3), 2))
    offsets += [a * unit[i] + b * unit[j] for i, j in pairs for a in (1, -1) for b in (1, -1)]
    values = objective(box.transforms(centre + np.array(offsets) * step))
    widest = ((box.high - box.low) / step) ** 2 / 12  # variance of a pose anywhere in the box
    if values.min() <= 0:
        in_steps = np.diag(widest)
    else:
        bend = -np.log(values)
        curvature = np.diag([bend[1 + 2 * i] + bend[2 + 2 * i] - 2 * bend[0] for i in range(3)])
        for number, (i, j) in enumerate(pairs):
            both, right, left, none = bend[7 + 4 * number : 11 + 4 * number]
            curvature[i, j] = curvature[j, i] = (both - right - left + none) / 4
        strengths, directions = np.linalg.eigh(curvature)
        in_steps = (directions / np.maximum(strengths, 1 / widest.max())) @ directions.T
    return shift_covariance(in_steps * np.outer(step, step), box.pivot, T_ref_mov)


def covariance_of(
    peak: Peak, pivot: FloatArray, evidence: float, widest: FloatArray, least: FloatArray
) -> FloatArray:
    """(3, 3) covariance of Δx, Δy, Δθ; metres and radians; positive definite.

    With an objective that counts metres of wall, of which ``evidence`` metres say as much as one
    measurement, objective / evidence is a log-likelihood; its curvature at the top is inverted.

    widest : (3,) standard deviations of x, y, theta where the objective says nothing
    least  : (3,) standard deviations of x, y, theta that come on top: rasters, and bent maps
    """
    unit = np.asarray(widest, dtype=np.float64)
    strengths, directions = np.linalg.eigh(peak.curvature * np.outer(unit, unit) / evidence)
    at_pivot = (directions / np.maximum(strengths, 1.0)) @ directions.T * np.outer(unit, unit)
    at_pivot += np.diag(np.square(least))
    return shift_covariance(at_pivot, pivot, peak.T_ref_mov)
