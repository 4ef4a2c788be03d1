"""What came of one method, in words."""

from __future__ import annotations

from dataclasses import dataclass
from math import degrees
from typing import Literal

from app.evaluation.method_run import MethodRun

Mood = Literal["accepted", "bent", "refused", "plain"]


@dataclass(frozen=True)
class RunSummary:
    """A sentence, what mapmeld's verdict says, and numbers.

    mood : accepted for what is right, or where nobody knows accepted, bent where that is of bent maps;
           refused for the opposite; plain where nothing was merged
    """

    says: str
    verdict: str
    numbers: str
    mood: Mood


def outcome_of(trial: MethodRun) -> RunSummary:
    if trial.failed:
        return RunSummary("Could not be run.", sentence(trial.reason), "", "plain")
    seconds = f"{trial.seconds:.2f} s"
    if trial.T_ref_mov is None:
        return RunSummary("No transform found.", sentence(trial.reason), seconds, "plain")
    index = "" if trial.index is None else f"eq. (23) {trial.index:.1%} · "
    judged: dict[bool | None, Mood] = {True: "accepted", False: "refused", None: verdict_mood(trial)}
    return RunSummary(_judgement(trial), trial.reason, f"{index}{seconds}", judged[trial.right])


def _judgement(trial: MethodRun) -> str:
    """What the truth says; where none is known, what the verdict says."""
    if trial.right is None:
        return {"accepted": "Accepted.", "bent": "Accepted, bent."}.get(verdict_mood(trial), "Refused.")
    if trial.distance is None or trial.angle is None:  # maps that share no place
        return "✓ Right." if trial.right else "✗ Wrong: they share no place."
    metres, turn = trial.distance, degrees(trial.angle)
    off = f"{metres:.{1 if metres >= 10 else 2}f} m, {turn:.{0 if turn >= 10 else 1}f}°"
    return f"✓ Right to {off}" if trial.right else f"✗ Wrong by {off}"


def verdict_mood(trial: MethodRun) -> Mood:
    """The verdict's own colour, whatever the truth says."""
    if trial.bent:
        return "bent"
    return "accepted" if trial.accepted else "refused"


def sentence(words: str) -> str:
    """A finding as a sentence."""
    return f"{words[:1].upper()}{words[1:]}" + ("" if words.endswith((".", "!", "?")) else ".")
