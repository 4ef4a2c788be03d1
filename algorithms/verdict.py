"""Is the merge to be trusted? Numbers, and a sentence that says why or why not."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import sqrt
from typing import Annotated

import numpy as np

from algorithms.bounds import Bounds, check_bounds
from algorithms.fuse import Fusion
from algorithms.observation import Encounter
from algorithms.pose import FloatArray, Pose2, pose_error


@dataclass(frozen=True)
class VerdictConfig:
    """When a merge is accepted."""

    acceptance: Annotated[float, Bounds(0, 1, 0.01, "", "ω_acc", "acceptance index")] = 0.85
    """Share of the cells known to both maps that must agree."""
    support: Annotated[float, Bounds(0, 1, 0.01, "", "", "wall support")] = 0.5
    """Share of the walls in the area known to both that the other map must confirm: more walls have
    to speak for the merge than against it."""
    ambiguity: Annotated[float, Bounds(0, 1, 0.01, "", "", "rival")] = 0.8
    """Refused where another answer reaches this share of the best Γ."""
    overlap: Annotated[float, Bounds(0, 50, 0.5, "m²", "", "overlap")] = 2.0
    """Area known to both maps below which nothing can be said."""
    deviations: Annotated[float, Bounds(1, 10, 0.5, "σ", "", "observation")] = 4.0
    """How far from the sighting the answer may put the seen robot, in standard deviations."""

    def __post_init__(self) -> None:
        check_bounds(self)


@dataclass(frozen=True)
class Verdict:
    """Accepted or refused, with the numbers it rests on.

    acceptance_index : agreeing share of the cells known to both, 0 … 1
    overlap_cells    : cells known to both maps
    overlap_area     : the same; m²
    wall_support     : share of the walls in the area known to both that the other map confirms
    ambiguity        : Γ of the best answer elsewhere over Γ of this one, 0 … 1; None for a method
                       that knows no other answers
    deviation        : distance of R2 from where it was seen, in standard deviations
    """

    accepted: bool
    reason: str
    acceptance_index: float
    overlap_cells: int
    overlap_area: float
    conflicting_cells: int
    wall_support: float
    ambiguity: float | None
    deviation: float


def judge(
    fusion: Fusion, T_ref_mov: Pose2, at: Encounter, ambiguity: float | None, config: VerdictConfig
) -> Verdict:
    """Accept or refuse a merge; every number that speaks against it is named in the reason.

    ambiguity : Γ of the best answer elsewhere over Γ of this one, from ``ambiguity_of``; None for a
                method that knows no other answers
    """
    cell = fusion.merged.resolution
    area = fusion.overlap * cell**2
    deviation = deviation_from(T_ref_mov, at, cell)
    doubts = []
    if area < config.overlap:
        doubts.append(f"only {area:.1f} m² are known to both maps, too little to tell right from wrong")
    elif fusion.acceptance_index < config.acceptance:
        doubts.append(
            f"the maps contradict each other in {1 - fusion.acceptance_index:.0%} "
            f"of the {area:.0f} m² known to both"
        )
    if area >= config.overlap and fusion.wall_support < config.support:
        doubts.append(
            f"only {fusion.wall_support:.0%} of the walls that both robots should have seen coincide"
        )
    if ambiguity is not None and ambiguity > config.ambiguity:
        doubts.append(f"another answer fits almost as well ({ambiguity:.0%} of the best Γ)")
    if deviation > config.deviations:
        doubts.append(f"it puts the seen robot {deviation:.1f} standard deviations from where it was seen")
    if doubts:
        reason = "Refused: " + "; ".join(doubts) + "."
    else:
        reason = (
            f"Merged: {fusion.acceptance_index:.0%} of the {area:.0f} m² known to both agrees, "
            f"{fusion.wall_support:.0%} of the walls coincide"
            + (f"; the next best answer reaches {ambiguity:.0%} of its Γ." if ambiguity is not None else ".")
        )
    return Verdict(
        accepted=not doubts,
        reason=reason,
        acceptance_index=fusion.acceptance_index,
        overlap_cells=fusion.overlap,
        overlap_area=area,
        conflicting_cells=fusion.conflicting,
        wall_support=fusion.wall_support,
        ambiguity=ambiguity,
        deviation=deviation,
    )


def deviation_from(T_ref_mov: Pose2, at: Encounter, cell: float) -> float:
    """How far T puts R2 from where it was seen, in standard deviations of the sighting.

    A robot's own position is known to no better than the cell it stands in: one cell is added to
    the sighting's standard deviation in every direction.
    """
    miss = T_ref_mov.apply(at.x_mov) - at.x_ref
    covariance = at.covariance + np.eye(2) * cell**2
    return sqrt(float(miss @ np.linalg.solve(covariance, miss)))


def ambiguity_of(
    answers: Sequence[tuple[Pose2, float]], at_mov: FloatArray, distance: float, angle: float
) -> float:
    """Γ of the best answer elsewhere over Γ of the best; 0 where there is none, 1 without evidence.

    answers  : transforms with their Γ, best first
    at_mov   : (2,) where two answers are compared, x̂2; metres, mov frame
    distance : metres, and
    angle    : radians, from which on two transforms are two answers
    """
    if not answers or answers[0][1] <= 0:
        return 1.0
    best, best_value = answers[0]
    for T, value in answers[1:]:
        apart, turned = pose_error(T, best, at_mov)
        if apart > distance or turned > angle:
            return value / best_value
    return 0.0
