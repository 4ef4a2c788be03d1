"""Another method's transform, shown over map 1 in place of one's own result: to be looked at, not taken."""

from __future__ import annotations

from dataclasses import dataclass
from math import degrees
from typing import Any

from algorithms.common.pose import Pose2
from algorithms.maps.grid_map import GridMap
from algorithms.maps.map_fusion import fuse
from algorithms.methods.merge_result import Answer
from algorithms.methods.registry import METHODS
from algorithms.methods.steps import AnswersDetail, AugmentDetail, ObservationDetail, Step
from algorithms.observations.observation import Observation, encounters_of
from app.evaluation.method_run import MethodRun
from app.model.run_state import RunState
from app.page.panels.html_widgets import box, table
from app.page.research.run_summary import outcome_of, verdict_mood

NOT_YOURS = "This is another method's merge, to be looked at. Go back to your own to take it away."


@dataclass(frozen=True)
class OtherResult:
    """What a method has found on the loaded pair.

    config : the settings it ran with
    """

    method: str
    config: Any
    seed: int
    trial: MethodRun

    @property
    def title(self) -> str:
        return METHODS[self.method].title

    @property
    def pose(self) -> Pose2:
        """Where it puts map 2."""
        assert self.trial.pose is not None
        return self.trial.pose

    def run(self, ref: GridMap, mov: GridMap, seen: tuple[Observation, ...], own: RunState) -> RunState:
        """The end of a run that found this; raises TooLargeError.

        own : of the page's own run, whose levels are kept: they do not depend on the answer
        """
        run = RunState(self.config)
        augmented = own.get(AugmentDetail)
        if augmented is not None:
            run.tell(Step("augment", augmented, 0.0))
        encounters = encounters_of(seen, ref, mov)
        answers = AnswersDetail((Answer(self.pose, 0.0, "of another method"),))
        for stage, detail in (
            ("observe", ObservationDetail(encounters)),
            ("search", answers),
            ("fuse", fuse((ref, mov), (Pose2(), self.pose))),
        ):
            run.tell(Step(stage, detail, 0.0))  # type: ignore[arg-type]
        return run

    def sentence(self) -> str:
        """What is said of it above the map: the truth first, the verdict always."""
        summary = outcome_of(self.trial)
        says = f" {summary.says.rstrip('.')}." if self.trial.right is not None else ""
        return f"{self.title}:{says} {summary.verdict}"

    def html(self) -> str:
        """HTML of the same for the dock."""
        summary = outcome_of(self.trial)
        rows = [
            ("T: Δx", f"{self.pose.x:.3f} m"),
            ("T: Δy", f"{self.pose.y:.3f} m"),
            ("T: Δθ", f"{degrees(self.pose.theta):.2f}°"),
            ("eq. (23)", "–" if self.trial.index is None else f"{self.trial.index:.1%}"),
            ("time of the merge", f"{self.trial.seconds:.2f} s"),
            ("seed", f"{self.seed}"),
        ]
        says = "" if self.trial.right is None else f" {summary.says}"
        return (
            box(f"{self.title}.{says}", summary.mood)
            + box(summary.verdict, verdict_mood(self.trial), NOT_YOURS)
            + table(rows)
        )
