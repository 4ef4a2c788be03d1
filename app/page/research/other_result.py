"""What came of another method, in words; its transform shown over map 1: to be looked at, not taken."""

from __future__ import annotations

from dataclasses import dataclass
from math import degrees
from typing import Any, Literal

from algorithms.common.pose import Pose2
from algorithms.common.robot_names import UNNAMED, RobotNames
from algorithms.maps.grid_map import GridMap
from algorithms.maps.map_fusion import fuse
from algorithms.methods.merge_result import Answer
from algorithms.methods.steps import AnswersDetail, AugmentDetail, ObservationDetail, Step
from algorithms.observations.observation import Observation, encounters_of
from app.evaluation.compared_methods import COMPARED
from app.evaluation.method_run import MethodRun
from app.model.run_state import RunState
from app.page.panels.html_widgets import box, table

NOT_YOURS = "This is another method's merge, to be looked at. Go back to your own to take it away."

Mood = Literal["accepted", "bent", "refused", "plain"]


@dataclass(frozen=True)
class RunSummary:
    """A sentence, what mapmeld's verdict says, and numbers.

    mood : accepted where right, refused where wrong; where nobody knows the verdict's; plain: not merged
    """

    says: str
    verdict: str
    numbers: str
    mood: Mood


def outcome_of(trial: MethodRun, names: RobotNames = UNNAMED) -> RunSummary:
    """In a few words; ``names``: of the robots, for the verdict."""
    reason = names.told(trial.reason)
    if trial.failed:
        return RunSummary("Could not be run.", sentence(reason), "", "plain")
    seconds = f"{trial.seconds:.2f} s"
    if trial.T_ref_mov is None:
        return RunSummary("No transform found.", sentence(reason), seconds, "plain")
    index = "" if trial.index is None else f"eq. (23) {trial.index:.1%} · "
    judged: dict[bool | None, Mood] = {True: "accepted", False: "refused", None: verdict_mood(trial)}
    return RunSummary(_judgement(trial), reason, f"{index}{seconds}", judged[trial.right])


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


@dataclass(frozen=True)
class OtherResult:
    """What a method, called by its name in COMPARED, has found on the loaded pair, and with what settings."""

    method: str
    config: Any
    seed: int
    trial: MethodRun

    @property
    def title(self) -> str:
        return COMPARED[self.method].title

    @property
    def pose(self) -> Pose2:
        """Where it puts map 2."""
        return self.trial.pose

    def run(self, ref: GridMap, mov: GridMap, seen: tuple[Observation, ...], own: RunState) -> RunState:
        """The end of a run that found this, with the levels of the page's own; raises TooLargeError."""
        run = RunState(self.config)
        augmented = own.get(AugmentDetail)
        if augmented is not None:
            run.add(Step("augment", augmented, 0.0))
        answers = AnswersDetail((Answer(self.pose, 0.0, "of another method"),))
        run.add(Step("observe", ObservationDetail(encounters_of(seen, ref, mov)), 0.0))
        run.add(Step("search", answers, 0.0))
        run.add(Step("fuse", fuse((ref, mov), (Pose2(), self.pose)), 0.0))
        return run

    def sentence(self) -> str:
        """What is said of it above the map: the truth first, the verdict always."""
        summary = outcome_of(self.trial)
        says = f" {summary.says.rstrip('.')}." if self.trial.right is not None else ""
        return f"{self.title}:{says} {summary.verdict}"

    def html(self, names: RobotNames = UNNAMED) -> str:
        """HTML of the same for the dock."""
        summary, T = outcome_of(self.trial, names), self.pose
        rows = [
            ("T: Δx", f"{T.x:.3f} m"),
            ("T: Δy", f"{T.y:.3f} m"),
            ("T: Δθ", f"{degrees(T.theta):.2f}°"),
            ("eq. (23)", "–" if self.trial.index is None else f"{self.trial.index:.1%}"),
            ("time of the merge", f"{self.trial.seconds:.2f} s"),
            ("seed", f"{self.seed}"),
        ]
        says = "" if self.trial.right is None else f" {summary.says}"
        verdict = box(summary.verdict, verdict_mood(self.trial), NOT_YOURS)
        return box(f"{self.title}.{says}", summary.mood) + verdict + table(rows)
