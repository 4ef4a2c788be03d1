"""Is the merge to be trusted? Numbers that mean the same in every building, and a sentence."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import degrees
from typing import Annotated

import numpy as np

from algorithms.bounds import Bounds, check_bounds
from algorithms.evidence import Evidence
from algorithms.fuse import Fusion
from algorithms.observation import Encounter
from algorithms.pose import FloatArray, Pose2, pose_error

HALF = 0.5  # of the best value
SAME_PLACE = 0.5  # metres; answers farther apart are said to be apart, nearer ones turned


@dataclass(frozen=True)
class VerdictConfig:
    """When a merge is accepted."""

    contradiction: Annotated[float, Bounds(0, 1, 0.01, "", "", "contradiction")] = 0.09
    """Share of the walls that both robots should have seen which the other map may deny, once every
    patch of the maps may slip a little. Right merges of crisp maps stay below 8 %, wrong ones above 10 %."""
    bent_contradiction: Annotated[float, Bounds(0, 1, 0.01, "", "", "contradiction, bent")] = 0.25
    """The same for maps that are bent: slipping must then take away most of the contradictions."""
    bent: Annotated[float, Bounds(0, 1, 0.01, "", "", "bent")] = 0.42
    """Share of the contradictions that slipping must take away for maps to count as bent. It takes away
    half and more where one place was mapped by hand, two fifths at most of two buildings."""
    wall: Annotated[float, Bounds(0, 200, 1, "m", "", "shared wall")] = 18.0
    """Wall that both robots should have seen, below which nothing can be said."""
    plenty: Annotated[float, Bounds(0, 200, 1, "m", "", "plenty of wall")] = 30.0
    """Wall that both robots should have seen, below which a rival counts with less than that share, at
    the least wall with half of it, whatever contradicts it: so little fits in several places by chance."""
    bent_wall: Annotated[float, Bounds(0, 500, 5, "m", "", "shared wall, bent")] = 60.0
    """The same for bent maps: what is vague must be long."""
    ambiguity: Annotated[float, Bounds(0, 1, 0.01, "", "", "rival")] = 0.8
    """Refused where another answer reaches this share of the best value and is contradicted no more."""
    deviations: Annotated[float, Bounds(1, 10, 0.5, "σ", "", "observation")] = 4.0
    """How far from a sighting the answer may put the seen robot, in standard deviations."""

    def __post_init__(self) -> None:
        check_bounds(self)


@dataclass(frozen=True)
class Rival:
    """Another answer, at another turn or place.

    share    : its value over the best one's
    evidence : what the walls say of it
    """

    T_ref_mov: Pose2
    share: float
    evidence: Evidence


@dataclass(frozen=True)
class Verdict:
    """Accepted or refused, with the numbers it rests on.

    acceptance_index : agreeing share of the cells known to both, 0 … 1
    overlap_cells    : cells known to both maps
    overlap_area     : the same; m²
    shared_wall      : wall that both robots should have seen; m
    contradiction    : share of it that the other map denies, patches slipped
    rigid_contradiction : the same with the maps as they are
    bent             : share of the contradictions that slipping takes away
    ambiguity        : value of the best answer elsewhere over this one's, 0 … 1, of a transform made by
                       hand also more; None for a method
                       that knows no other answers
    rival            : that answer; None where there is none worth naming
    deviation        : distance of R2 from where it was seen, in standard deviations; of several
                       sightings the largest
    """

    accepted: bool
    reason: str
    acceptance_index: float
    overlap_cells: int
    overlap_area: float
    conflicting_cells: int
    shared_wall: float
    contradiction: float
    rigid_contradiction: float
    bent: float
    ambiguity: float | None
    rival: Pose2 | None
    deviation: float


def judge(
    fusion: Fusion,
    weighed: Evidence,
    T_ref_mov: Pose2,
    encounters: Sequence[Encounter],
    rivals: Sequence[Rival] | None,
    config: VerdictConfig,
    margin: float = 0.0,
    doubts: Sequence[str] = (),
) -> Verdict:
    """Accept or refuse a merge; every number that speaks against it is named in the reason.

    weighed : what the walls say of T_ref_mov
    rivals  : other answers, best first; None for a method that knows none
    margin  : standard deviation of what the sightings' own do not tell; metres
    doubts  : what the method itself has against its answer, each a clause of a sentence
    """
    cell = fusion.merged.resolution
    deviation = max(deviation_from(T_ref_mov, at, max(cell, margin)) for at in encounters)
    shared = weighed.agreeing + weighed.contradicting
    found = list(doubts)
    if shared < config.wall:
        found.append(
            f"only {shared:.0f} m of wall were seen by both robots, too little to tell right from wrong"
        )
    elif not _consistent(weighed, config):
        found.append(
            f"the maps disagree on {weighed.contradiction:.0%} of the {shared:.0f} m of wall "
            "that both robots should have seen"
        )
    rival = next((rival for rival in rivals or () if _ambiguous(weighed, rival, config)), None)
    if rival is not None:
        apart = _apart(rival.T_ref_mov, T_ref_mov, encounters[0])
        doubt = f"two answers fit almost equally well, {apart}"
        if rival.share <= config.ambiguity:
            cause = (
                "is contradicted less" if shared >= config.plenty else "is not ruled out by so little wall"
            )
            doubt = f"another answer, {apart}, {cause}"
        if rival.share > 1:  # of a transform made by hand: a search would have taken the better one
            found.append(f"another answer, {apart}, fits better")
        else:
            found.append(f"{doubt}: a second observation would decide")
    if deviation > config.deviations:
        found.append(f"it puts the seen robot {deviation:.1f} standard deviations from where it was seen")
    if found:
        reason = "Refused: " + "; ".join(found) + "."
    else:
        reason = (
            f"Merged: the maps agree on {1 - weighed.contradiction:.0%} of the {shared:.0f} m of wall "
            "that both robots should have seen."
        )
    return Verdict(
        accepted=not found,
        reason=reason,
        acceptance_index=fusion.acceptance_index,
        overlap_cells=fusion.overlap,
        overlap_area=fusion.overlap * cell**2,
        conflicting_cells=fusion.conflicting,
        shared_wall=shared,
        contradiction=weighed.contradiction,
        rigid_contradiction=weighed.rigid_contradiction,
        bent=weighed.bent,
        ambiguity=None if rivals is None else max((rival.share for rival in rivals), default=0.0),
        rival=None if rival is None else rival.T_ref_mov,
        deviation=deviation,
    )


def _consistent(weighed: Evidence, config: VerdictConfig) -> bool:
    """Whether two maps say the same: crisp ones nearly everywhere, bent ones as far as they bend."""
    if weighed.contradiction <= config.contradiction:
        return True
    return (
        weighed.contradiction <= config.bent_contradiction
        and weighed.bent >= config.bent
        and weighed.agreeing >= config.bent_wall
    )


def _ambiguous(weighed: Evidence, rival: Rival, config: VerdictConfig) -> bool:
    """Whether a rival leaves the answer in doubt.

    A rival that is contradicted three times as much as the answer is none: its walls fit near the
    encounter, where every corridor looks alike, and not beyond. One that is hardly contradicted at all
    is to be feared even with half the value, where the answer itself is contradicted.
    """
    clean = config.contradiction
    shared = weighed.agreeing + weighed.contradicting
    if shared < config.plenty:
        limit = np.interp(shared, (config.wall, config.plenty), (HALF, config.ambiguity))
        return rival.share > float(limit)
    if rival.share > config.ambiguity:
        return rival.evidence.contradiction <= max(clean, 3 * weighed.contradiction)
    return rival.evidence.contradiction <= clean < weighed.contradiction


def _apart(a: Pose2, b: Pose2, at: Encounter) -> str:
    distance, turn = pose_error(a, b, at.x_mov)
    if distance > SAME_PLACE and degrees(turn) < 1:
        return f"{distance:.1f} m apart"
    return f"{degrees(turn):.0f}° apart"


def deviation_from(T_ref_mov: Pose2, at: Encounter, margin: float) -> float:
    """How far T puts R2 from where it was seen, in standard deviations of the sighting.

    margin : added to the sighting's standard deviation in every direction; metres. At least a cell: a
             robot's own position is known to no better than the cell it stands in
    """
    miss = T_ref_mov.apply(at.x_mov) - at.x_ref
    covariance = at.covariance + np.eye(2) * margin**2
    return float(np.sqrt(miss @ np.linalg.solve(covariance, miss)))


def others(
    answers: Sequence[tuple[Pose2, float]], at_mov: FloatArray, distance: float, angle: float
) -> list[tuple[Pose2, float]]:
    """The answers elsewhere than the best, each elsewhere than those before it, with their values.

    answers  : transforms with their values, best first
    at_mov   : (2,) where two answers are compared, x̂2; metres, mov frame
    distance : metres, and
    angle    : radians, from which on two transforms are two answers
    """
    kept: list[tuple[Pose2, float]] = []
    for T, value in answers:
        apart = [pose_error(T, known, at_mov) for known, _ in kept]
        if all(metres > distance or turn > angle for metres, turn in apart):
            kept.append((T, value))
    return kept[1:]
