"""What came out in words: the verdict, the rival in doubt, how the proof ended, what would help."""

from __future__ import annotations

from math import degrees

from algorithms.common.pose import Pose2, pose_error
from algorithms.maps.map_fusion import Fusion
from algorithms.methods.merge_result import CHOSEN, MergeResult
from algorithms.methods.registry import DEFAULT_METHOD, METHODS, PLANE_METHOD
from algorithms.optimisation.branch_and_bound import ProofState
from algorithms.verdict.decision import NEXT_TO_NO_WALL, SAME_PLACE, Outcome, Verdict
from algorithms.verdict.probability_model import OTHERS

SAME_TURN = 3.0  # degrees; the best of the lattice and the answer beside it are one
LEAST_LIKELY = 0.005  # of a rival; what is less likely rounds to nothing
MOODS = {Outcome.MERGED: "accepted", Outcome.BENT: "bent", Outcome.REFUSED: "refused"}
"""The colour of an outcome: green, amber, vermilion."""


def fits_nowhere(state: ProofState) -> bool:
    """Whether it is known that no transform of the window has a value above zero."""
    return state.stopped is not None and not state.empty and state.ceiling <= 0


def rival(result: MergeResult) -> str:
    """How the rival in doubt differs, and how likely it is: "180° turned, 48%"; else empty."""
    other = result.verdict.rival
    if other is None or likelihood_of_rival(result) < LEAST_LIKELY:
        return ""
    distance, turn = pose_error(result.T_ref_mov, other, result.pivot)
    shifted = distance > SAME_PLACE and degrees(turn) < 1
    how = f"{distance:.1f} m shifted" if shifted else f"{degrees(turn):.0f}° turned"
    return f"{how}, {likelihood_of_rival(result):.0%}"


def odds_of_rival(verdict: Verdict) -> str:
    """How likely the next best place is beside the named one."""
    odds = verdict.ambiguity or 0.0
    if odds > 1:  # of what no search has named
        return "likelier than this"
    return f"{odds:.0%} as likely" if odds > 0 else "none"


def likelihood_of_rival(result: MergeResult) -> float:
    """That the rival in doubt is right instead."""
    verdict = result.verdict
    return min(1.0 - verdict.probability, verdict.probability * (verdict.ambiguity or 0.0))


def of_hand(result: MergeResult, taken: bool = False) -> str:
    """What the verdict says of a transform made by hand, which is ``taken`` where it is the answer now."""
    reason = result.verdict.reason
    would = f"By hand, would be {result.verdict.outcome.value}: {reason.split(': ', 1)[-1]}"
    made = "Chosen by you" if result.method == CHOSEN else "By hand"
    return f"{made}. {reason}" if taken else would


def optimum(proof: ProofState) -> str:
    """How the proof ended: "proven", or that it is not, and why."""
    if proof.empty:
        return "none: the sightings exclude each other"
    if fits_nowhere(proof):
        return "nothing fits"
    return "proven" if proof.proven else f"not proven: {proof.stopped or 'not finished'}"


def resampled(fusion: Fusion) -> str:
    """Which map was resampled: "map 2 from cells of 0.2 m to 0.05 m"; empty where none was."""
    changed = " and ".join(f"map {n} from cells of {cell:g} m" for n, cell in fusion.resampled.items())
    return f"{changed} to {fusion.merged.resolution:g} m" if changed else ""


def searched(result: MergeResult) -> str:
    """How the plane was searched, and what is proven of it; empty for another search."""
    scan, proof = result.scan, result.proof
    if scan is None:
        return ""
    how = (
        f"turns in steps of {degrees(scan.turn_step):.3g}°, cells of {scan.cell:.2g} m, "
        f"the {scan.climbed} best places climbed"
    )
    if proof is None or not proof.proven or proof.best is None:
        why = f" ({proof.stopped})" if proof is not None and proof.stopped else ""
        return f"searched, not proven{why}: {how}"
    distance, turn = pose_error(result.T_ref_mov, Pose2.from_array(proof.best), result.pivot)
    if distance > SAME_PLACE or degrees(turn) > SAME_TURN:
        return f"proven to a cell: the walls agree best {distance:.1f} m and {degrees(turn):.0f}° from here"
    return "proven to a cell: at no other place do the walls agree better"


def mood(verdict: Verdict) -> str:
    """The colour that a verdict is shown in."""
    return MOODS[verdict.outcome]


def likelihood(probability: float) -> str:
    """A probability as a number in a table."""
    if probability > 0.9995:
        return "> 99.9%"
    return "< 0.1%" if probability < 0.0005 else f"{probability:.1%}"


def remedy(result: MergeResult) -> str:
    """What would help after a refusal, or what to mind of a bent merge; empty where nothing is to be said."""
    verdict, proof = result.verdict, result.proof
    if verdict.outcome is Outcome.BENT:
        return (
            "Where walls are double a robot may find a passage too narrow, or lose its way. Map again with "
            "loops closed or better odometry."
        )
    if verdict.accepted:
        return ""
    if verdict.only_bent:
        return "Map again with loops closed or better odometry; or take bent merges, too (without --strict)."
    if verdict.hint:
        return verdict.hint
    if result.method in METHODS and not METHODS[result.method].uses_observation:
        return "This method does not look at the observation: take one that does."
    if proof is not None and proof.empty:
        return "Check the numbers of the sightings, leave the odd one out, or widen the window's margin."
    if proof is not None and fits_nowhere(proof):
        return "Are these maps of one building? Check the observation's numbers, or widen the window."
    if proof is not None and not proof.proven and result.scan is None:
        return "Give the proof more patience, or narrow the window, and merge again."
    if verdict.rival is not None and (verdict.ambiguity or 0.0) > 1:
        if result.by_person:
            return "Made by hand: refine from there, or snap to the proven optimum."
        return "This method has missed a better place: take the default one, which proves that it finds it."
    if result.method in METHODS and result.encounters and result.method not in (DEFAULT_METHOD, PLANE_METHOD):
        return (
            "This method follows up a part of what may be: take the default one, which proves what fits best."
        )
    first = next(iter(verdict.against), "")
    evidence = result.weighed[0].evidence
    if first in ("contradiction", "unbent") and evidence.rigid_contradicting < NEXT_TO_NO_WALL:
        first = "across"  # hardly anything contradicts: too little is shared
    remedies = REMEDIES if result.encounters else WITHOUT_SIGHTING
    return remedies.get(first, remedies[""])


REMEDIES = {
    OTHERS: "A second observation would tell the two places apart; so would maps that share more.",
    **dict.fromkeys(
        ("contradiction", "unbent"),
        "Are these maps of one building? Check the observation's numbers; a second observation may find a "
        "better place.",
    ),
    "across": "Let one of the robots drive on, so that the maps share more, and merge again; or give a "
    "second observation.",
    "misfit": "Check the observation's numbers, or widen the window.",
    "": "Let one of the robots drive on, so that the maps share more, or give a second observation.",
}
"""What would help, by what speaks most against a merge."""

WITHOUT_SIGHTING = {
    OTHERS: "A sighting of one robot by the other, or a rough initial pose, would tell the places apart; so "
    "would maps that share more.",
    **dict.fromkeys(
        ("contradiction", "unbent"),
        "Are these maps of one building? A sighting of one robot by the other, or a rough initial pose, may "
        "find a better place.",
    ),
    "misfit": "Check what was said to be known, or give it wider deviations.",
    "": "Let one of the robots drive on, so that the maps share more; or give a sighting of one robot by the "
    "other, or a rough initial pose.",
}
"""The same where no robot saw the other."""
