"""A pair of robots: what its merge says of the transform between them, as its few best answers."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations
from math import hypot, log
from typing import Any

import numpy as np

from algorithms.common.errors import MapMergeError, NoAnswerError
from algorithms.common.pose import FloatArray, Pose2
from algorithms.common.robot_names import RobotNames
from algorithms.methods import registry
from algorithms.methods.manual_merge import ManualMerge
from algorithms.methods.merge_result import MergeResult
from algorithms.methods.suggestions import suggestions_of
from algorithms.observations.fleet import Fleet, FleetPrior
from algorithms.observations.observation import encounter
from algorithms.observations.pair_problem import Known, PairProblem
from algorithms.verdict.decision import VerdictConfig
from algorithms.verdict.ranking import WINDOW_EDGE

LEAST_LIKELY = 0.01  # an answer that is less likely is not kept
SUREST = 1e-4  # so likely is it at least that none of the answers is right
ACCEPT_FROM = VerdictConfig().accept_from
SHORT_OF_IT = (
    0.999  # of the probability from which on a merge is accepted: what one has that is refused all the same
)


@dataclass(frozen=True)
class PairOrder:
    """Two robots, by name, and which of the fleet's sightings of the second by the first are to be used."""

    ref: str
    mov: str
    sightings: tuple[int, ...]


@dataclass(frozen=True, eq=False)
class Hypothesis:
    """One answer of a pair.

    covariance : (3, 3) of x, y, theta of T_ref_mov; metres, radians
    weight     : log-odds of it over "no answer of this pair is right"
    """

    T_ref_mov: Pose2
    covariance: FloatArray
    probability: float
    weight: float


@dataclass(frozen=True, eq=False)
class PairFinding:
    """What came of an order.

    pivot      : (2,) where its answers are compared; metres, mov frame
    hypotheses : the likeliest first; () where the method found none, or could not be run
    reason     : the verdict's sentence, or why there is none; on robot 1 and robot 2
    failed     : it could not be merged at all: its maps, or what is known of them, cannot be
    accept_from : so likely must an answer be, by itself and the loops that it closes; how likely depends on
                 what its method goes by
    """

    order: PairOrder
    pivot: FloatArray
    hypotheses: tuple[Hypothesis, ...]
    reason: str
    accepted: bool = False
    accept_from: float = ACCEPT_FROM
    failed: bool = False

    @property
    def said(self) -> str:
        """The reason with the robots' names in it."""
        return RobotNames(self.order.ref, self.order.mov).told(self.reason)


def pair_orders(fleet: Fleet) -> list[PairOrder]:
    """A merge for every observer and observed robot, of all its sightings where one transform can agree with
    them; sightings that cannot be true together are merged one by one, since a lie must spoil no other. And
    one for every two robots of which nothing but something else is known.
    """
    by_pair: dict[tuple[str, str], list[int]] = {}
    for number, seen in enumerate(fleet.sightings):
        by_pair.setdefault((seen.observer, seen.observed), []).append(number)
    for told in aligned_priors(fleet):
        by_pair.setdefault((told.ref, told.mov), [])
    orders = []
    for (ref, mov), numbers in sorted(by_pair.items()):
        agree = all(_agree(fleet, a, b) for a, b in combinations(numbers, 2))
        groups = [tuple(numbers)] if agree else [(number,) for number in numbers]
        orders += [PairOrder(ref, mov, group) for group in groups]
    return orders


def aligned_priors(fleet: Fleet) -> list[FleetPrior]:
    """What else is known of two robots, as their sightings tell it: where only ``mov`` saw ``ref``, the
    other way round, so that one merge uses both.
    """
    seen = {(each.observer, each.observed) for each in fleet.sightings}
    return [
        FleetPrior(told.mov, told.ref, told.prior.inverse())
        if (told.mov, told.ref) in seen and (told.ref, told.mov) not in seen
        else told
        for told in fleet.priors
    ]


def _agree(fleet: Fleet, a: int, b: int) -> bool:
    """Whether two sightings of one pair leave the two meeting places equally far apart in both maps."""
    first, second = (encounter(fleet.sightings[number].observation) for number in (a, b))
    in_ref, in_mov = first.x_ref - second.x_ref, first.x_mov - second.x_mov
    spread = first.covariance + second.covariance
    sigma = float(np.linalg.eigvalsh(spread)[-1]) ** 0.5
    return bool(abs(hypot(*in_ref.tolist()) - hypot(*in_mov.tolist())) <= WINDOW_EDGE * sigma)


def known_of(fleet: Fleet, order: PairOrder) -> tuple[Known, ...]:
    """What is known of how the maps of an order lie."""
    seen = tuple(fleet.sightings[number].observation for number in order.sightings)
    rough = (told.prior for told in aligned_priors(fleet) if (told.ref, told.mov) == (order.ref, order.mov))
    return (*seen, *rough)


def find_pair(fleet: Fleet, order: PairOrder, seed: int = 0) -> PairFinding:
    """Merge a pair; an order that cannot be carried out says why, and costs no other."""
    known = known_of(fleet, order)
    try:
        problem = PairProblem.of(fleet.maps[order.ref], fleet.maps[order.mov], known)
        method = registry.default_method(problem)
        config = registry.METHODS[method].defaults
        result = registry.merge(problem.ref, problem.mov, known, method, config, seed)
        return finding_of(order, problem, config, result)
    except MapMergeError as error:
        failed = not isinstance(error, NoAnswerError)
        return PairFinding(order, np.zeros(2), (), str(error), failed=failed)


def finding_of(order: PairOrder, problem: PairProblem, config: Any, result: MergeResult) -> PairFinding:
    """What a merge of the pair says; an answer that a person chose stands alone."""
    accept_from = ACCEPT_FROM if result.by_person else config.verdict.accept_from
    if result.by_person:
        sure = log((1 - SUREST) / SUREST)
        answers: Sequence[Hypothesis] = [Hypothesis(result.T_ref_mov, result.covariance, 1 - SUREST, sure)]
    else:
        answers = _hypotheses(result, ManualMerge(problem, config), accept_from)
    accepted = result.verdict.accepted or result.by_person
    return PairFinding(order, problem.pivot, tuple(answers), result.verdict.reason, accepted, accept_from)


def _hypotheses(result: MergeResult, manual: ManualMerge, accept_from: float) -> tuple[Hypothesis, ...]:
    kept = suggestions_of(result)
    likely = sum(each.probability for each in kept)
    none = max(SUREST, 1.0 - likely)
    if kept and not result.verdict.accepted:  # its method may doubt an answer that the walls find likely
        none = max(none, kept[0].probability / (SHORT_OF_IT * accept_from) - likely)
    return tuple(
        Hypothesis(
            each.T_ref_mov,
            result.covariance if each.number == 1 else manual.covariance(each.weighed),
            each.probability,
            log(each.probability / none),
        )
        for each in kept
        if each.probability >= LEAST_LIKELY
    )
