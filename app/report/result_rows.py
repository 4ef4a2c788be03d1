"""The numbers of a result and of a sighting, as rows that page, report and replay show."""

from __future__ import annotations

from collections.abc import Iterable
from math import degrees, isfinite, sqrt
from typing import Any

import numpy as np

from algorithms.common.pose import Pose2, pose_error
from algorithms.common.robot_names import RobotNames
from algorithms.maps.map_fusion import fuse
from algorithms.methods.merge_result import MergeResult
from algorithms.observations.observation import Encounter, Observation
from algorithms.observations.priors import InitialPose, Prior, TurnPrior
from algorithms.verdict.performance_index import performance_index
from app.model import status_text as words
from app.model import verdict_text
from app.model.merge_inputs import MergeInputs
from app.model.objective_label import measure_of

STAGES = {
    "observe": "observation",
    "augment": "augmentation",
    "spectra": "Hough spectra",
    "match": "matched features",
    "search": "candidates",
    "refine": "swarm",
    "prove": "proof",
    "correlate": "plane",
    "climb": "hilltops",
    "weigh": "whole maps",
    "fuse": "merged cells",
    "verdict": "verdict",
    "explain": "cause of the refusal",
}


def numbers(result: MergeResult, inputs: MergeInputs, config: Any = None) -> list[tuple[str, ...]]:
    """The transform with its standard deviations, its value, and the figures of merit."""
    return named(_numbers(result, inputs, config), inputs.names)


def named(rows: Iterable[tuple[str, ...]], names: RobotNames) -> list[tuple[str, ...]]:
    """Rows on robot 1 and robot 2, with the robots' names in them."""
    return [tuple(map(names.told, row)) for row in rows]


def _numbers(result: MergeResult, inputs: MergeInputs, config: Any) -> list[tuple[str, ...]]:
    T, verdict = result.T_ref_mov, result.verdict
    at_robot, turn = _deviations(result)
    rows: list[tuple[str, ...]] = [("made", result.method)] if result.by_person else []
    rows += [
        ("T: Δx", f"{T.x:.3f} m"),
        ("T: Δy", f"{T.y:.3f} m"),
        ("T: Δθ", f"{degrees(T.theta):.2f} ± {degrees(turn):.2f}°"),
        ("robot 2's place, 1 σ" if result.encounters else "map 2's middle, 1 σ", f"± {at_robot:.3f} m"),
    ]
    if result.value is not None and isfinite(result.value):
        measure = measure_of(config)
        digits = ".2f" if measure.unit else ".5g"
        rows.append((measure.row, f"{result.value:{digits}}"))
    truth = inputs.truth.T_ref_mov if inputs.truth else None
    if truth is not None and inputs.ref is not None and inputs.mov is not None:
        true = fuse((inputs.ref, inputs.mov), (Pose2(), truth))
        over, index = "over the true overlap", performance_index(result.fusion, true)
    else:
        over, index = "at the estimated T", performance_index(result.fusion)
    rows.append((f"eq. (23), {over}", "–" if index is None else f"{index:.1%}"))
    if truth is not None and inputs.ref is not None and inputs.mov is not None:
        apart, turned = pose_error(result.T_ref_mov, truth, result.pivot)
        wrong = "" if inputs.truth.allows(apart, turned) else "✗ WRONG: "
        rows.append((f"{wrong}error to the truth", f"{apart:.3f} m, {degrees(turned):.2f}°"))
    rows += [
        ("likely right", verdict_text.likelihood(verdict.probability)),
        ("acceptance index", f"{verdict.acceptance_index:.1%}"),
        ("area known to both", f"{verdict.overlap_area:.1f} m²"),
        ("wall in view of both", f"{verdict.shared_wall:.1f} m"),
        ("contradicted, patches slipped", f"{verdict.contradiction:.1%}"),
        ("contradicted, as the maps are", f"{verdict.rigid_contradiction:.1%}"),
        ("agreeing wall across the others", f"{verdict.wall_across:.1f} m"),
        *_moved(result),
        *_deviation(result),
        *_rivals(result),
        *_proof(result),
        *_resampled(result),
        ("seed", f"{result.seed}"),
    ]
    return rows


def _deviation(result: MergeResult) -> list[tuple[str, ...]]:
    """How far the answer is from what is known, if anything is."""
    if not result.weighed or not result.weighed[0].deviations:
        return []
    label = "robot 2 off its sighting" if result.encounters else "off what is known"
    return [(label, f"{result.verdict.deviation:.1f} σ")]


