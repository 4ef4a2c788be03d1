"""What a merge tells while it runs: one Step after another, the last of them a MergeResult."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from algorithms.common.pose import FloatArray, Pose2
from algorithms.maps.grid_map import BoolArray, Float32Array
from algorithms.maps.map_fusion import Fusion
from algorithms.methods.merge_result import Answer, MergeResult
from algorithms.observations.observation import Encounter
from algorithms.observations.search_window import CoupledWindow, Window
from algorithms.optimisation.branch_and_bound import ProofState
from algorithms.optimisation.correlation_picture import CorrelationPicture
from algorithms.optimisation.objective import Objective
from algorithms.optimisation.optimiser import SearchState
from algorithms.optimisation.search_box import SearchBox
from algorithms.optimisation.subcell_peak import Peak
from algorithms.spectra.augmented_map import AugmentedMap
from algorithms.spectra.candidates import Candidate
from algorithms.spectra.hough_spectra import HoughMatch
from algorithms.verdict.ranking import Weighed


@dataclass(frozen=True, eq=False)
class ObservationDetail:
    """Stage "observe": where the seen robot stood, in both frames; a place per sighting, in their order."""

    encounters: tuple[Encounter, ...]

    @property
    def encounter(self) -> Encounter:
        """The place of the first sighting."""
        return self.encounters[0]

    @property
    def pivot(self) -> FloatArray:
        """(2,) where robot 2 was first seen; metres, mov frame."""
        return self.encounters[0].x_mov


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
    """Stage "search": the window for the shift: the paper's, eqs. (6)–(10), or the coupled one.

    coupled : the coupled window whichever of the two is used, to show it beside the other
    paper   : the paper's window as printed, for the same purpose
    """

    window: Window | CoupledWindow
    coupled: CoupledWindow
    paper: Window


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
    window: Window | CoupledWindow


@dataclass(frozen=True, eq=False)
class RefineDetail:
    """Stage "refine": one snapshot of the optimiser at work on one candidate, eqs. (17)–(22).

    The state's poses are coordinates in the box: where the box's pivot (x̂2 by default) goes in the ref
    frame, and the turn. ``box.transforms(state.poses)`` makes (Δx, Δy, Δθ) of them.
    """

    index: int  # which of the ranked candidates, from 0
    total: int  # how many of them are refined
    box: SearchBox
    state: SearchState


@dataclass(frozen=True, eq=False)
class MatchesDetail:
    """Stages "match" and "search" of a method that matches features.

    ref_features, mov_features : (N, 2), (M, 2) all that were found; metres, each in its own map's frame
    ref, mov : (K, 2) those taken for the same places, pair by pair; likewise
    inliers  : (K,) bool, which pairs agree with the transform; none before there is one
    T_ref_mov : that transform; None before there is one
    """

    ref_features: FloatArray
    mov_features: FloatArray
    ref: FloatArray
    mov: FloatArray
    inliers: BoolArray
    T_ref_mov: Pose2 | None = None


@dataclass(frozen=True, eq=False)
class TurnsDetail:
    """Stage "search" of a method that tries every turn.

    turns  : (K,) of map 2; radians, rising
    scores : (K,) how well the maps agree at the best shift of each turn, the higher the better; NaN where
             it has not been tried
    best   : the turn that the answer comes from, after all refinement; None before
    """

    turns: FloatArray
    scores: FloatArray
    best: float | None = None


@dataclass(frozen=True, eq=False)
class PlaneDetail:
    """Stage "correlate": some more turns of the plane are done.

    done          : how many turns
    turns, tops   : (K,) all turns of T_ref_mov, radians, rising from −π, and how high the highest hill of
                    each is, metres of wall; NaN where it has not been tried or what is known leaves no shift
    picture       : of the best of the newest turns; None where none of them has a shift left
    cell          : edge of a cell of the plane; metres
    poses, values : (P, 3), (P,) x, y, theta of T_ref_mov at the best places so far, best first, and how good
                    they are; metres of wall
    searched      : shifts that the knowledge leaves, averaged over the circle's turns so far; m²
    """

    done: int
    turns: FloatArray
    tops: FloatArray
    picture: CorrelationPicture | None
    cell: float
    poses: FloatArray
    values: Float32Array
    searched: float

    @property
    def total(self) -> int:
        """How many turns there are."""
        return len(self.turns)


@dataclass(frozen=True, eq=False)
class AnswersDetail:
    """End of stage "refine", or "climb": what became of every candidate, best value first.

    tops : (P, 3) x, y, theta of T_ref_mov of all places that were climbed, best value first; of a search over
           the plane, whose answers are the likeliest of them
    """

    answers: tuple[Answer, ...]
    tops: FloatArray = field(default_factory=lambda: np.zeros((0, 3)))


@dataclass(frozen=True, eq=False)
class ProofDetail:
    """Stage "prove": one look at the branch and bound over the whole circle."""

    state: ProofState
    window: CoupledWindow


@dataclass(frozen=True, eq=False)
class ProvenDetail:
    """End of stage "prove": the best transform of the whole circle, refined below a cell.

    state      : the last of the proof
    peak       : its best, polished; the optimiser's best where the window holds no transform at all
    search_found_it : whether the optimiser had come to the same answer
    """

    state: ProofState
    peak: Peak
    search_found_it: bool


@dataclass(frozen=True, eq=False)
class WeighedDetail:
    """Stage "weigh": the best few answers by the walls of the whole maps, the likeliest first.

    The search has looked near the encounter only; each of its answers has climbed from there to where the
    whole maps fit best, if that is better by much.

    answers : those that are other answers than the likelier ones
    peak    : the whole maps' objective around the first one; None where that has not moved
    """

    answers: tuple[Weighed, ...]
    peak: Peak | None = None


@dataclass(frozen=True)
class TriedDetail:
    """Stage "explain", after a refusal: a simple change to map 2 under which the maps may agree.

    clause : as in "mirrored, map 2 agrees"
    """

    clause: str
    index: int  # which of the changes, from 0
    total: int


@dataclass(frozen=True)
class CauseDetail:
    """End of stage "explain": what was probably wrong and what to do, in sentences; empty: nothing simple."""

    hint: str


Detail = (
    ObservationDetail
    | AugmentDetail
    | HoughDetail
    | WindowDetail
    | ShiftDetail
    | CandidatesDetail
    | RefineDetail
    | MatchesDetail
    | TurnsDetail
    | PlaneDetail
    | AnswersDetail
    | ProofDetail
    | ProvenDetail
    | WeighedDetail
    | Fusion
    | TriedDetail
    | CauseDetail
    | MergeResult
)


@dataclass(frozen=True, eq=False)
class Step:
    """One thing a method has done.

    stage   : "observe", "augment", "spectra", "match", "search", "refine", "prove", "correlate", "climb",
              "weigh", "fuse", "verdict" or, after a refusal, "explain"
    detail  : what came out of it, for whoever draws or reports it
    seconds : spent on it, without what the caller did between two steps
    reused  : whether it comes from an earlier run with the same settings (``seconds`` are that run's)
    """

    stage: str
    detail: Detail
    seconds: float
    reused: bool = False
