"""The whole method as one generator of steps. Nothing else knows the order of the stages."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from math import hypot, radians
from typing import Annotated, Literal

import numpy as np

from algorithms.agreement import AgreementConfig, make_agreement
from algorithms.augment import AugmentConfig, augment
from algorithms.bounds import Bounds, check_bounds
from algorithms.certificate import ProofConfig, prove
from algorithms.chain import Chain, Memo
from algorithms.conclude import conclude
from algorithms.covariance import peak_covariance
from algorithms.evidence import PATCH, Evidence
from algorithms.fuse import Conflict, Fusion, fuse
from algorithms.gridmap import GridMap
from algorithms.montecarlo import monte_carlo
from algorithms.objective import Lookup, Objective, make_objective
from algorithms.observation import Encounter, Observation, encounter
from algorithms.polish import Peak, covariance_of, polish
from algorithms.pose import FloatArray, Pose2, pose_error
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
    ObservationDetail,
    ProofDetail,
    ProvenDetail,
    RefineDetail,
    ShiftDetail,
    Step,
    WindowDetail,
)
from algorithms.swarm import SwarmConfig, settled_within, swarm
from algorithms.verdict import HALF, VerdictConfig, others
from algorithms.window import (
    Box,
    BoxConfig,
    CoupledWindow,
    Window,
    WindowConfig,
    box_around,
    coupled_window,
    paper_window,
    shift_window,
)

GIVE_UP_AFTER = 15  # iterations
GIVE_UP_BELOW = 0.5  # of the best value so far
RIVAL_FLOOR = HALF  # of the best value: what is below is no rival
LEAST_DEVIATION = 0.01  # metres; no pair of rasters is known to fit better

OPTIMISERS: dict[str, Optimiser] = {"pso": swarm, "mco": monte_carlo}


@dataclass(frozen=True)
class RefineConfig:
    """Which optimiser refines, and how many of the candidates."""

    optimiser: Literal["pso", "mco", "none"] = "pso"
    """PSO: a swarm that talks. MCO: independent samples. None: the spectra's own answers, as they are."""
    lookup: Lookup = Lookup.BILINEAR
    """Bilinear is smooth between cells; nearest is the paper's raster."""
    candidates: Annotated[int, Bounds(1, 24, 1, "", "", "refined")] = 4
    """How many of the best candidates the optimiser works on."""
    objective: Literal["gamma", "agreement"] = "gamma"
    """Gamma: eq. (17), ink on ink. Agreement: walls that coincide, less walls in the other's free floor."""

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
    agreement: AgreementConfig = field(default_factory=AgreementConfig)
    proof: ProofConfig = field(default_factory=ProofConfig)
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
    seen: ObservationDetail = yield from chain.stage(
        "observe",
        (observations,),
        lambda: [ObservationDetail(tuple(encounter(observation) for observation in observations))],
    )
    augmented: AugmentDetail = yield from chain.stage(
        "augment",
        (ref, mov, seen, config.augment),
        lambda: [augment_both(ref, mov, seen.encounter, config.augment)],
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
            config.refine.objective,
            config.refine.optimiser == "none",
            config.agreement,
            seed,
        ),
        lambda: _search(ref, mov, seen.encounters, augmented, hough, config, seed),
    )
    refined: AnswersDetail = yield from chain.stage(
        "refine",
        (found, config.box, config.swarm, config.refine, seed),
        lambda: _refine(found, config, seed),
    )
    proven: ProvenDetail | None = None
    if config.proof.whole_circle:
        proven = yield from chain.stage(
            "prove", (refined, config.proof), lambda: _prove(found, refined, seen.encounters, config)
        )
    best = proven.peak.T_ref_mov if proven else refined.answers[0].T_ref_mov
    fusion: Fusion = yield from chain.stage(
        "fuse",
        (ref, mov, refined, proven, config.conflict),
        lambda: [fuse(ref, mov, best, config.conflict)],
    )

    def judged() -> list[Detail]:
        peak = proven.peak if proven else None
        box = box_around(best, found.window, config.box)
        return [
            conclude(
                ref,
                mov,
                best,
                fusion,
                seen.encounters,
                lambda weighed: covariance_at(
                    best, found.objective, peak, box, seen.encounters, weighed, config
                ),
                config.verdict,
                value=peak.value if peak else refined.answers[0].value,
                answers=refined.answers,
                method=method,
                seed=seed,
                rivals=_rivals(refined, proven, seen.encounter, config),
                margin=config.window.margin,
                doubts=_doubts(refined, proven),
                proof=proven.state if proven else None,
                search_found_it=proven.search_found_it if proven else None,
                timings_s=chain.timings_s,
            )
        ]

    yield from chain.stage("verdict", (fusion, refined, proven, config.verdict, method), judged)


