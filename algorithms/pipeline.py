"""The whole method as one generator of steps. Nothing else knows the order of the stages."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from math import hypot, pi
from typing import Annotated, Literal

import numpy as np

from algorithms.augment import AugmentConfig, augment
from algorithms.bounds import Bounds, check_bounds
from algorithms.chain import Chain, Memo
from algorithms.covariance import peak_covariance
from algorithms.fuse import Conflict, Fusion, fuse
from algorithms.gridmap import GridMap
from algorithms.montecarlo import monte_carlo
from algorithms.objective import Lookup, make_objective
from algorithms.observation import Encounter, Observation, encounter
from algorithms.pose import FloatArray
from algorithms.search import Optimiser, SearchState
from algorithms.smm import CandidateConfig, match_turns, shift_candidates
from algorithms.spectra import SpectraConfig
from algorithms.steps import (
    Answer,
    AnswersDetail,
    AugmentDetail,
    CandidatesDetail,
    Detail,
    HoughDetail,
    MergeResult,
    ObservationDetail,
    RefineDetail,
    ShiftDetail,
    Step,
    WindowDetail,
)
from algorithms.swarm import SwarmConfig, settled_within, swarm
from algorithms.verdict import VerdictConfig, ambiguity_of, judge
from algorithms.window import Box, BoxConfig, WindowConfig, box_around, paper_window

GIVE_UP_AFTER = 15  # iterations
GIVE_UP_BELOW = 0.5  # of the best Γ so far

OPTIMISERS: dict[str, Optimiser] = {"pso": swarm, "mco": monte_carlo}


@dataclass(frozen=True)
class RefineConfig:
    """Which optimiser refines, and how many of the candidates."""

    optimiser: Literal["pso", "mco"] = "pso"
    """PSO: a swarm that talks. MCO: independent samples."""
    lookup: Lookup = Lookup.BILINEAR
    """Bilinear is smooth between cells; nearest is the paper's raster."""
    candidates: Annotated[int, Bounds(1, 24, 1, "", "", "refined")] = 4
    """How many of the best candidates the optimiser works on."""

    def __post_init__(self) -> None:
        check_bounds(self)


@dataclass(frozen=True)
class PipelineConfig:
    """All settings of the method, a group per stage."""

    augment: AugmentConfig = field(default_factory=AugmentConfig)
    spectra: SpectraConfig = field(default_factory=SpectraConfig)
    candidates: CandidateConfig = field(default_factory=CandidateConfig)
    window: WindowConfig = field(default_factory=WindowConfig)
    box: BoxConfig = field(default_factory=BoxConfig)
    swarm: SwarmConfig = field(default_factory=SwarmConfig)
    refine: RefineConfig = field(default_factory=RefineConfig)
    verdict: VerdictConfig = field(default_factory=VerdictConfig)
    conflict: Conflict = Conflict.OCCUPIED_WINS
    """Which map is believed where one says wall and the other says free."""


def run(
    ref: GridMap,
    mov: GridMap,
    observations: tuple[Observation, ...],
    config: PipelineConfig,
    seed: int = 0,
    memo: Memo | None = None,
    method: str = "spectra-swarm",
) -> Iterator[Step]:
    """Yield every step of the merge; the last one's detail is the MergeResult.

    seed : the same seed gives the same answer. Every stage draws from a stream of its own, so that
           a change of one stage's settings doesn't change the luck of another
    memo : keep it between runs: stages before the first changed setting are then not run again but
           told again (``Step.reused``)
    """
    chain = Chain({} if memo is None else memo)
    at: Encounter = (
        yield from chain.stage("observe", (observations,), lambda: [_observe(observations)])
    ).encounter
    augmented: AugmentDetail = yield from chain.stage(
        "augment", (ref, mov, at, config.augment), lambda: [_augment(ref, mov, at, config.augment)]
    )
    hough: HoughDetail = yield from chain.stage(
        "spectra",
        (augmented, config.spectra, config.candidates),
        lambda: [HoughDetail(match_turns(augmented.ref, augmented.mov, config.spectra, config.candidates))],
    )
    found: CandidatesDetail = yield from chain.stage(
        "search",
        (
            augmented,
            hough,
            config.window,
            config.box,
            config.swarm.particles,
            config.refine.lookup,
            seed,
        ),
        lambda: _search(at, augmented, hough, config, seed),
    )
    refined: AnswersDetail = yield from chain.stage(
        "refine",
        (found, config.box, config.swarm, config.refine, seed),
        lambda: _refine(found, config, seed),
    )
    best = refined.answers[0]
    fusion: Fusion = yield from chain.stage(
        "fuse",
        (ref, mov, refined, config.conflict),
        lambda: [fuse(ref, mov, best.T_ref_mov, config.conflict)],
    )
    yield from chain.stage(
        "verdict",
        (fusion, refined, config.verdict, method),
        lambda: [
            MergeResult(
                T_ref_mov=best.T_ref_mov,
                covariance=peak_covariance(
                    found.objective,
                    best.T_ref_mov,
                    box_around(best.T_ref_mov, found.window, config.box),
                    config.augment.spread,
                ),
                value=best.value,
                verdict=judge(
                    fusion, best.T_ref_mov, at, _ambiguity(refined, at, config.box), config.verdict
                ),
                fusion=fusion,
                encounter=at,
                answers=refined.answers,
                method=method,
                seed=seed,
                timings_s=chain.timings_s,
            )
        ],
    )


