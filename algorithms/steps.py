"""What a merge tells while it runs: one Step after another, the last of them a MergeResult."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from algorithms.augment import AugmentedMap
from algorithms.fuse import Fusion
from algorithms.objective import Objective
from algorithms.observation import Encounter
from algorithms.pose import FloatArray, Pose2
from algorithms.search import SearchState
from algorithms.smm import Candidate
from algorithms.spectra import HoughMatch
from algorithms.verdict import Verdict
from algorithms.window import Box, Window


@dataclass(frozen=True, eq=False)
class ObservationDetail:
    """Stage "observe": where the seen robot stood, in both frames; a place per sighting, in their order."""

    encounters: tuple[Encounter, ...]

    @property
    def encounter(self) -> Encounter:
        """The place of the first sighting."""
        return self.encounters[0]


@dataclass(frozen=True, eq=False)
class AugmentDetail:
    """Stage "augment": both maps with their levels, eqs. (4), (5)."""

    ref: AugmentedMap
    mov: AugmentedMap


@dataclass(frozen=True, eq=False)
class HoughDetail:
    """Stage "spectra": Hough spectra, their correlation and the ranked turns, eqs. (11), (12)."""

    match: HoughMatch


@dataclass(frozen=True, eq=False)
class WindowDetail:
    """Stage "search": the paper's window for the shift, eqs. (6)–(10)."""

    window: Window


@dataclass(frozen=True, eq=False)
class ShiftDetail:
    """Stage "search": one turn tried, with its X and Y spectra, eqs. (13)–(16)."""

    index: int  # which of the ranked turns, from 0
    total: int
    candidate: Candidate


@dataclass(frozen=True, eq=False)
class CandidatesDetail:
    """End of stage "search": all candidates, each with the best Γ a first look found, best first."""

    candidates: tuple[Candidate, ...]
    objective: Objective
    window: Window


@dataclass(frozen=True, eq=False)
class RefineDetail:
    """Stage "refine": one snapshot of the optimiser at work on one candidate, eqs. (17)–(22).

    The state's poses are coordinates in the box: where the box's pivot (x̂2 by default) goes in the ref
    frame, and the turn. ``box.transforms(state.poses)`` makes (Δx, Δy, Δθ) of them.
    """

    index: int  # which of the ranked candidates, from 0
    total: int  # how many of them are refined
    box: Box
    state: SearchState


@dataclass(frozen=True, eq=False)
class Answer:
    """One transform that the search ended on, with its Γ and why the search ended there."""

    T_ref_mov: Pose2
    value: float
    stopped: str


@dataclass(frozen=True, eq=False)
class AnswersDetail:
    """End of stage "refine": what became of every candidate, best Γ first."""

    answers: tuple[Answer, ...]


@dataclass(frozen=True, eq=False)
class MergeResult:
    """The answer, and all that is needed to report it; detail of the last step, stage "verdict".

    T_ref_mov     : best transform found, also where the merge is refused
    covariance    : (3, 3) of x, y, theta; metres and radians
    value         : Γ(T_ref_mov), eq. (17); None for a method without an objective
    answers       : everything the search ended on, best first; the first is T_ref_mov
    timings_s     : seconds per stage
    """

    T_ref_mov: Pose2
    covariance: FloatArray
    value: float | None
    verdict: Verdict
    fusion: Fusion
    encounter: Encounter
    answers: tuple[Answer, ...]
    method: str
    seed: int
    proven_optimal: bool = False
    timings_s: Mapping[str, float] = field(default_factory=dict)


Detail = (
    ObservationDetail
    | AugmentDetail
    | HoughDetail
    | WindowDetail
    | ShiftDetail
    | CandidatesDetail
    | RefineDetail
    | AnswersDetail
    | Fusion
    | MergeResult
)


@dataclass(frozen=True, eq=False)
class Step:
    """One thing a method has done.

    stage   : "observe", "augment", "spectra", "search", "refine", "fuse" or "verdict"
    detail  : what came out of it, for whoever draws or reports it
    seconds : spent on it, without what the caller did between two steps
    reused  : whether it comes from an earlier run with the same settings (``seconds`` are that run's)
    """

    stage: str
    detail: Detail
    seconds: float
    reused: bool = False
