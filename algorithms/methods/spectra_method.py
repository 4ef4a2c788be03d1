"""The order of the spectra method's stages. Nothing else knows it."""

from __future__ import annotations

from collections.abc import Generator

from algorithms.methods.shared_stages import Found
from algorithms.methods.spectra_answer import found_by, weigh_answers
from algorithms.methods.spectra_config import PipelineConfig
from algorithms.methods.spectra_stages import augment_both, first_look, prove_optimum, refine
from algorithms.methods.stage_runner import StageRunner
from algorithms.methods.steps import (
    AnswersDetail,
    AugmentDetail,
    CandidatesDetail,
    HoughDetail,
    ProvenDetail,
    Step,
    WeighedDetail,
)
from algorithms.observations.pair_problem import PairProblem
from algorithms.spectra.candidates import match_turns


def search(
    problem: PairProblem, config: PipelineConfig, seed: int, runner: StageRunner
) -> Generator[Step, None, Found]:
    """Yield the steps from the augmented maps to the answers that the whole maps have weighed."""
    augmented: AugmentDetail = yield from runner.stage(
        "augment",
        (problem, config.augment),
        lambda: [augment_both(problem, config.augment)],
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
        lambda: first_look(problem, augmented, hough, config, seed),
    )
    refined: AnswersDetail = yield from runner.stage(
        "refine",
        (found, config.box, config.swarm, config.refine, seed),
        lambda: refine(found, config, seed),
    )
    proven: ProvenDetail | None = None
    if config.proof.whole_circle:
        proven = yield from runner.stage(
            "prove", (refined, config.proof), lambda: prove_optimum(problem, found, refined, config)
        )
    weighed: WeighedDetail = yield from runner.stage(
        "weigh",
        (refined, proven, config.window, config.proof, config.whole_maps, config.verdict.robot_size),
        lambda: [weigh_answers(problem, refined, proven, config)],
    )
    return found_by(problem, found, refined, proven, weighed, config)
