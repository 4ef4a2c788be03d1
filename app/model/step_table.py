"""By the type of a step: its share of the work, its time on the screen, the page of its charts."""

from __future__ import annotations

from dataclasses import dataclass

from algorithms.maps.map_fusion import Fusion
from algorithms.methods import steps
from algorithms.methods.merge_result import MergeResult

TURN, SHIFT, SWARM, PROOF, RESULT = "Turn", "Shift", "Swarm", "Proof", "Result"  # pages of charts


@dataclass(frozen=True)
class StepRow:
    """One type of step.

    share : of the work that is done when it begins; refining and proving take what lies before the next
    stay  : seconds on the screen; those of a search and of a proof change, see playback
    page  : of the charts that a run turns to; empty: none
    """

    share: float = 0.0
    stay: float = 0.0
    page: str = ""


STEPS: dict[type, StepRow] = {
    steps.ObservationDetail: StepRow(0.02, 0.5),
    steps.AugmentDetail: StepRow(0.06, 1.2, TURN),
    steps.HoughDetail: StepRow(0.14, 1.2, TURN),
    steps.WindowDetail: StepRow(0.2, 0.4, SHIFT),
    steps.ShiftDetail: StepRow(0.2, 0.42, SHIFT),
    steps.CandidatesDetail: StepRow(0.4, 0.6, SHIFT),
    steps.RefineDetail: StepRow(0.4, page=SWARM),
    steps.MatchesDetail: StepRow(0.4, 1.4, RESULT),
    steps.TurnsDetail: StepRow(0.1, 0.15, TURN),
    steps.PlaneDetail: StepRow(0.1, 0.15, TURN),
    steps.AnswersDetail: StepRow(0.8, 0.4),
    steps.ProofDetail: StepRow(0.8, page=PROOF),
    steps.ProvenDetail: StepRow(0.95, 0.9, PROOF),
    steps.WeighedDetail: StepRow(0.97, 0.6),
    Fusion: StepRow(0.98, 0.9),
    steps.TriedDetail: StepRow(0.99),
    MergeResult: StepRow(1.0, page=RESULT),
}


def row_of(detail: object) -> StepRow:
    """The row of a detail; one without a row, or None, has nothing."""
    return STEPS.get(type(detail), StepRow())
