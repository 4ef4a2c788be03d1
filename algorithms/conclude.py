"""The end of every way to a transform, a person's hand among them: the walls weighed, the verdict."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

from algorithms.certificate import ProofState
from algorithms.evidence import Evidence, evidence
from algorithms.fuse import Fusion
from algorithms.gridmap import GridMap
from algorithms.observation import Encounter
from algorithms.pose import FloatArray, Pose2
from algorithms.steps import Answer, MergeResult
from algorithms.verdict import Rival, VerdictConfig, judge


def conclude(
    ref: GridMap,
    mov: GridMap,
    T_ref_mov: Pose2,
    fusion: Fusion,
    encounters: tuple[Encounter, ...],
    covariance: Callable[[Evidence], FloatArray],
    rules: VerdictConfig,
    *,
    value: float | None,
    answers: tuple[Answer, ...],
    method: str,
    seed: int,
    rivals: Sequence[tuple[Pose2, float]] | None = None,
    margin: float = 0.0,
    doubts: Sequence[str] = (),
    proof: ProofState | None = None,
    search_found_it: bool | None = None,
    timings_s: Mapping[str, float] | None = None,
) -> MergeResult:
    """Judge a transform.

    fusion     : of both maps under it
    covariance : (3, 3) of x, y, theta, given what the walls say; m and rad
    rivals     : other answers with their share of this one's value, best first; None for a method that
                 knows none
    margin, doubts : as for ``judge``; the rest as in MergeResult
    """
    weighed = evidence(ref, mov, T_ref_mov)
    told = None
    if rivals is not None:
        told = [Rival(T, share, evidence(ref, mov, T)) for T, share in rivals]
    verdict = judge(fusion, weighed, T_ref_mov, encounters, told, rules, margin, doubts)
    return MergeResult(
        T_ref_mov=T_ref_mov,
        covariance=covariance(weighed),
        value=value,
        verdict=verdict,
        fusion=fusion,
        encounters=encounters,
        answers=answers,
        method=method,
        seed=seed,
        proof=proof,
        search_found_it=search_found_it,
        timings_s={} if timings_s is None else timings_s,
    )
