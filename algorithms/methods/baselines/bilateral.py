"""Both robots saw each other: the transform follows from three angles and a range, eqs. (2), (3)."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from algorithms.maps.grid_map import GridMap
from algorithms.methods.baselines.base import BaselineConfig, one_stage, run_direct
from algorithms.methods.merge_result import Answer
from algorithms.methods.stage_runner import StageCache
from algorithms.methods.steps import AnswersDetail, Step
from algorithms.observations.observation import Observation, bilateral_covariance, bilateral_transform


@dataclass(frozen=True, kw_only=True)
class BilateralConfig(BaselineConfig):
    """Settings of the bilateral method: it has none but what follows the transform."""


def run(
    ref: GridMap,
    mov: GridMap,
    observations: tuple[Observation, ...],
    config: BilateralConfig,
    seed: int = 0,
    memo: StageCache | None = None,
    method: str = "bilateral",
) -> Iterator[Step]:
    """Yield the steps of the bilateral merge of the first sighting; the last one's detail is the MergeResult.

    raises SettingError where the observation lacks the bearing back or the observed heading
    """
    observation = observations[0]
    search = one_stage(
        (observation, method),
        lambda: [AnswersDetail((Answer(bilateral_transform(observation), 0.0, "closed form"),))],
        lambda: bilateral_covariance(observation),
    )
    return run_direct(ref, mov, observations, config, seed, memo, method, search, valued=False)
