"""What methods share that come to a transform in their own way: the sighting before, the verdict after."""

from __future__ import annotations

from collections.abc import Callable, Generator, Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from typing import Any

from algorithms.common.pose import FloatArray, Pose2
from algorithms.maps.grid_map import GridMap
from algorithms.maps.map_fusion import ConflictRule, Fusion, fuse
from algorithms.methods.merge_result import finish_merge
from algorithms.methods.stage_runner import StageCache, StageRunner
from algorithms.methods.steps import AnswersDetail, Detail, ObservationDetail, Step, WeighedDetail
from algorithms.observations.observation import Encounter, Observation, encounters_of, robots_of
from algorithms.observations.search_window import WindowConfig, coupled_window
from algorithms.optimisation.likelihood_field import AgreementConfig
from algorithms.verdict.decision import VerdictConfig
from algorithms.verdict.probability_model import shipped_model
from algorithms.verdict.ranking import better_beside, weigh
from algorithms.verdict.whole_maps import make_whole_maps

Found = tuple[AnswersDetail, FloatArray]
"""Answers, best first, and the (3, 3) covariance of x, y, theta of the best; m and rad."""

Search = Callable[[StageRunner], Generator[Step, None, Found]]


def one_stage(
    inputs: tuple[Any, ...], make: Callable[[], Iterable[Detail]], covariance: Callable[[], FloatArray]
) -> Search:
    """A search of a single stage, whose last detail is its AnswersDetail.

    inputs, make : as ``StageRunner.stage`` has them
    covariance   : (3, 3) of the best answer
    """

    def search(runner: StageRunner) -> Generator[Step, None, Found]:
        found: AnswersDetail = yield from runner.stage("search", inputs, make)
        return found, covariance()

    return search


@dataclass(frozen=True, kw_only=True)
class BaselineConfig:
    """What follows the transform, whoever has found it."""

    verdict: VerdictConfig = field(default_factory=VerdictConfig)
    conflict: ConflictRule = ConflictRule.OCCUPIED_WINS
    """Which map is believed where one says wall and the other says free."""


def run_direct(
    ref: GridMap,
    mov: GridMap,
    observations: tuple[Observation, ...],
    config: BaselineConfig,
    seed: int,
    memo: StageCache | None,
    method: str,
    search: Search,
    valued: bool = True,
) -> Iterator[Step]:
    """Yield the steps of a merge whose transform comes from ``search``; the last one's detail is the
    MergeResult.

    search : yields its steps, a stage or several, and returns what it has found
    valued : whether the values of the answers say anything
    """
    runner = StageRunner({} if memo is None else memo)
    seen: ObservationDetail = yield from runner.stage(
        "observe",
        (observations, ref.resolution, mov.resolution),
        lambda: [ObservationDetail(encounters_of(observations, ref, mov))],
    )
    found, covariance = yield from search(runner)
    best, size = found.answers[0], config.verdict.robot_size
    weighed: WeighedDetail = yield from runner.stage(
        "weigh",
        (ref, mov, seen, found, size),
        lambda: [_weigh(ref, mov, seen.encounters, best.T_ref_mov, size)],
    )
    fusion: Fusion = yield from runner.stage(
        "fuse",
        (ref, mov, weighed, config.conflict, size),
        lambda: [
            fuse((ref, mov), (Pose2(), best.T_ref_mov), config.conflict, robots_of(seen.encounters, size))
        ],
    )
    named, *beside = weighed.answers
    yield from runner.stage(
        "verdict",
        (fusion, weighed, config.verdict, method),
        lambda: [
            finish_merge(
                named,
                beside or None,
                fusion,
                seen.encounters,
                covariance,
                config.verdict,
                value=best.value if valued else None,
                answers=found.answers,
                method=method,
                seed=seed,
                timings_s=runner.timings_s,
            )
        ],
    )


def _weigh(
    ref: GridMap, mov: GridMap, encounters: Sequence[Encounter], T_ref_mov: Pose2, robot_size: float
) -> WeighedDetail:
    """The method's own transform by the whole maps, and a better one beside it, where there is one."""
    window = coupled_window(encounters, WindowConfig())
    whole = make_whole_maps(ref, mov, encounters, window, AgreementConfig().evidence, robot_size)
    named = weigh(whole, T_ref_mov, shipped_model())
    return WeighedDetail((named, *better_beside(whole, named, shipped_model())))