def _observe(observations: tuple[Observation, ...]) -> ObservationDetail:
    return ObservationDetail(tuple(encounter(observation) for observation in observations))


def _augment(ref: GridMap, mov: GridMap, at: Encounter, config: AugmentConfig) -> AugmentDetail:
    sigma = config.covariance()
    return AugmentDetail(
        augment(ref, at.x_ref, sigma, config.intensity),
        augment(mov, at.x_mov, sigma, config.intensity),
    )


def _search(
    at: Encounter, augmented: AugmentDetail, hough: HoughDetail, config: PipelineConfig, seed: int
) -> Iterator[Detail]:
    """A candidate per turn, then a first look into the box of each, which ranks them by Γ."""
    window = paper_window(at, config.window)
    yield WindowDetail(window)
    candidates = []
    turns = shift_candidates(augmented.ref, augmented.mov, hough.match, window)
    for index, candidate in enumerate(turns):
        yield ShiftDetail(index, len(hough.match.turns), candidate)
        candidates.append(candidate)
    objective = make_objective(augmented.ref, augmented.mov, config.refine.lookup)
    looked = []
    for index, candidate in enumerate(candidates):
        box = box_around(candidate.T_ref_mov, window, config.box)
        rng = np.random.default_rng([seed, 0, index])
        poses = rng.uniform(box.low, box.high, (config.swarm.particles, 3))
        poses[0] = box.centre
        looked.append(replace(candidate, value=float(objective(box.transforms(poses)).max())))
    looked.sort(key=lambda candidate: -(candidate.value or 0.0))
    yield CandidatesDetail(tuple(looked), objective, window)


def _refine(found: CandidatesDetail, config: PipelineConfig, seed: int) -> Iterator[Detail]:
    """The optimiser on each of the best candidates in turn."""
    optimise = OPTIMISERS[config.refine.optimiser]
    settled = settled_within(found.objective.cell)
    refined = found.candidates[: config.refine.candidates]
    answers: list[Answer] = []
    for index, candidate in enumerate(refined):
        box = box_around(candidate.T_ref_mov, found.window, config.box)
        rng = np.random.default_rng([seed, 1, index])

        def value(poses: FloatArray, box: Box = box) -> FloatArray:
            return found.objective(box.transforms(poses))

        for state in optimise(value, box, config.swarm, settled, rng):
            if _hopeless(state, answers):
                state = replace(state, stopped=f"given up after {state.iteration + 1} iterations")
            yield RefineDetail(index, len(refined), box, state)
            if state.stopped:
                break
        answers.append(Answer(box.transform(state.best), state.best_value, state.stopped or ""))
    answers += [
        Answer(candidate.T_ref_mov, candidate.value or 0.0, "only looked at")
        for candidate in found.candidates[config.refine.candidates :]
    ]
    answers.sort(key=lambda answer: -answer.value)
    yield AnswersDetail(tuple(answers))


def _hopeless(state: SearchState, answers: Sequence[Answer]) -> bool:
    """Whether a candidate need not be followed to its end: it has had its time, and is far behind.

    What is given up has not even half of the best Γ, so it could neither win nor count as a rival.
    """
    best = max((answer.value for answer in answers), default=0.0)
    late = state.iteration + 1 >= GIVE_UP_AFTER
    return late and state.stopped is None and state.best_value < GIVE_UP_BELOW * best


def _ambiguity(refined: AnswersDetail, at: Encounter, box: BoxConfig) -> float:
    """Γ of the best answer outside the winner's own box over the winner's."""
    return ambiguity_of(
        [(answer.T_ref_mov, answer.value) for answer in refined.answers],
        at.x_mov,
        hypot(box.sigma_x, box.sigma_y),
        2 * box.sigma_theta * pi / 180,
    )
