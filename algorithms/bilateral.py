"""Both robots saw each other: the transform follows from three angles and a range, eqs. (2), (3)."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field

from algorithms.chain import Chain, Memo
from algorithms.conclude import conclude
from algorithms.fuse import Conflict, Fusion, fuse
from algorithms.gridmap import GridMap
from algorithms.observation import (
    Observation,
    bilateral_covariance,
    bilateral_transform,
    encounter,
)
from algorithms.steps import Answer, AnswersDetail, ObservationDetail, Step
from algorithms.verdict import VerdictConfig


@dataclass(frozen=True)
class BilateralConfig:
    """Settings of the bilateral method: it has none but what follows the transform."""

    verdict: VerdictConfig = field(default_factory=VerdictConfig)
    conflict: Conflict = Conflict.OCCUPIED_WINS
    """Which map is believed where one says wall and the other says free."""


def run(
    ref: GridMap,
    mov: GridMap,
    observations: tuple[Observation, ...],
    config: BilateralConfig,
    seed: int = 0,
    memo: Memo | None = None,
    method: str = "bilateral",
) -> Iterator[Step]:
    """Yield the steps of the bilateral merge of the first sighting; the last one's detail is the MergeResult.

    raises SettingError where the observation lacks the bearing back or the observed heading
    """
    chain = Chain({} if memo is None else memo)
    observation = observations[0]
    seen: ObservationDetail = yield from chain.stage(
        "observe",
        (observations,),
        lambda: [ObservationDetail(tuple(encounter(observation) for observation in observations))],
    )
    found: AnswersDetail = yield from chain.stage(
        "search",
        (observation,),
        lambda: [AnswersDetail((Answer(bilateral_transform(observation), 0.0, "closed form"),))],
    )
    best = found.answers[0].T_ref_mov
    fusion: Fusion = yield from chain.stage(
        "fuse", (ref, mov, found, config.conflict), lambda: [fuse(ref, mov, best, config.conflict)]
    )
    yield from chain.stage(
        "verdict",
        (fusion, config.verdict, method),
        lambda: [
            conclude(
                ref,
                mov,
                best,
                fusion,
                seen.encounters,
                lambda _: bilateral_covariance(observation),
                config.verdict,
                value=None,
                answers=found.answers,
                method=method,
                seed=seed,
                timings_s=chain.timings_s,
            )
        ],
    )
