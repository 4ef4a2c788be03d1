"""The stages of the spectra method, a function for each. Their order is that of ``spectra_method.run``."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from math import hypot, radians

import numpy as np

from algorithms.common.pose import FloatArray, Pose2, pose_error
from algorithms.maps.grid_map import GridMap
from algorithms.methods.merge_result import Answer
from algorithms.methods.spectra_config import PipelineConfig
from algorithms.methods.steps import (
    AnswersDetail,
    AugmentDetail,
    CandidatesDetail,
    Detail,
    HoughDetail,
    ProofDetail,
    ProvenDetail,
    RefineDetail,
    ShiftDetail,
    WeighedDetail,
    WindowDetail,
)
from algorithms.observations.observation import Encounter
from algorithms.observations.search_window import (
    CoupledWindow,
    Window,
    coupled_window,
    paper_window,
    shift_window,
)
from algorithms.optimisation.branch_and_bound import MOST_RIVALS, prove
from algorithms.optimisation.covariance import covariance_of, peak_covariance
from algorithms.optimisation.likelihood_field import make_agreement
from algorithms.optimisation.monte_carlo import monte_carlo
from algorithms.optimisation.objective import Lookup, Objective, make_objective
from algorithms.optimisation.optimiser import Optimiser, SearchState
from algorithms.optimisation.particle_swarm import settled_within, swarm
from algorithms.optimisation.search_box import SearchBox, box_around
from algorithms.optimisation.subcell_peak import Peak, climb_to_peak, peak_at
from algorithms.spectra.augmented_map import AugmentConfig, augment
from algorithms.spectra.candidates import shift_candidates
from algorithms.verdict.decision import is_bent
from algorithms.verdict.probability_model import shipped_model
from algorithms.verdict.ranking import Weighed, better_beside, elsewhere, ranked, weigh
from algorithms.verdict.wall_evidence import PATCH
from algorithms.verdict.whole_maps import WholeMaps, make_whole_maps

GIVE_UP_AFTER = 15  # iterations
GIVE_UP_BELOW = 0.5  # of the best value so far
RIVAL_FLOOR = 0.5  # of the best value: what is below is no rival
LEAST_DEVIATION = 0.01  # metres; no pair of rasters is known to fit better

OPTIMISERS: dict[str, Optimiser] = {"pso": swarm, "mco": monte_carlo}


def augment_both(ref: GridMap, mov: GridMap, at: Encounter, config: AugmentConfig) -> AugmentDetail:
    """Both maps with their levels, eqs. (4), (5)."""
    sigma = config.covariance()
    return AugmentDetail(
        augment(ref, at.x_ref, sigma, config.intensity),
        augment(mov, at.x_mov, sigma, config.intensity),
    )


def search(
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
        ref,
        mov,
        encounters,
        config.augment,
        config.agreement,
        window,
        config.refine.lookup,
        config.verdict.robot_size,
    )


def values_in(
    objective: Objective, window: Window | CoupledWindow, box: SearchBox, poses: FloatArray
) -> FloatArray:
    """(P,) values of (P, 3) coordinates in a box; −inf outside a coupled window."""
    transforms = box.transforms(poses)
    values = objective(transforms)
    if isinstance(window, CoupledWindow):
        values[~window.contains(transforms)] = -np.inf
    return values


def _known(value: float | None) -> float:
    return -np.inf if value is None else value


def refine(found: CandidatesDetail, config: PipelineConfig, seed: int) -> Iterator[Detail]:
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

        def value(poses: FloatArray, box: SearchBox = box) -> FloatArray:
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


def prove_optimum(
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
    peak = climb_to_peak(smooth, start, window, config.augment.spread)
    distance, angle = pose_error(searched, peak.T_ref_mov, window.pivot)
    found_it = distance <= config.proof.distance and angle <= radians(config.proof.angle)
    yield ProvenDetail(state, peak, found_it and state.best is not None)


def doubts(refined: AnswersDetail, proven: ProvenDetail | None) -> list[str]:
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


def weigh_answers(
    ref: GridMap,
    mov: GridMap,
    encounters: Sequence[Encounter],
    refined: AnswersDetail,
    proven: ProvenDetail | None,
    config: PipelineConfig,
) -> WeighedDetail:
    """The best few answers by the whole maps. The likeliest is named, or the search's own best."""
    whole = whole_maps_of(ref, mov, encounters, config)
    few, model = _best_few(refined, proven, encounters[0], config), shipped_model()
    apart = config.proof.distance, radians(config.proof.angle)
    if not config.whole_maps:
        named, *others = (weigh(whole, T, model) for T in few)
        rivals = elsewhere(whole, named, others, *apart)
        return WeighedDetail((named, *better_beside(whole, named, model), *rivals))
    answers = ranked(whole, few, model, *apart)
    named, peak = answers[0], None
    if named.moved:
        peak = peak_at(whole.crisp, named.T_ref_mov, whole.window.pivot, config.augment.spread)
    return WeighedDetail(answers, peak)


