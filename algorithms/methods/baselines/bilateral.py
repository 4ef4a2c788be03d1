"""Both robots saw each other: the transform follows from three angles and a range, eqs. (2), (3)."""

from __future__ import annotations

from collections.abc import Generator

from algorithms.methods.baselines.base import BaselineConfig, weigh_best
from algorithms.methods.merge_result import Answer
from algorithms.methods.shared_stages import Found
from algorithms.methods.stage_runner import StageRunner
from algorithms.methods.steps import AnswersDetail, Step
from algorithms.observations.observation import bilateral_covariance, bilateral_transform
from algorithms.observations.pair_problem import PairProblem


def search(
    problem: PairProblem, config: BaselineConfig, seed: int, runner: StageRunner
) -> Generator[Step, None, Found]:
    """Yield the steps of the bilateral merge of the first sighting.

    raises SettingError where the observation lacks the bearing back or the observed heading
    """
    observation = problem.observations[0]
    found: AnswersDetail = yield from runner.stage(
        "search",
        (observation,),
        lambda: [AnswersDetail((Answer(bilateral_transform(observation), 0.0, "closed form"),))],
    )
    covariance = bilateral_covariance(observation)
    return (yield from weigh_best(problem, config, runner, found, covariance, valued=False))
