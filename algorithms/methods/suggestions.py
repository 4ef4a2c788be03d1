"""The best few answers of a merge, for a person to choose from where none is accepted."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from algorithms.common.pose import Pose2, pose_error
from algorithms.methods.merge_result import MergeResult
from algorithms.verdict.decision import speaking_against
from algorithms.verdict.probability_model import shipped_model
from algorithms.verdict.ranking import Weighed, probability_of

MOST = 5
SAME = 1e-6  # metres, radians; a transform that is put on the page and read back is the same


@dataclass(frozen=True, eq=False)
class Suggestion:
    """One answer.

    number        : from 1 on, in the order of the result
    T_ref_mov     : of map 2's frame to map 1's
    weighed       : what the whole maps say of it
    probability   : that it is right, the others beside it
    contributions : as in Verdict
    """

    number: int
    T_ref_mov: Pose2
    weighed: Weighed
    probability: float
    contributions: Mapping[str, float]

    @property
    def against(self) -> tuple[str, ...]:
        """What speaks against it, by weight: names of quantities, or OTHERS."""
        return speaking_against(self.contributions)


def are_wanted(result: MergeResult) -> bool:
    """Whether a person is to choose: of a merge that is refused for more than the bend of its maps."""
    verdict = result.verdict
    return not (verdict.accepted or verdict.only_bent or result.by_person)


def suggestions_of(result: MergeResult) -> tuple[Suggestion, ...]:
    """Up to five answers that lie elsewhere, the named one first."""
    model = shipped_model(result.kind)
    made = []
    for number, weighed in enumerate(result.weighed[:MOST], 1):
        others = [other for other in result.weighed if other is not weighed]
        moved = model.contributions(weighed.quantities, [other.score for other in others])
        likely = probability_of(weighed, others)
        made.append(Suggestion(number, weighed.T_ref_mov, weighed, likely, moved))
    return tuple(made)


def suggested(result: MergeResult, T_ref_mov: Pose2) -> Suggestion | None:
    """The suggestion that is this transform; None where none is."""
    for each in suggestions_of(result):
        if max(pose_error(each.T_ref_mov, T_ref_mov, result.pivot)) < SAME:
            return each
    return None