def whole_maps_of(
    ref: GridMap, mov: GridMap, encounters: Sequence[Encounter], config: PipelineConfig
) -> WholeMaps:
    """Both maps as a whole, as these settings weigh them."""
    window = coupled_window(encounters, config.window)
    return make_whole_maps(ref, mov, encounters, window, config.agreement.evidence, config.verdict.robot_size)


def _best_few(
    refined: AnswersDetail, proven: ProvenDetail | None, at: Encounter, config: PipelineConfig
) -> list[Pose2]:
    """What the whole maps are asked about: the search's best, and others at least half as good."""
    if proven is not None:
        return [proven.peak.T_ref_mov, *map(Pose2.from_array, proven.state.rivals)]
    best = refined.answers[0]
    apart = others(
        [(answer.T_ref_mov, answer.value) for answer in refined.answers],
        at.x_mov,
        hypot(config.box.sigma_x, config.box.sigma_y),
        radians(2 * config.box.sigma_theta),
    )
    few = [T for T, value in apart if value > RIVAL_FLOOR * best.value > 0]
    return [best.T_ref_mov, *few[:MOST_RIVALS]]


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


def value_of(
    named: Weighed, refined: AnswersDetail, proven: ProvenDetail | None, objective: Objective
) -> float:
    """What the method's objective says of the named answer."""
    first = Answer(proven.peak.T_ref_mov, proven.peak.value, "") if proven else refined.answers[0]
    if named.T_ref_mov == first.T_ref_mov:
        return first.value
    return float(objective(named.T_ref_mov.array()[None])[0])


def peak_of(weighed: WeighedDetail, proven: ProvenDetail | None) -> Peak | None:
    """The peak that the named answer stands on; None where it is not known."""
    named = weighed.answers[0]
    if weighed.peak is not None:
        return weighed.peak
    return proven.peak if proven and named.T_ref_mov == proven.peak.T_ref_mov else None


def covariance_at(
    named: Weighed,
    objective: Objective,
    peak: Peak | None,
    window: Window | CoupledWindow,
    encounters: Sequence[Encounter],
    config: PipelineConfig,
) -> FloatArray:
    """(3, 3) of x, y, theta; m and rad. Calibrated for the agreement where its peak is known; of Γ, which
    is no likelihood, the width of its peak.

    Bent maps have no one transform: it differs from patch to patch by as much as patches slip.

    window : of the search, which cuts the optimiser's box around the answer
    """
    T = named.T_ref_mov
    if peak is None or config.refine.objective == "gamma":
        return peak_covariance(objective, T, box_around(T, window, config.box), config.augment.spread)
    coupled = coupled_window(encounters, config.window)
    widest = np.append(np.sqrt(np.diag(coupled.covariances[0])), radians(config.proof.angle))
    bend = named.evidence.slip if is_bent(named.evidence, config.verdict) else 0.0
    least = np.hypot(LEAST_DEVIATION, bend) * np.array([1.0, 1.0, 1 / PATCH])
    return covariance_of(peak, coupled.pivot, config.agreement.evidence, widest, least)
