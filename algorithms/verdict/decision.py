"""Is the merge to be trusted? How likely it is right, which of three outcomes that makes, and a sentence."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from enum import Enum
from math import degrees, exp, log
from typing import Annotated

from algorithms.common.pose import FloatArray, Pose2, pose_error
from algorithms.common.setting_bounds import Bounds, CheckedConfig
from algorithms.maps.map_fusion import Fusion
from algorithms.verdict.probability_model import OTHERS, VerdictModel, log_odds_over, shipped_model
from algorithms.verdict.ranking import Weighed, probability_of
from algorithms.verdict.slipping_patches import Apart
from algorithms.verdict.wall_evidence import Evidence

SAME_PLACE = 0.5  # metres; answers farther apart are said to be apart, nearer ones turned
SPEAKS = 0.5  # log-odds; what moves them by less is not named among the reasons
RIVAL_FROM = 0.05  # of the named answer's odds; another one below it is no rival
ALIKE = 0.7  # log-odds, half as likely; nearer ones are said to fit almost equally well
MOST_ODDS = 50.0  # log-odds of another answer over the named one that are given, at most
LEAST_WALL = 0.5  # metres; less was seen by nobody
WIDE = log(100.0)  # of the places searched, m²: less is no wide search
NEXT_TO_NO_WALL = 1.0  # metres; so little that contradicts is a few cells here and there
BENDS = 0.05  # share of the walls that slipping must mend for maps to be called bent


class Outcome(str, Enum):
    """What a merge ends with."""

    MERGED = "merged"
    BENT = "merged, bent"
    REFUSED = "refused"


@dataclass(frozen=True)
class VerdictConfig(CheckedConfig):
    """When a merge is accepted, and when it is called bent."""

    accept_from: Annotated[float, Bounds(0.5, 0.999, 0.001, "", "P", "accept from")] = (
        shipped_model().accept_from
    )
    """Probability from which on a merge is accepted. At the default none of more than a thousand pairs of
    different buildings was accepted that were left out when the probability was fitted."""
    bent_from: Annotated[float, Bounds(0, 1, 0.01, "", "", "bent from")] = 0.1
    """Share of the walls that contradict as the maps lie, from which on an accepted merge of maps whose
    patches fit better apart is called bent: its walls are double."""
    refuse_bent: bool = False
    """Refuse maps that are bent: no merged map has double walls then."""
    robot_size: Annotated[float, Bounds(0, 2, 0.05, "m", "", "robot size")] = 0.4
    """So near to where a robot stood there is no wall: what a map shows there is the robot, and becomes
    floor."""


@dataclass(frozen=True)
class Verdict:
    """One of three outcomes, with the numbers it rests on.

    accepted         : whether it is not refused
    probability      : that the transform is right, 0 … 1
    reason           : the outcome and what it rests on, in a sentence
    quantities       : what the probability rests on, as ``probability_model.QUANTITIES`` names them
    contributions    : log-odds by which each moves it from that of a typical right merge, and other answers
    typical_score    : log-odds of that
    acceptance_index : agreeing share of the cells known to both, 0 … 1
    overlap_cells    : cells known to both maps
    overlap_area     : the same; m²
    conflicting_cells : those of them that are a wall in one map and free in the other
    shared_wall      : wall that both robots should have seen; m
    contradiction    : share of it that the other map denies, patches slipped
    rigid_contradiction : the same with the maps as they are
    wall_across      : agreeing wall across the direction of most of it; m
    shared_floor     : free floor that both robots saw; m²
    apart            : where bent maps lie beside each other, the farthest first
    ambiguity        : odds of the best other answer over this one's, 0 … 1, of a transform that no search has
                       found also more; None for a method that knows no others
    rival            : that answer; None where there is none worth naming
    deviation        : distance of R2 from where it was seen, in standard deviations; of several
                       sightings the largest
    only_bent        : whether it is refused for nothing but the bend of the maps
    cleared_cells    : cells around robots that were taken for the robots themselves
    hint             : under which simple change the maps would agree, or how a map was read wrongly
    """

    accepted: bool
    outcome: Outcome
    probability: float
    reason: str
    quantities: Mapping[str, float]
    contributions: Mapping[str, float]
    typical_score: float
    acceptance_index: float
    overlap_cells: int
    overlap_area: float
    conflicting_cells: int
    shared_wall: float
    contradiction: float
    rigid_contradiction: float
    wall_across: float
    shared_floor: float
    apart: tuple[Apart, ...]
    ambiguity: float | None
    rival: Pose2 | None
    deviation: float
    only_bent: bool = False
    cleared_cells: int = 0
    hint: str = ""

    @property
    def against(self) -> tuple[str, ...]:
        """What speaks against the merge, by weight: names of quantities, or OTHERS."""
        return speaking_against(self.contributions)


def speaking_against(contributions: Mapping[str, float]) -> tuple[str, ...]:
    """Names of what moves the log-odds down by much, the most first."""
    down = {name: moved for name, moved in contributions.items() if moved <= -SPEAKS}
    return tuple(sorted(down, key=lambda name: down[name]))


def judge(
    fusion: Fusion,
    named: Weighed,
    others: Sequence[Weighed] | None,
    pivot: FloatArray,
    config: VerdictConfig,
    doubts: Sequence[str] = (),
    model: VerdictModel | None = None,
    sighted: bool = True,
) -> Verdict:
    """Accept or refuse a merge; what speaks against it is named in the reason, the weightiest first.

    named  : the answer, as the whole maps weigh it
    others : other answers that may be the right one; None for a method that knows none
    pivot  : (2,) where answers are compared, x̂2; metres, mov frame
    doubts : what the method itself has against its answer, each a clause of a sentence
    model  : that has weighed the answers; None: that of answers near a sighting
    sighted : whether one robot saw the other
    """
    model = shipped_model() if model is None else model
    rivals = sorted(others or (), key=lambda other: -other.score)
    scores = [other.score for other in rivals]
    likely = probability_of(named, rivals)
    contributions = model.contributions(named.quantities, scores)
    evidence = named.evidence
    share = None
    if others is not None:
        share = exp(min(MOST_ODDS, log_odds_over(scores[0], named.score, named.enough))) if rivals else 0.0
    rival = rivals[0] if rivals and (share or 0.0) >= RIVAL_FROM else None
    accepted, bent = likely >= config.accept_from and not doubts, is_bent(evidence, config)
    only_bent = accepted and bent and config.refuse_bent
    outcome = Outcome.REFUSED
    if only_bent:
        accepted = False
        reason = f"Refused: the maps are bent, and a bent merge is not wanted. {_bend(evidence)}."
    elif accepted:
        outcome = Outcome.BENT if bent else Outcome.MERGED
        reason = _accepted(outcome, likely, evidence)
    else:
        names = speaking_against(contributions)
        clauses = [*doubts, *_clauses(names, named, rival, pivot, sighted)]
        if not clauses:
            clauses = ["no single thing speaks much against it, but too little speaks for it"]
        though = "although " if likely >= config.accept_from else ""
        reason = f"Refused: {though}{merges_of(likely)}. {_sentence('; '.join(clauses))}."
    return Verdict(
        accepted=accepted,
        outcome=outcome,
        probability=likely,
        reason=reason,
        quantities=dict(named.quantities),
        contributions=contributions,
        typical_score=model.typical_score,
        acceptance_index=fusion.acceptance_index,
        overlap_cells=fusion.overlap,
        overlap_area=fusion.overlap * fusion.merged.resolution**2,
        conflicting_cells=fusion.conflicting,
        shared_wall=evidence.shared_wall,
        contradiction=evidence.contradiction,
        rigid_contradiction=evidence.rigid_contradiction,
        wall_across=evidence.across,
        shared_floor=evidence.floor,
        apart=evidence.apart,
        ambiguity=share,
        rival=None if rival is None else rival.T_ref_mov,
        deviation=max(named.deviations, default=0.0),
        only_bent=only_bent,
        cleared_cells=fusion.cleared,
    )


def is_bent(evidence: Evidence, config: VerdictConfig) -> bool:
    """Whether no one transform lays the maps on each other everywhere, though they belong together."""
    mended = evidence.rigid_contradiction - evidence.contradiction
    return evidence.rigid_contradiction > config.bent_from and mended > BENDS


def merges_of(probability: float) -> str:
    """A probability as a count of merges: "997 of 1,000 such merges are right"."""
    thousand = int(probability * 1000 + 1e-9)  # downwards: 999.7 are not all
    if thousand >= 999:
        return "more than 999 of 1,000 such merges are right"
    if thousand < 1:
        return "less than 1 of 1,000 such merges is right"
    return f"{thousand:,} of 1,000 such merges {'is' if thousand == 1 else 'are'} right"


def _share(share: float) -> str:
    """Per cent, downwards: what is not all of it is not 100%."""
    return f"{int(share * 100 + 1e-9)}%"


def _sentence(clause: str) -> str:
    return clause[:1].upper() + clause[1:]


def _accepted(outcome: Outcome, likely: float, evidence: Evidence) -> str:
    if outcome is Outcome.MERGED:
        return (
            f"Merged: {merges_of(likely)}. The maps agree on {_share(1 - evidence.contradiction)} of the "
            f"{evidence.shared_wall:.0f} m of wall that both robots should have seen."
        )
    return (
        f"Merged, bent: {merges_of(likely)}, but the maps are bent: no one transform lays them on each other "
        f"everywhere. {_bend(evidence)}: walls will be double there."
    )


def _bend(evidence: Evidence) -> str:
    """How far bent maps lie apart, and where, as a sentence without its end."""
    where = f"{evidence.rigid_contradiction:.0%} of the wall contradicts as they lie"
    if evidence.apart:
        worst = evidence.apart[0]
        where = (
            f"they lie up to {worst.metres:.1f} m beside each other, most at ({worst.x:.1f}, {worst.y:.1f}), "
            f"and {where}"
        )
    return _sentence(where)


def _clauses(
    names: Sequence[str], named: Weighed, rival: Weighed | None, pivot: FloatArray, sighted: bool
) -> list[str]:
    """What speaks against a merge, each as a clause of a sentence, in the order given."""
    seen, clauses = named.evidence, []
    if seen.rigid_agreeing + seen.rigid_contradicting < LEAST_WALL:
        clauses.append("no wall was seen by both robots")
        names = [name for name in names if name in ("misfit", OTHERS)]
    walls = [name for name in names if name in ("contradiction", "unbent")]
    for name in names:
        if name in walls[:1] and seen.rigid_contradicting < NEXT_TO_NO_WALL:
            clauses.append(
                f"they have only {seen.rigid_agreeing:.0f} m of wall and {seen.floor:.0f} m² of floor in "
                "common: that much can fit by chance"
            )
        elif name in walls[:1]:
            wall = seen.rigid_agreeing + seen.rigid_contradicting
            clause = (
                f"the maps contradict each other on {seen.rigid_contradiction:.0%} of the {wall:.0f} m of "
                "wall that both robots should have seen"
            )
            if "unbent" in walls:
                clause += f", and on {seen.contradiction:.0%} where patches of them may slip"
            clauses.append(clause)
        elif name == "across":
            clauses.append(
                f"only {seen.across:.0f} m of the {seen.rigid_agreeing:.0f} m of wall that agree run across "
                "the others, so little keeps map 2 in its place"
            )
        elif name == "misfit":
            who, where = ("robot 2", "where it was seen") if sighted else ("map 2", "where it was said to be")
            off = max(named.deviations, default=0.0)
            clauses.append(f"{who} would stand {off:.1f} standard deviations from {where}")
        elif name == "searched" and named.quantities[name] > WIDE:
            clauses.append("in so wide a search that much may fit by chance")
        elif name == OTHERS and rival is not None:
            clauses.append(_rivalry(named, rival, pivot, sighted))
    return clauses


def _rivalry(named: Weighed, rival: Weighed, pivot: FloatArray, sighted: bool) -> str:
    """What another answer means for this one."""
    cure = "a second observation would decide" if sighted else "a sighting would decide"
    distance, turn = pose_error(rival.T_ref_mov, named.T_ref_mov, pivot)
    if rival.score > named.score:  # a search would have named the other one
        return f"the walls fit better {distance:.2f} m and {degrees(turn):.0f}° from there"
    apart = f"{degrees(turn):.0f}° apart"
    if distance > SAME_PLACE and degrees(turn) < 1:
        apart = f"{distance:.1f} m apart"
    if log_odds_over(rival.score, named.score, named.enough) > -ALIKE:
        return f"two answers fit almost equally well, {apart}: {cure}"
    return f"another answer, {apart}, fits too well to be ruled out: {cure}"
