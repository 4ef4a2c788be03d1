"""The end of every way to a transform, a person's hand among them: the walls weighed, the verdict."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from algorithms.common.pose import FloatArray
from algorithms.maps.map_fusion import Fusion
from algorithms.methods.steps import Answer, MergeResult
from algorithms.observations.observation import Encounter
from algorithms.optimisation.branch_and_bound import ProofState
from algorithms.verdict.decision import VerdictConfig, judge
from algorithms.verdict.ranking import Weighed


def conclude(
    named: Weighed,
    others: Sequence[Weighed] | None,
    fusion: Fusion,
    encounters: tuple[Encounter, ...],
    covariance: FloatArray,
    rules: VerdictConfig,
    *,
    value: float | None,
    answers: tuple[Answer, ...],
    method: str,
    seed: int,
    doubts: Sequence[str] = (),
    proof: ProofState | None = None,
    search_found_it: bool | None = None,
    timings_s: Mapping[str, float] | None = None,
) -> MergeResult:
    """Judge a transform.

    named, others, doubts : as for ``judge``
    fusion     : of both maps under it
    covariance : (3, 3) of x, y, theta; m and rad
    the rest   : as in MergeResult
    """
    return MergeResult(
        T_ref_mov=named.T_ref_mov,
        covariance=covariance,
        value=value,
        verdict=judge(fusion, named, others, encounters[0].x_mov, rules, doubts),
        fusion=fusion,
        encounters=encounters,
        answers=answers,
        method=method,
        seed=seed,
        weighed=(named, *(others or ())),
        proof=proof,
        search_found_it=search_found_it,
        timings_s={} if timings_s is None else timings_s,
    )