def augment_both(ref: GridMap, mov: GridMap, at: Encounter, config: AugmentConfig) -> AugmentDetail:
    """Both maps with their levels, eqs. (4), (5)."""
    sigma = config.covariance()
    return AugmentDetail(
        augment(ref, at.x_ref, sigma, config.intensity),
        augment(mov, at.x_mov, sigma, config.intensity),
    )


def _search(
    ref: GridMap,
    mov: GridMap,
    encounters: Sequence[Encounter],
    augmented: AugmentDetail,
    hough: HoughDetail,
    config: PipelineConfig,
    seed: int,
) -> Iterator[Detail]:
    """A candidate per turn, then a first look into the box of each, which ranks them by their value."""
    window = shift_window(encounters, config.window)
    coupled = coupled_window(encounters, config.window)
    yield WindowDetail(window, coupled, paper_window(encounters[0], replace(config.window, kind="origin")))
    candidates = []
    turns = shift_candidates(augmented.ref, augmented.mov, hough.match, window)
    for index, candidate in enumerate(turns):
        if isinstance(window, CoupledWindow):  # its rectangle reaches beyond the disc
            candidate = replace(candidate, T_ref_mov=window.pulled_in(candidate.T_ref_mov))
        yield ShiftDetail(index, len(hough.match.turns), candidate)
        candidates.append(candidate)
    objective = objective_of(ref, mov, encounters, augmented, config)
    looked = []
    for index, candidate in enumerate(candidates):
        if config.refine.optimiser == "none":
            value = float(objective(candidate.T_ref_mov.array()[None])[0])
            looked.append(replace(candidate, value=value))
            continue
        box = box_around(candidate.T_ref_mov, window, config.box)
        rng = np.random.default_rng([seed, 0, index])
        poses = rng.uniform(box.low, box.high, (config.swarm.particles, 3))
        poses[0] = box.centre
        looked.append(replace(candidate, value=float(values_in(objective, window, box, poses).max())))
    looked.sort(key=lambda candidate: -_known(candidate.value))
    yield CandidatesDetail(tuple(looked), objective, window)


def objective_of(
    ref: GridMap,
    mov: GridMap,
    encounters: Sequence[Encounter],
    augmented: AugmentDetail,
    config: PipelineConfig,
) -> Objective:
    """What the settings ask to maximise."""
    if config.refine.objective == "gamma":
        return make_objective(augmented.ref, augmented.mov, config.refine.lookup)
    window = coupled_window(encounters, config.window)
    return make_agreement(
        ref, mov, encounters, config.augment, config.agreement, window, config.refine.lookup
    )


def values_in(
    objective: Objective, window: Window | CoupledWindow, box: Box, poses: FloatArray
) -> FloatArray:
    """(P,) values of (P, 3) coordinates in a box; −inf outside a coupled window."""
    transforms = box.transforms(poses)
    values = objective(transforms)
    if isinstance(window, CoupledWindow):
        values[~window.contains(transforms)] = -np.inf
    return values


def _known(value: float | None) -> float:
    return -np.inf if value is None else value


def _refine(found: CandidatesDetail, config: PipelineConfig, seed: int) -> Iterator[Detail]:
    """The optimiser on each of the best candidates in turn."""
    if config.refine.optimiser == "none":
        yield AnswersDetail(
            tuple(
                Answer(candidate.T_ref_mov, _known(candidate.value), "not refined")
                for candidate in found.candidates
            )
        )
        return
    optimise = OPTIMISERS[config.refine.optimiser]
    settled = settled_within(found.objective.cell)
    refined = found.candidates[: config.refine.candidates]
    answers: list[Answer] = []
    for index, candidate in enumerate(refined):
        box = box_around(candidate.T_ref_mov, found.window, config.box)
        rng = np.random.default_rng([seed, 1, index])

        def value(poses: FloatArray, box: Box = box) -> FloatArray:
            return values_in(found.objective, found.window, box, poses)

        for state in optimise(value, box, config.swarm, settled, rng):
            if _hopeless(state, answers):
                state = replace(state, stopped=f"given up after {state.iteration + 1} iterations")
            yield RefineDetail(index, len(refined), box, state)
            if state.stopped:
                break
        answers.append(Answer(box.transform(state.best), state.best_value, state.stopped or ""))
    answers += [
        Answer(candidate.T_ref_mov, _known(candidate.value), "only looked at")
        for candidate in found.candidates[config.refine.candidates :]
    ]
    answers.sort(key=lambda answer: -answer.value)
    yield AnswersDetail(tuple(answers))


