"""What a merge ends with: the answer, and all that is needed to report it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

from algorithms.common.pose import FloatArray, Pose2
from algorithms.maps.map_fusion import Fusion
from algorithms.observations.observation import Encounter
from algorithms.optimisation.branch_and_bound import ProofState
from algorithms.verdict.decision import Verdict
from algorithms.verdict.probability_model import ModelKind
from algorithms.verdict.ranking import Weighed

BY_HAND = "by hand"
CHOSEN = "chosen by you"
"""Methods of a result that a person has made: laid by hand, or taken from what was suggested."""


@dataclass(frozen=True, eq=False)
class Answer:
    """One transform that the search ended on, with its Γ and why the search ended there."""

    T_ref_mov: Pose2
    value: float
    stopped: str


@dataclass(frozen=True)
class PlaneScan:
    """How a plane was searched.

    turn_step : between neighbouring turns; radians
    cell      : edge of the cells that the shifts are apart; metres
    climbed   : how many of the best places were climbed
    """

    turn_step: float
    cell: float
    climbed: int


@dataclass(frozen=True, eq=False)
class MergeResult:
    """The answer, and all that is needed to report it; detail of the last step, stage "verdict" or "explain".

    T_ref_mov     : best transform found, also where the merge is refused
    covariance    : (3, 3) of x, y, theta; metres and radians
    value         : what the method's objective says of T_ref_mov: Γ, eq. (17), or metres of wall that
                    agree; None for a method without an objective
    verdict       : whether to trust it, and why
    fusion        : the merged map, in map 1's frame, and where the maps agree
    encounters    : where robot 2 was seen, a place per sighting; () without one
    pivot         : (2,) where answers are held against each other: where robot 2 was first seen, or the
                    middle of map 2's walls; metres, mov frame
    answers       : everything the optimiser ended on, best first
    kind          : of model that weighed the answers
    weighed       : T_ref_mov and the other answers that may be right, as the whole maps weigh them
    proof         : how the proof ended; None for a method without one
    search_found_it : whether the optimiser had come to the proven answer; None without a proof
    scan          : how the plane was searched; None of another search
    timings_s     : seconds spent in each stage, by its name
    """

    T_ref_mov: Pose2
    covariance: FloatArray
    value: float | None
    verdict: Verdict
    fusion: Fusion
    encounters: tuple[Encounter, ...]
    pivot: FloatArray
    answers: tuple[Answer, ...]
    method: str
    seed: int
    kind: ModelKind = "sighting"
    weighed: tuple[Weighed, ...] = ()
    proof: ProofState | None = None
    search_found_it: bool | None = None
    scan: PlaneScan | None = None
    timings_s: Mapping[str, float] = field(default_factory=dict)

    @property
    def encounter(self) -> Encounter:
        """The first sighting's place."""
        return self.encounters[0]

    @property
    def by_person(self) -> bool:
        """Whether no method names this transform, but a person."""
        return self.method in (BY_HAND, CHOSEN)

    def with_hint(self, hint: str) -> MergeResult:
        return replace(self, verdict=replace(self.verdict, hint=hint))

    @property
    def proven_optimal(self) -> bool:
        """Whether no transform fits better than the search's best: of the whole circle near the encounter, or
        of the whole plane. The whole maps may have moved it, or named another one.
        """
        return self.proof is not None and self.proof.proven
