"""What a run has told so far: the newest of every kind of step, and the course of the search."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TypeVar

from algorithms.fuse import Fusion
from algorithms.steps import (
    AnswersDetail,
    AugmentDetail,
    CandidatesDetail,
    Detail,
    HoughDetail,
    MergeResult,
    ObservationDetail,
    RefineDetail,
    ShiftDetail,
    Step,
    WindowDetail,
)

D = TypeVar("D")

ORDER: tuple[type, ...] = (
    ObservationDetail,
    AugmentDetail,
    HoughDetail,
    WindowDetail,
    ShiftDetail,
    CandidatesDetail,
    RefineDetail,
    AnswersDetail,
    Fusion,
    MergeResult,
)


@dataclass
class Story:
    """The state of a run as it is drawn. A picture that needs a detail asks with ``get``.

    last   : the newest step, None before the first
    gammas : best Γ after every iteration, a list per refined candidate
    shifts : the turns tried so far
    """

    last: Step | None = None
    gammas: list[list[float]] = field(default_factory=list)
    shifts: list[ShiftDetail] = field(default_factory=list)
    seconds: dict[str, float] = field(default_factory=dict)
    _newest: dict[type, Detail] = field(default_factory=dict)

    def tell(self, step: Step) -> None:
        """Take in the next step."""
        self.last = step
        detail = step.detail
        self._newest[type(detail)] = detail
        if isinstance(detail, ShiftDetail):
            self.shifts.append(detail)
        elif isinstance(detail, RefineDetail):
            if detail.index >= len(self.gammas):
                self.gammas.append([])
            self.gammas[detail.index].append(detail.state.best_value)
        elif isinstance(detail, MergeResult):
            self.seconds = dict(detail.timings_s)

    def get(self, kind: type[D]) -> D | None:
        """The newest detail of a kind, None where the run has not come to it."""
        return self._newest.get(kind)  # type: ignore[return-value]

    def reached(self, kind: type) -> bool:
        """Whether the run has come to this kind of step."""
        return kind in self._newest
