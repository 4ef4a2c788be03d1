"""What a run has told so far: the newest of every kind of step, and the course of the search."""

from __future__ import annotations

from dataclasses import dataclass, field
from math import isfinite
from typing import Any, TypeVar

from algorithms.common.pose import Pose2
from algorithms.methods.merge_result import MergeResult
from algorithms.methods.steps import (
    AnswersDetail,
    CandidatesDetail,
    Detail,
    PlaneDetail,
    ProofDetail,
    ProvenDetail,
    RefineDetail,
    ShiftDetail,
    Step,
    WeighedDetail,
)
from algorithms.spectra.candidates import Candidate
from app.model.objective_label import ObjectiveLabel, measure_of

D = TypeVar("D")


@dataclass
class RunState:
    """The state of a run as it is drawn. A picture that needs a detail asks with ``get``.

    config  : of the method that runs
    last    : the newest step, None before the first
    courses : best value after every iteration, a list per refined candidate
    swarms  : the newest snapshot of every refined candidate
    shifts  : the turns tried so far
    plane   : of a search over the plane the step that met the highest hill; None before there is one
    ceiling : the highest bound that the proof began with; −inf before it
    """

    config: Any = None
    last: Step | None = None
    courses: list[list[float]] = field(default_factory=list)
    swarms: list[RefineDetail] = field(default_factory=list)
    shifts: list[ShiftDetail] = field(default_factory=list)
    plane: PlaneDetail | None = None
    ceiling: float = float("-inf")
    _newest: dict[type, Detail] = field(default_factory=dict)

    def add(self, step: Step) -> None:
        """Take in the next step."""
        self.last = step
        detail = step.detail
        self._newest[type(detail)] = detail
        if isinstance(detail, ShiftDetail):
            self.shifts.append(detail)
        elif isinstance(detail, RefineDetail):
            if detail.index >= len(self.courses):
                self.courses.append([])
                self.swarms.append(detail)
            self.courses[detail.index].append(detail.state.best_value)
            self.swarms[detail.index] = detail
        elif isinstance(detail, PlaneDetail):
            if len(detail.values) and (self.plane is None or detail.values[0] > self.plane.values[0]):
                self.plane = detail
        elif isinstance(detail, ProofDetail) and isfinite(detail.state.ceiling):
            self.ceiling = max(self.ceiling, detail.state.ceiling)

    def get(self, kind: type[D]) -> D | None:
        """The newest detail of a kind, None where the run has not come to it."""
        return self._newest.get(kind)  # type: ignore[return-value]

    def reached(self, kind: type) -> bool:
        """Whether the run has come to this kind of step."""
        return kind in self._newest

    @property
    def at_hand(self) -> Candidate | None:
        """The candidate to look at: the one that is tried; after the search the best one."""
        found = self.get(CandidatesDetail)
        return found.candidates[0] if found else self.shifts[-1].candidate if self.shifts else None

    @property
    def measure(self) -> ObjectiveLabel:
        return measure_of(self.config)

    @property
    def searcher(self) -> str:
        """Who searches, as the subject of a sentence."""
        optimiser = getattr(getattr(self.config, "refine", None), "optimiser", "pso")
        return "Monte-Carlo" if optimiser == "mco" else "The swarm"

    @property
    def swarm(self) -> RefineDetail | None:
        """The swarm to look at: the one at work; once all are done, the one that got highest."""
        if not self.swarms:
            return None
        if self.reached(AnswersDetail):
            return max(self.swarms, key=lambda detail: detail.state.best_value)
        return self.swarms[-1]

    @property
    def answer(self) -> Pose2 | None:
        """The best transform as far as the run has come; None before the search is done."""
        if (result := self.get(MergeResult)) is not None:
            return result.T_ref_mov
        if (weighed := self.get(WeighedDetail)) is not None:
            return weighed.answers[0].T_ref_mov
        if (proven := self.get(ProvenDetail)) is not None:
            return proven.peak.T_ref_mov
        if (proof := self.get(ProofDetail)) is not None and proof.state.best is not None:
            return Pose2.from_array(proof.state.best)
        answers = self.get(AnswersDetail)
        return answers.answers[0].T_ref_mov if answers is not None else None
