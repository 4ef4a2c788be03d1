"""A pair's answers held against newer maps: whether they still stand, without a search."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from algorithms.common.errors import MapMergeError, NoAnswerError
from algorithms.common.pose import Pose2
from algorithms.fleets.pair_hypotheses import PairFinding, PairOrder, finding_of, known_of
from algorithms.maps.grid_map import GridMap
from algorithms.methods import registry
from algorithms.methods.manual_merge import ManualMerge
from algorithms.observations.fleet import Fleet
from algorithms.observations.pair_problem import PairProblem
from algorithms.observations.priors import InitialPose
from algorithms.verdict.probability_model import shipped_model
from algorithms.verdict.ranking import weigh
from algorithms.verdict.wall_evidence import evidence
from algorithms.verdict.wall_map import make_wall_map

MOST_MOVED, MOST_TURNED = 1.5, 0.15  # metres, radians (9°); standard deviations of what SLAM corrects


def recheck(fleet: Fleet, order: PairOrder, answers: Sequence[Pose2]) -> PairFinding:
    """What the fleet's maps say now of T_ref_mov that were found on others of the same frames.

    answers : each climbs to the top that it lies near; the likeliest is held against the others
    """
    try:
        problem = PairProblem.of(fleet.maps[order.ref], fleet.maps[order.mov], known_of(fleet, order))
        method = registry.default_method(problem)
        config = registry.METHODS[method].defaults
        manual = ManualMerge(problem, config)
        whole, model = manual.whole, shipped_model(manual.kind)
        best, *others = sorted(
            (weigh(whole, whole.climb(T), model) for T in answers), key=lambda each: -each.score
        )
        if others:
            manual = replace(manual, others=tuple(others))
        result = manual.weigh(best.T_ref_mov, method=method)
        return finding_of(order, problem, config, result)
    except MapMergeError as error:
        failed = not isinstance(error, NoAnswerError)
        return PairFinding(order, np.zeros(2), (), str(error), failed=failed)


def denied_share(old: GridMap, new: GridMap) -> float:
    """Share of the walls of a robot's last map that its next one denies: none where the map has but grown."""
    return evidence(make_wall_map(new), make_wall_map(old), Pose2(), slip=False).rigid_contradiction


def correction_between(old: GridMap, new: GridMap) -> Pose2 | None:
    """T_new_old of a robot's last map in its next one, as far as SLAM may have moved and turned it; None
    where the two do not agree in any such way.
    """
    rows, cols = np.nonzero(old.occupied)
    if not len(rows):
        return None
    x, y = old.centres(rows, cols).mean(axis=0).tolist()
    prior = InitialPose(Pose2(), MOST_MOVED, MOST_MOVED, MOST_TURNED, x, y)
    try:
        found = registry.merge(new, old, prior, registry.PLANE_METHOD)
    except MapMergeError:
        return None
    return found.T_ref_mov if found.verdict.accepted else None
