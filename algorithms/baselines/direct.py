"""What methods share that come to a transform in their own way: the sighting before, the verdict after."""

from __future__ import annotations

from collections.abc import Callable, Generator, Iterator
from dataclasses import dataclass, field

from algorithms.chain import Chain, Memo
from algorithms.conclude import conclude
from algorithms.fuse import Conflict, Fusion, fuse
from algorithms.gridmap import GridMap
from algorithms.observation import Observation, encounter
from algorithms.pose import FloatArray
from algorithms.steps import AnswersDetail, ObservationDetail, Step
from algorithms.verdict import VerdictConfig

Found = tuple[AnswersDetail, FloatArray]
"""Answers, best first, and the (3, 3) covariance of x, y, theta of the best; m and rad."""

Search = Callable[[Chain], Generator[Step, None, Found]]


@dataclass(frozen=True, kw_only=True)
class DirectConfig:
    """What follows the transform, whoever has found it."""

    verdict: VerdictConfig = field(default_factory=VerdictConfig)
    conflict: Conflict = Conflict.OCCUPIED_WINS
    """Which map is believed where one says wall and the other says free."""


def run_direct(
    ref: GridMap,
    mov: GridMap,
    observations: tuple[Observation, ...],
    config: DirectConfig,
    seed: int,
    memo: Memo | None,
    method: str,
    search: Search,
    valued: bool = True,
) -> Iterator[Step]:
    """Yield the steps of a merge whose transform comes from ``search``; the last one's detail is the
    MergeResult.

    search : yields its steps, a stage or several of the chain, and returns what it has found
    valued : whether the values of the answers say anything
    """
    chain = Chain({} if memo is None else memo)
    seen: ObservationDetail = yield from chain.stage(
        "observe",
        (observations,),
        lambda: [ObservationDetail(tuple(encounter(observation) for observation in observations))],
    )
    found, covariance = yield from search(chain)
    best = found.answers[0]
    fusion: Fusion = yield from chain.stage(
        "fuse",
        (ref, mov, found, config.conflict),
        lambda: [fuse(ref, mov, best.T_ref_mov, config.conflict)],
    )
    yield from chain.stage(
        "verdict",
        (fusion, seen, config.verdict, method),
        lambda: [
            conclude(
                ref,
                mov,
                best.T_ref_mov,
                fusion,
                seen.encounters,
                lambda _: covariance,
                config.verdict,
                value=best.value if valued else None,
                answers=found.answers,
                method=method,
                seed=seed,
                timings_s=chain.timings_s,
            )
        ],
    )
