"""The state of the page in words: one sentence, in one place."""

from __future__ import annotations

from math import degrees

from algorithms.fuse import Fusion
from algorithms.steps import (
    AnswersDetail,
    AugmentDetail,
    CandidatesDetail,
    HoughDetail,
    MergeResult,
    ObservationDetail,
    RefineDetail,
    ShiftDetail,
    WindowDetail,
)
from app.story import Story

# Share of the work done when a stage begins; refining takes what lies between the last two.
_SHARE: dict[type, float] = {
    ObservationDetail: 0.02,
    AugmentDetail: 0.06,
    HoughDetail: 0.14,
    WindowDetail: 0.2,
    ShiftDetail: 0.2,
    CandidatesDetail: 0.4,
    RefineDetail: 0.4,
    AnswersDetail: 0.95,
    Fusion: 0.98,
    MergeResult: 1.0,
}

READY = "Ready. Press Merge."
UP_TO_DATE = "Everything up to the candidates is up to date. Press Merge."


def sentence(story: Story) -> str:
    """What a run is doing right now."""
    detail = story.last.detail if story.last else None
    if isinstance(detail, ObservationDetail):
        times = len(detail.encounters)
        if times > 1:
            return f"Robot 1 saw robot 2 at {times} places: they are in both maps."
        return "Robot 1 saw robot 2: this place is in both maps."
    if isinstance(detail, AugmentDetail):
        return "Augmenting: walls near the meeting place are lifted."
    if isinstance(detail, HoughDetail):
        return f"Turning: {len(detail.match.turns)} turns where the Hough spectra coincide."
    if isinstance(detail, WindowDetail):
        return "Shifting: the observation leaves this window."
    if isinstance(detail, ShiftDetail):
        turn = f"{degrees(detail.candidate.T_ref_mov.theta):.1f}".replace("-", "−")
        return f"Shifting candidate {detail.index + 1} of {detail.total}: map 2 turned by {turn}°."
    if isinstance(detail, CandidatesDetail):
        return f"{len(detail.candidates)} candidates, ranked by Γ."
    if isinstance(detail, RefineDetail):
        return (
            f"Searching around candidate {detail.index + 1} of {detail.total}: "
            f"iteration {detail.state.iteration + 1}, Γ = {detail.state.best_value:.4g}."
        )
    if isinstance(detail, AnswersDetail):
        return f"The search is done: {detail.answers[0].stopped}."
    if isinstance(detail, Fusion):
        return "Merging the cells: what agrees, what contradicts."
    if isinstance(detail, MergeResult):
        return detail.verdict.reason
    return "Starting."


def progress(story: Story) -> float:
    """Share of the run that is done, 0 … 1."""
    detail = story.last.detail if story.last else None
    share = _SHARE.get(type(detail), 0.0)
    if isinstance(detail, ShiftDetail):
        share += 0.2 * (detail.index + 1) / max(1, detail.total)
    if isinstance(detail, RefineDetail):
        share += 0.55 * detail.index / max(1, detail.total)
    return share


def remedy(result: MergeResult) -> str:
    """What would help after a refusal; empty where the merge was accepted."""
    verdict = result.verdict
    if verdict.accepted:
        return ""
    if verdict.overlap_area < 2:
        return "Let one of the robots drive on, so that the maps share more, and merge again."
    if verdict.ambiguity is not None and verdict.ambiguity > 0.8:
        return "A second observation would tell the two places apart; a larger Σ_aug takes in more walls."
    if verdict.deviation > 4:
        return "Check the observation's numbers; or widen σ_x, σ_y, or try more peaks."
    return "Check the observation; try a larger Σ_aug, more candidates, or a second observation."
