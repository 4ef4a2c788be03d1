"""The answer of the spectra method: weighed by the whole maps, with its doubts, its value, its covariance."""

from __future__ import annotations

from math import hypot, radians

import numpy as np

from algorithms.common.pose import FloatArray, Pose2, pose_error
from algorithms.methods.merge_result import Answer
from algorithms.methods.shared_stages import Found
from algorithms.methods.spectra_config import PipelineConfig
from algorithms.methods.spectra_stages import RIVAL_FLOOR
from algorithms.methods.steps import AnswersDetail, CandidatesDetail, ProvenDetail, WeighedDetail
from algorithms.observations.pair_problem import PairProblem
from algorithms.observations.search_window import CoupledWindow, Window
from algorithms.optimisation.branch_and_bound import MOST_RIVALS
from algorithms.optimisation.covariance import covariance_of, peak_covariance
from algorithms.optimisation.objective import Objective
from algorithms.optimisation.search_box import box_around
from algorithms.optimisation.subcell_peak import Peak, peak_at
from algorithms.verdict.decision import VerdictConfig, is_bent
from algorithms.verdict.probability_model import shipped_model
from algorithms.verdict.ranking import Weighed, better_beside, elsewhere, ranked, weigh
from algorithms.verdict.slipping_patches import PATCH
from algorithms.verdict.whole_maps import WholeMaps, make_whole_maps

LEAST_DEVIATION = 0.01  # metres; no pair of rasters is known to fit better


def weigh_answers(
    problem: PairProblem, refined: AnswersDetail, proven: ProvenDetail | None, config: PipelineConfig
) -> WeighedDetail:
    """The best few answers by the whole maps. The likeliest is named, or the search's own best."""
    whole = whole_maps_of(problem, config)
    few, model = _best_few(refined, proven, problem.pivot, config), shipped_model()
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


def whole_maps_of(problem: PairProblem, config: PipelineConfig) -> WholeMaps:
    """Both maps as a whole, as these settings weigh them."""
    window = problem.window(config.window)
    robots = problem.robots(config.verdict.robot_size)
    return make_whole_maps(problem.ref, problem.mov, robots, window, config.agreement.evidence)


def _best_few(
    refined: AnswersDetail, proven: ProvenDetail | None, pivot: FloatArray, config: PipelineConfig
) -> list[Pose2]:
    """What the whole maps are asked about: the search's best, and others at least half as good."""
    if proven is not None:
        return [proven.peak.T_ref_mov, *map(Pose2.from_array, proven.state.rivals)]
    distance = hypot(config.box.sigma_x, config.box.sigma_y)
    angle = radians(2 * config.box.sigma_theta)
    kept: list[Answer] = []  # each elsewhere than those before it
    for answer in refined.answers:
        apart = [pose_error(answer.T_ref_mov, known.T_ref_mov, pivot) for known in kept]
        if all(metres > distance or turn > angle for metres, turn in apart):
            kept.append(answer)
    best, *others = kept
    few = [other.T_ref_mov for other in others if other.value > RIVAL_FLOOR * best.value > 0]
    return [best.T_ref_mov, *few[:MOST_RIVALS]]


def found_by(
    problem: PairProblem,
    found: CandidatesDetail,
    refined: AnswersDetail,
    proven: ProvenDetail | None,
    weighed: WeighedDetail,
    config: PipelineConfig,
) -> Found:
    named, *others = weighed.answers
    peak = weighed.peak
    if peak is None and proven and named.T_ref_mov == proven.peak.T_ref_mov:
        peak = proven.peak
    first, T = proven.peak if proven else refined.answers[0], named.T_ref_mov
    value = first.value if first.T_ref_mov == T else found.objective.value_at(T)
    return Found(
        named,
        others,
        covariance_at(named, found.objective, peak, found.window, problem, config),
        refined.answers,
        value,
        doubts=_doubts(refined, proven),
        proof=proven.state if proven else None,
        search_found_it=proven.search_found_it if proven else None,
    )


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


def covariance_at(
    named: Weighed,
    objective: Objective,
    peak: Peak | None,
    window: Window | CoupledWindow,
    problem: PairProblem,
    config: PipelineConfig,
) -> FloatArray:
    """(3, 3) of x, y, theta; m and rad. Calibrated for the agreement where its peak is known; of Γ, which
    is no likelihood, the width of its peak.

    window : of the search, which cuts the optimiser's box around the answer
    """
    T = named.T_ref_mov
    if peak is None or config.refine.objective == "gamma":
        return peak_covariance(objective, T, box_around(T, window, config.box), config.augment.spread)
    coupled = problem.window(config.window)
    widest = np.append(np.sqrt(np.diag(coupled.covariances[0])), radians(config.proof.angle))
    least = least_deviations(named, config.verdict)
    return covariance_of(peak, coupled.pivot, config.agreement.evidence, widest, least)


def least_deviations(named: Weighed, rules: VerdictConfig) -> FloatArray:
    """(3,) standard deviations of x, y, theta that no answer is without; metres, metres, radians.

    Bent maps have no one transform: it differs from patch to patch by as much as patches slip.
    """
    bend = named.evidence.slip if is_bent(named.evidence, rules) else 0.0
    return np.asarray(np.hypot(LEAST_DEVIATION, bend) * np.array([1.0, 1.0, 1 / PATCH]), dtype=np.float64)
