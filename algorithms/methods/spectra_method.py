"""The whole method as one generator of steps. Nothing else knows the order of the stages."""

from __future__ import annotations

from collections.abc import Iterator

from algorithms.common.pose import Pose2
from algorithms.maps.grid_map import GridMap
from algorithms.maps.map_fusion import Fusion, fuse
from algorithms.methods.spectra_answer import answer_of, weigh_answers
from algorithms.methods.spectra_config import PipelineConfig
from algorithms.methods.spectra_stages import augment_both, prove_optimum, refine, search
from algorithms.methods.stage_runner import StageCache, StageRunner
from algorithms.methods.steps import (
    AnswersDetail,
    AugmentDetail,
    CandidatesDetail,
    HoughDetail,
    ObservationDetail,
    ProvenDetail,
    Step,
    WeighedDetail,
)
from algorithms.observations.observation import Observation, encounters_of, robots_of
from algorithms.spectra.candidates import match_turns


def run(
    ref: GridMap,
    mov: GridMap,
    observations: tuple[Observation, ...],
    config: PipelineConfig,
    seed: int = 0,
    memo: StageCache | None = None,
    method: str = "spectra-swarm",
) -> Iterator[Step]:
    """Yield every step of the merge; the last one's detail is the MergeResult.

    seed : the same seed gives the same answer. Every stage draws from a stream of its own, so that
           a change of one stage's settings doesn't change the random numbers of another
    memo : keep it between runs: stages before the first changed setting are then not run again but
           told again (``Step.reused``)
    """
    runner = StageRunner({} if memo is None else memo)
    seen: ObservationDetail = yield from runner.stage(
        "observe",
        (observations, ref.resolution, mov.resolution),
        lambda: [ObservationDetail(encounters_of(observations, ref, mov))],
    )
    augmented: AugmentDetail = yield from runner.stage(
        "augment",
        (ref, mov, seen, config.augment),
        lambda: [augment_both(ref, mov, seen.encounter, config.augment)],
    )
    hough: HoughDetail = yield from runner.stage(
        "spectra",
        (augmented, config.spectra, config.candidates),
        lambda: [HoughDetail(match_turns(augmented.ref, augmented.mov, config.spectra, config.candidates))],
    )
    found: CandidatesDetail = yield from runner.stage(
        "search",
        (
            augmented,
            hough,
            config.window,
            config.box,
            config.swarm.particles,
            config.refine.lookup,
            config.refine.objective,
            config.refine.optimiser == "none",
            config.agreement,
            config.verdict.robot_size,
            seed,
        ),
        lambda: search(ref, mov, seen.encounters, augmented, hough, config, seed),
    )
    refined: AnswersDetail = yield from runner.stage(
        "refine",
        (found, config.box, config.swarm, config.refine, seed),
        lambda: refine(found, config, seed),
    )
    proven: ProvenDetail | None = None
    if config.proof.whole_circle:
        proven = yield from runner.stage(
            "prove", (refined, config.proof), lambda: prove_optimum(found, refined, seen.encounters, config)
        )
    weighed: WeighedDetail = yield from runner.stage(
        "weigh",
        (
            ref,
            mov,
            refined,
            proven,
            config.window,
            config.proof,
            config.whole_maps,
            config.verdict.robot_size,
        ),
        lambda: [weigh_answers(ref, mov, seen.encounters, refined, proven, config)],
    )
    best = weighed.answers[0].T_ref_mov
    fusion: Fusion = yield from runner.stage(
        "fuse",
        (ref, mov, weighed, config.conflict),
        lambda: [
            fuse(
                (ref, mov),
                (Pose2(), best),
                config.conflict,
                robots_of(seen.encounters, config.verdict.robot_size),
            )
        ],
    )
    yield from runner.stage(
        "verdict",
        (fusion, refined, proven, config.verdict, method),
        lambda: [
            answer_of(seen, found, refined, proven, weighed, fusion, config, method, seed, runner.timings_s)
        ],
    )
