"""The stages that all methods share: the sighting first; after the search the merged map and the verdict."""

from __future__ import annotations

from collections.abc import Callable, Generator, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from algorithms.common.pose import FloatArray, Pose2
from algorithms.maps.map_fusion import Fusion, fuse
from algorithms.methods.merge_result import Answer, MergeResult, PlaneScan
from algorithms.methods.stage_runner import StageCache, StageRunner
from algorithms.methods.steps import ObservationDetail, Step
from algorithms.observations.pair_problem import PairProblem
from algorithms.optimisation.branch_and_bound import ProofState
from algorithms.verdict.decision import judge
from algorithms.verdict.probability_model import ModelKind, shipped_model
from algorithms.verdict.ranking import Weighed


@dataclass(frozen=True, eq=False)
class Found:
    """What a search hands over.

    named      : the transform that it names, as the whole maps weigh it
    others     : other answers that may be the right one; None for a method that knows none
    covariance : (3, 3) of x, y, theta of the named one; metres and radians
    doubts     : what the search itself has against its answer, each a clause of a sentence
    kind       : of model that weighed the answers
    the rest   : as in MergeResult
    """

    named: Weighed
    others: Sequence[Weighed] | None
    covariance: FloatArray
    answers: tuple[Answer, ...]
    value: float | None
    doubts: Sequence[str] = ()
    proof: ProofState | None = None
    search_found_it: bool | None = None
    scan: PlaneScan | None = None
    kind: ModelKind = "sighting"


Search = Callable[[PairProblem, Any, int, StageRunner], Generator[Step, None, Found]]
"""Yields the steps of a method's own stages, of a problem, its config, the seed and what runs the stages."""


def run_search(
    search: Search,
    problem: PairProblem,
    config: Any,
    seed: int = 0,
    memo: StageCache | None = None,
    method: str = "",
) -> Iterator[Step]:
    """Yield every step of a merge; the last one's detail is the MergeResult.

    config : of the search; its ``conflict`` and ``verdict`` rule what follows
    seed   : the same seed gives the same answer. Every stage draws from a stream of its own, so that
             a change of one stage's settings doesn't change the random numbers of another
    memo   : keep it between runs: stages before the first changed setting are then not run again but
             given again (``Step.reused``)
    """
    runner = StageRunner({} if memo is None else memo)
    seen = (problem.observations, problem.priors, problem.ref.resolution, problem.mov.resolution)
    yield from runner.stage("observe", seen, lambda: [ObservationDetail(problem.encounters)])
    found = yield from search(problem, config, seed, runner)
    best = found.named.T_ref_mov
    fusion: Fusion = yield from runner.stage(
        "fuse",
        (problem, found.named, config.conflict, config.verdict.robot_size),
        lambda: [fuse_pair(problem, best, config)],
    )
    yield from runner.stage(
        "verdict",
        (fusion, found.answers, found.proof, config.verdict, method),
        lambda: [finish_merge(problem, found, fusion, config, method, seed, runner.timings_s)],
    )


def fuse_pair(problem: PairProblem, T_ref_mov: Pose2, config: Any) -> Fusion:
    """Both maps merged under a transform; raises TooLargeError where that would be over the bound."""
    robots = problem.robots(config.verdict.robot_size)
    return fuse((problem.ref, problem.mov), (Pose2(), T_ref_mov), config.conflict, robots)


def finish_merge(
    problem: PairProblem,
    found: Found,
    fusion: Fusion,
    config: Any,
    method: str,
    seed: int,
    timings_s: Mapping[str, float],
) -> MergeResult:
    """What has been found, judged.

    fusion    : of both maps under the named transform
    timings_s : seconds of each stage so far
    """
    model = shipped_model(found.kind)
    about = problem.pivot, config.verdict, found.doubts, model, bool(problem.observations)
    verdict = judge(fusion, found.named, found.others, *about)
    return MergeResult(
        T_ref_mov=found.named.T_ref_mov,
        covariance=found.covariance,
        value=found.value,
        verdict=verdict,
        kind=found.kind,
        fusion=fusion,
        encounters=problem.encounters,
        pivot=problem.pivot,
        answers=found.answers,
        method=method,
        seed=seed,
        weighed=(found.named, *(found.others or ())),
        proof=found.proof,
        search_found_it=found.search_found_it,
        scan=found.scan,
        timings_s=timings_s,
    )