def _hopeless(state: SearchState, answers: Sequence[Answer]) -> bool:
    """Whether a candidate need not be followed to its end: it has had its time, and is far behind.

    What is given up has not even half of the best value so far, so it could neither win nor count as a
    rival.
    """
    best = max((answer.value for answer in answers), default=0.0)
    late = state.iteration + 1 >= GIVE_UP_AFTER
    return late and state.stopped is None and best > 0 and state.best_value < GIVE_UP_BELOW * best


def _prove(
    found: CandidatesDetail,
    refined: AnswersDetail,
    encounters: Sequence[Encounter],
    config: PipelineConfig,
) -> Iterator[Detail]:
    """The best of the whole circle, and whether the optimiser had found it."""
    window = coupled_window(encounters, config.window)
    # where nothing fits, the best of what does not fit is not worth the time to prove it
    for state in prove(found.objective, window, config.proof, RIVAL_FLOOR, worth=0.0):
        yield ProofDetail(state, window)
    searched = refined.answers[0].T_ref_mov
    start = searched if state.best is None else Pose2.from_array(state.best)
    smooth = replace(found.objective, lookup=Lookup.BILINEAR)
    peak = polish(smooth, start, window, config.augment.spread)
    distance, angle = pose_error(searched, peak.T_ref_mov, window.pivot)
    found_it = distance <= config.proof.distance and angle <= radians(config.proof.angle)
    yield ProvenDetail(state, peak, found_it and state.best is not None)


def _doubts(refined: AnswersDetail, proven: ProvenDetail | None) -> list[str]:
    """What the search itself has against its answer."""
    if proven is None:
        return [] if refined.answers[0].value > 0 else ["near the encounter no walls coincide"]
    if proven.state.empty:
        return ["the sightings contradict each other: no transform agrees with all of them"]
    if proven.state.proven:
        return []
    if proven.state.stopped and proven.state.ceiling <= 0:
        return ["wherever robot 2 may have stood, more wall contradicts than agrees"]
    return ["the search was stopped before it had ruled out a better place"]


def _rivals(
    refined: AnswersDetail, proven: ProvenDetail | None, at: Encounter, config: PipelineConfig
) -> list[tuple[Pose2, float]]:
    """Other answers with their share of the best value, those of less than half left out."""
    if proven is not None:
        state = proven.state
        pairs = zip(state.rivals, state.rival_values.tolist(), strict=True)
        return [(Pose2.from_array(pose), value / state.best_value) for pose, value in pairs]
    best = refined.answers[0].value
    if best <= 0:
        return []
    elsewhere = others(
        [(answer.T_ref_mov, answer.value) for answer in refined.answers],
        at.x_mov,
        hypot(config.box.sigma_x, config.box.sigma_y),
        radians(2 * config.box.sigma_theta),
    )
    return [(T, value / best) for T, value in elsewhere if value > RIVAL_FLOOR * best]


def covariance_at(
    T_ref_mov: Pose2,
    objective: Objective,
    peak: Peak | None,
    box: Box,
    encounters: Sequence[Encounter],
    weighed: Evidence,
    config: PipelineConfig,
) -> FloatArray:
    """(3, 3) of x, y, theta; m and rad. Calibrated for the agreement where its peak is known; of Γ, which
    is no likelihood, the width of its peak.

    Bent maps have no one transform: it differs from patch to patch by as much as patches slip.

    box : the optimiser's, around the transform
    """
    if peak is None or config.refine.objective == "gamma":
        return peak_covariance(objective, T_ref_mov, box, config.augment.spread)
    window = coupled_window(encounters, config.window)
    widest = np.append(np.sqrt(np.diag(window.covariances[0])), radians(config.proof.angle))
    bend = weighed.slip if weighed.rigid_contradiction > config.verdict.contradiction else 0.0
    least = np.hypot(LEAST_DEVIATION, bend) * np.array([1.0, 1.0, 1 / PATCH])
    return covariance_of(peak, window.pivot, config.agreement.evidence, widest, least)
