"""The few best answers of a search, held against the whole maps: which of them is to be named."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from math import radians

from algorithms.common.parallel_kernels import each_on_a_core
from algorithms.common.pose import Pose2, pose_error
from algorithms.verdict.probability_model import (
    ENOUGH,
    Fit,
    VerdictModel,
    misfit_of,
    probability,
    quantities_of,
)
from algorithms.verdict.wall_evidence import Evidence
from algorithms.verdict.whole_maps import WholeMaps

WINDOW_EDGE = 3.5  # standard deviations; how far from a sighting the default method searches
BESIDE = 0.15, radians(1.5)  # metres, radians; an answer that fits better so far off is a better answer


@dataclass(frozen=True, eq=False)
class Weighed:
    """An answer and what the whole maps say of it.

    began      : where it was before it climbed
    evidence   : what the walls say
    deviations : from every sighting; standard deviations
    quantities : of the verdict's model
    score      : log-odds of being right, were there no other
    enough     : score from which on an answer fits as well as any, as in VerdictModel
    """

    T_ref_mov: Pose2
    began: Pose2
    evidence: Evidence
    deviations: tuple[float, ...]
    quantities: Mapping[str, float]
    score: float
    enough: float = ENOUGH

    @property
    def moved(self) -> bool:
        """Whether it climbed away from where the search had ended."""
        return self.T_ref_mov != self.began


def weigh(whole: WholeMaps, T_ref_mov: Pose2, model: VerdictModel, began: Pose2 | None = None) -> Weighed:
    """What the whole maps say of a transform; ``began`` is that itself unless given."""
    evidence = whole.weigh(T_ref_mov)
    deviations = tuple(whole.window.deviations(T_ref_mov.array()[None])[0].tolist())
    quantities = quantities_of(Fit(evidence, misfit_of(deviations, WINDOW_EDGE), whole.searched))
    began = T_ref_mov if began is None else began
    score, enough = model.score(quantities), model.enough(quantities)
    return Weighed(T_ref_mov, began, evidence, deviations, quantities, score, enough)


def ranked(
    whole: WholeMaps, answers: Iterable[Pose2], model: VerdictModel, distance: float, angle: float
) -> tuple[Weighed, ...]:
    """The answers after each has climbed, the likeliest first; those that come to one place told once.

    distance : metres at robot 2, and
    angle    : radians, from which on two transforms are two answers
    """
    kept: list[Weighed] = []
    found = each_on_a_core(lambda T: weigh(whole, whole.climb(T), model, T), tuple(answers))
    for each in sorted(found, key=lambda each: -each.score):
        if all(_apart(whole, each, other, distance, angle) for other in kept):
            kept.append(each)
    return tuple(kept)


def likeliest(
    whole: WholeMaps, answers: Sequence[Pose2], model: VerdictModel, most: int
) -> tuple[Pose2, ...]:
    """So many of the answers: those for which the maps as they are speak most."""
    found = whole.rigid_evidence(answers)
    scores = [
        model.score(
            quantities_of(Fit(replace(each, contradicting=each.rigid_contradicting), 0.0, whole.searched))
        )
        for each in found
    ]
    order = sorted(range(len(answers)), key=lambda k: -scores[k])
    return tuple(answers[k] for k in order[:most])


def better_beside(whole: WholeMaps, named: Weighed, model: VerdictModel) -> tuple[Weighed, ...]:
    """The top of the hill that a transform lies on, where that is another place and a likelier one.

    For transforms that no search has taken to a top. Patches of bent maps may slip by half a metre, so
    without it a transform half a metre off would pass for a right one.
    """
    top = whole.climb(named.T_ref_mov)
    if top == named.T_ref_mov:
        return ()
    beside = weigh(whole, top, model)
    better = beside.score > named.score and _apart(whole, beside, named, *BESIDE)
    return (beside,) if better else ()


def elsewhere(
    whole: WholeMaps, named: Weighed, answers: Iterable[Weighed], distance: float, angle: float
) -> tuple[Weighed, ...]:
    """Those of the answers that are another one than the named."""
    return tuple(each for each in answers if _apart(whole, each, named, distance, angle))


def probability_of(named: Weighed, others: Sequence[Weighed]) -> float:
    """That an answer is right, the others beside it."""
    return probability(named.score, [other.score for other in others], named.enough)


def _apart(whole: WholeMaps, a: Weighed, b: Weighed, distance: float, angle: float) -> bool:
    metres, turn = pose_error(a.T_ref_mov, b.T_ref_mov, whole.window.pivot)
    return metres > distance or turn > angle