def _rivals(result: MergeResult) -> list[tuple[str, ...]]:
    """The next best place, and the one that leaves the answer in doubt."""
    if result.verdict.ambiguity is None:
        return []
    next_best, rival = verdict_text.odds_of_rival(result.verdict), verdict_text.rival(result)
    return [("next best place", next_best), *([("rival in doubt", rival)] if rival else [])]


def _moved(result: MergeResult) -> list[tuple[str, ...]]:
    """By how much the whole maps moved the search's answer, and what was taken for a robot."""
    rows: list[tuple[str, ...]] = []
    if result.weighed and (named := result.weighed[0]).moved:
        rows.append(("moved by the whole maps", words.apart(named.T_ref_mov, named.began, result)))
    if result.verdict.cleared_cells:
        rows.append(("cells of robots, cleared", f"{result.verdict.cleared_cells:,}"))
    return rows


def _proof(result: MergeResult) -> list[tuple[str, ...]]:
    """Whether there can be a better answer, and whether the search alone had found this one."""
    rows: list[tuple[str, ...]] = []
    if result.scan is not None:
        rows.append(("optimum", verdict_text.searched(result)))
    if result.proof is None:
        return rows
    if result.scan is None:
        rows.append(("optimum", verdict_text.optimum(result.proof)))
    rows.append(("blocks bounded", f"{result.proof.nodes:,}"))
    if result.proven_optimal and result.search_found_it is not None:
        rows.append(("found by the search", "yes" if result.search_found_it else "no"))
    return rows


def _resampled(result: MergeResult) -> list[tuple[str, ...]]:
    """Which map came in coarser cells than the merged one's."""
    changed = verdict_text.resampled(result.fusion)
    return [("resampled", changed)] if changed else []


def _deviations(result: MergeResult) -> tuple[float, float]:
    """Standard deviations of the answer: metres at robot 2 (the larger axis), radians of the turn.

    Those of (Δx, Δy) alone say little: they are taken at map 2's origin, which may lie far away.
    """
    x, y = (result.T_ref_mov.apply(result.pivot) - result.T_ref_mov.xy).tolist()
    jacobian = np.array([[1.0, 0.0, -y], [0.0, 1.0, x]])
    at_robot = jacobian @ result.covariance @ jacobian.T
    return sqrt(max(0.0, float(np.linalg.eigvalsh(at_robot)[-1]))), sqrt(max(0.0, result.covariance[2, 2]))


def times(result: MergeResult) -> list[tuple[str, ...]]:
    """Milliseconds per stage, and their sum."""
    seconds = result.timings_s | {"all": sum(result.timings_s.values())}
    return [(STAGES.get(stage, stage), f"{1000 * took:.1f}") for stage, took in seconds.items()]


def prior_rows(prior: Prior) -> list[tuple[str, ...]]:
    """What is roughly known, and how roughly."""
    if isinstance(prior, InitialPose):
        T, sigma_yaw = prior.pose, degrees(prior.sigma_yaw)
        rows: list[tuple[str, ...]] = [
            ("map 2 lies about at", f"{T.x:.2f}, {T.y:.2f} m, {degrees(T.theta):.1f}°"),
            ("σ of that", f"{prior.sigma_x:g}, {prior.sigma_y:g} m, {sigma_yaw:.3g}°"),
        ]
        if prior.about.any():
            rows.append(("at its point", f"{prior.about_x:.2f}, {prior.about_y:.2f} m"))
        return rows
    if isinstance(prior, TurnPrior):
        return [("map 2 is turned by about", f"{degrees(prior.yaw):.1f} ± {degrees(prior.sigma):.3g}°")]
    return [
        ("a place in map 1", f"{prior.ref_x:.2f}, {prior.ref_y:.2f} m"),
        ("is about this in map 2", f"{prior.mov_x:.2f}, {prior.mov_y:.2f} m"),
        ("to", f"{prior.radius:g} m"),
    ]


def sighting_rows(o: Observation, at: Encounter) -> list[tuple[str, ...]]:
    """Where the robots were, and what the one measured of the other."""
    x, y, turn = o.observer.x, o.observer.y, degrees(o.observer.theta)
    rows = [
        ("robot 1 in map 1", f"{x:.2f}, {y:.2f} m, {turn:.1f}°"),
        ("robot 2 in map 2", f"{o.observed_x:.2f}, {o.observed_y:.2f} m"),
        ("range r", f"{o.range:.3f} ± {o.sigma_range:.3f} m"),
        ("bearing β", f"{degrees(o.bearing):.1f} ± {degrees(o.sigma_bearing):.1f}°"),
        ("x̂₁, seen here", f"{at.x_ref[0]:.2f}, {at.x_ref[1]:.2f} m"),
    ]
    if o.bearing_back is not None:
        rows.append(("bearing back", f"{degrees(o.bearing_back):.1f}°"))
    return rows
