"""The stages of the spectra method up to the proof, a function for each, in the order of their calls."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from math import radians

import numpy as np

from algorithms.common.pose import FloatArray, Pose2, pose_error
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
    WindowDetail,
)
from algorithms.observations.pair_problem import PairProblem
from algorithms.observations.search_window import CoupledWindow, Window, paper_window, shift_window
from algorithms.optimisation.branch_and_bound import prove
from algorithms.optimisation.likelihood_field import make_agreement
from algorithms.optimisation.monte_carlo import monte_carlo
from algorithms.optimisation.objective import Lookup, Objective, make_objective
from algorithms.optimisation.optimiser import Optimiser, SearchState
from algorithms.optimisation.particle_swarm import settled_within, swarm
from algorithms.optimisation.search_box import SearchBox, box_around
from algorithms.optimisation.subcell_peak import climb_to_peak
from algorithms.spectra.augmented_map import AugmentConfig, augment
from algorithms.spectra.candidates import Candidate, shift_candidates

GIVE_UP_AFTER = 15  # iterations
GIVE_UP_BELOW = 0.5  # of the best value so far
RIVAL_FLOOR = 0.5  # of the best value: what is below is no rival

OPTIMISERS: dict[str, Optimiser] = {"pso": swarm, "mco": monte_carlo}


def augment_both(problem: PairProblem, config: AugmentConfig) -> AugmentDetail:
    """Both maps with their levels, eqs. (4), (5)."""
    at, sigma = problem.encounters[0], config.covariance()
    return AugmentDetail(
        augment(problem.ref, at.x_ref, sigma, config.intensity),
        augment(problem.mov, at.x_mov, sigma, config.intensity),
    )


def first_look(
    problem: PairProblem, augmented: AugmentDetail, hough: HoughDetail, config: PipelineConfig, seed: int
) -> Iterator[Detail]:
    """A candidate per turn, then a first look into the box of each, which ranks them by their value."""
    encounters = problem.encounters
    coupled = problem.window(config.window)
    window = shift_window(encounters, coupled, config.window)
    yield WindowDetail(window, coupled, paper_window(encounters[0], replace(config.window, kind="origin")))
    candidates = []
    turns = shift_candidates(augmented.ref, augmented.mov, hough.match, window)
    for index, candidate in enumerate(turns):
        if isinstance(window, CoupledWindow):  # its rectangle reaches beyond the disc
            candidate = replace(candidate, T_ref_mov=window.pulled_in(candidate.T_ref_mov))
        yield ShiftDetail(index, len(hough.match.turns), candidate)
        candidates.append(candidate)
    objective = objective_of(problem, augmented, config)
    looked = []
    for index, candidate in enumerate(candidates):
        if config.refine.optimiser == "none":
            looked.append(replace(candidate, value=objective.value_at(candidate.T_ref_mov)))
            continue
        box = box_around(candidate.T_ref_mov, window, config.box)
        rng = np.random.default_rng([seed, 0, index])
        poses = rng.uniform(box.low, box.high, (config.swarm.particles, 3))
        poses[0] = box.centre
        looked.append(replace(candidate, value=float(values_in(objective, window, box, poses).max())))
    looked.sort(key=lambda candidate: -_known(candidate.value))
    yield CandidatesDetail(tuple(looked), objective, window)


def objective_of(problem: PairProblem, augmented: AugmentDetail, config: PipelineConfig) -> Objective:
    """What the settings ask to maximise."""
    if config.refine.objective == "gamma":
        return make_objective(augmented.ref, augmented.mov, config.refine.lookup)
    return make_agreement(
        problem.ref,
        problem.mov,
        problem.encounters,
        config.augment,
        config.agreement,
        problem.window(config.window),
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


def _answers(candidates: Sequence[Candidate], stopped: str) -> tuple[Answer, ...]:
    return tuple(Answer(each.T_ref_mov, _known(each.value), stopped) for each in candidates)


def refine(found: CandidatesDetail, config: PipelineConfig, seed: int) -> Iterator[Detail]:
    """The optimiser on each of the best candidates in turn."""
    if config.refine.optimiser == "none":
        yield AnswersDetail(_answers(found.candidates, "not refined"))
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
    answers += _answers(found.candidates[config.refine.candidates :], "only looked at")
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
    problem: PairProblem, found: CandidatesDetail, refined: AnswersDetail, config: PipelineConfig
) -> Iterator[Detail]:
    """The best of the whole circle, and whether the optimiser had found it."""
    window = problem.window(config.window)
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
