"""The answer of the spectra method: weighed by the whole maps, with its doubts, its value, its covariance."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import hypot, radians

import numpy as np

from algorithms.common.pose import FloatArray, Pose2, pose_error
from algorithms.maps.grid_map import GridMap
from algorithms.maps.map_fusion import Fusion
from algorithms.methods.merge_result import Answer, MergeResult, finish_merge
from algorithms.methods.spectra_config import PipelineConfig
from algorithms.methods.spectra_stages import RIVAL_FLOOR
from algorithms.methods.steps import (
    AnswersDetail,
    CandidatesDetail,
    ObservationDetail,
    ProvenDetail,
    WeighedDetail,
)
from algorithms.observations.observation import Encounter
from algorithms.observations.search_window import CoupledWindow, Window, coupled_window
from algorithms.optimisation.branch_and_bound import MOST_RIVALS
from algorithms.optimisation.covariance import covariance_of, peak_covariance
from algorithms.optimisation.objective import Objective
from algorithms.optimisation.search_box import box_around
from algorithms.optimisation.subcell_peak import Peak, peak_at
from algorithms.verdict.decision import is_bent
from algorithms.verdict.probability_model import shipped_model
from algorithms.verdict.ranking import Weighed, better_beside, elsewhere, ranked, weigh
from algorithms.verdict.slipping_patches import PATCH
from algorithms.verdict.whole_maps import WholeMaps, make_whole_maps

LEAST_DEVIATION = 0.01  # metres; no pair of rasters is known to fit better


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


def answer_of(
    seen: ObservationDetail,
    found: CandidatesDetail,
    refined: AnswersDetail,
    proven: ProvenDetail | None,
    weighed: WeighedDetail,
    fusion: Fusion,
    config: PipelineConfig,
    method: str,
    seed: int,
    timings_s: Mapping[str, float],
) -> MergeResult:
    """What all stages have come to, judged.

    timings_s : seconds of each stage so far
    """
    named, *others = weighed.answers
    peak = _peak_of(weighed, proven)
    return finish_merge(
        named,
        others,
        fusion,
        seen.encounters,
        covariance_at(named, found.objective, peak, found.window, seen.encounters, config),
        config.verdict,
        value=_value_of(named, refined, proven, found.objective),
        answers=refined.answers,
        method=method,
        seed=seed,
        doubts=_doubts(refined, proven),
        proof=proven.state if proven else None,
        search_found_it=proven.search_found_it if proven else None,
        timings_s=timings_s,
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


def _value_of(
    named: Weighed, refined: AnswersDetail, proven: ProvenDetail | None, objective: Objective
) -> float:
    """What the method's objective says of the named answer."""
    first = Answer(proven.peak.T_ref_mov, proven.peak.value, "") if proven else refined.answers[0]
    if named.T_ref_mov == first.T_ref_mov:
        return first.value
    return float(objective(named.T_ref_mov.array()[None])[0])


def _peak_of(weighed: WeighedDetail, proven: ProvenDetail | None) -> Peak | None:
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
