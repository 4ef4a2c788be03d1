"""What methods share that come to a transform in their own way: settings, and how the whole maps weigh it."""

from __future__ import annotations

from collections.abc import Generator
from dataclasses import dataclass, field

from algorithms.common.pose import FloatArray, Pose2
from algorithms.maps.map_fusion import ConflictRule
from algorithms.methods.shared_stages import Found
from algorithms.methods.stage_runner import StageRunner
from algorithms.methods.steps import AnswersDetail, Step, WeighedDetail
from algorithms.observations.pair_problem import PairProblem
from algorithms.observations.search_window import WindowConfig
from algorithms.optimisation.likelihood_field import AgreementConfig
from algorithms.optimisation.plane_correlation import PlaneConfig, searched_area
from algorithms.verdict.decision import VerdictConfig
from algorithms.verdict.probability_model import ModelKind, shipped_model
from algorithms.verdict.ranking import better_beside, weigh
from algorithms.verdict.whole_maps import WholeMaps, make_whole_maps


@dataclass(frozen=True, kw_only=True)
class BaselineConfig:
    """What follows the transform, whoever has found it."""

    verdict: VerdictConfig = field(default_factory=VerdictConfig)
    conflict: ConflictRule = ConflictRule.OCCUPIED_WINS
    """Which map is believed where one says wall and the other says free."""


def weigh_best(
    problem: PairProblem,
    config: BaselineConfig,
    runner: StageRunner,
    found: AnswersDetail,
    covariance: FloatArray,
    valued: bool = True,
) -> Generator[Step, None, Found]:
    """Yield the step in which the whole maps weigh the best answer, and one beside it that is better.

    covariance : (3, 3) of x, y, theta of the best answer; metres and radians
    valued     : whether the values of the answers say anything
    """
    best, size = found.answers[0], config.verdict.robot_size
    weighed: WeighedDetail = yield from runner.stage(
        "weigh", (problem, found, size), lambda: [_weigh(problem, best.T_ref_mov, size)]
    )
    named, *beside = weighed.answers
    value = best.value if valued else None
    return Found(named, beside or None, covariance, found.answers, value, kind=model_kind(problem))


def _weigh(problem: PairProblem, T_ref_mov: Pose2, robot_size: float) -> WeighedDetail:
    whole, model = whole_maps(problem, robot_size), shipped_model(model_kind(problem))
    named = weigh(whole, T_ref_mov, model)
    return WeighedDetail((named, *better_beside(whole, named, model)))


def model_kind(problem: PairProblem) -> ModelKind:
    """Which model weighs an answer: without a sighting it may have come from anywhere on the plane."""
    return "sighting" if problem.observations else "plane"


def whole_maps(problem: PairProblem, robot_size: float) -> WholeMaps:
    """Both maps as a whole, for a method that has no settings for it; metres."""
    window, robots = problem.window(WindowConfig()), problem.robots(robot_size)
    searched = 0.0 if problem.observations else searched_area(problem.ref, problem.mov, PlaneConfig(), window)
    return make_whole_maps(problem.ref, problem.mov, robots, window, AgreementConfig().evidence, searched)
