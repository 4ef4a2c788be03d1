"""Features, matched, and the transform that most matches agree on: RANSAC (Fischler and Bolles 1981).

Nothing here uses the observation, as in the paper's comparison (section IV-C).
"""

from __future__ import annotations

from collections.abc import Generator, Iterator
from dataclasses import dataclass, field, replace
from typing import Annotated
from warnings import catch_warnings, filterwarnings

import numpy as np

from algorithms.common.errors import NoAnswerError
from algorithms.common.pose import FloatArray, Pose2
from algorithms.common.setting_bounds import Bounds, CheckedConfig
from algorithms.methods.baselines.base import BaselineConfig, weigh_best
from algorithms.methods.baselines.distance_image import MARGIN, PictureConfig, common_cell, picture
from algorithms.methods.baselines.feature_detectors import DetectorConfig, SiftConfig, describe
from algorithms.methods.merge_result import Answer
from algorithms.methods.shared_stages import Found
from algorithms.methods.stage_runner import StageRunner
from algorithms.methods.steps import AnswersDetail, Detail, MatchesDetail, Step
from algorithms.observations.pair_problem import PairProblem

LEAST = 2  # matches that a transform follows from
LEAST_DEVIATION = 0.01  # metres; no match of features is better


@dataclass(frozen=True)
class MatchConfig(CheckedConfig):
    """Which features are taken for the same place, and which transform is believed."""

    ratio: Annotated[float, Bounds(0.5, 1, 0.01, "", "", "ratio")] = 0.9
    """A match must be so much nearer than the second best (Lowe's ratio test); it must be mutual, too."""
    tolerance: Annotated[float, Bounds(0.02, 2, 0.01, "m", "", "tolerance")] = 0.3
    """A match agrees with a transform that takes it so near to its partner."""
    trials: Annotated[int, Bounds(100, 50_000, 100, "", "", "trials")] = 10_000
    """Pairs of matches that RANSAC tries at most."""
    least: Annotated[int, Bounds(2, 50, 1, "", "", "agreeing matches")] = 4
    """Refused where fewer matches agree: two always do, three by chance."""


@dataclass(frozen=True, kw_only=True)
class FeatureConfig(BaselineConfig):
    """Settings of a method that matches features."""

    picture: PictureConfig = field(default_factory=PictureConfig)
    detector: DetectorConfig = field(default_factory=SiftConfig)
    match: MatchConfig = field(default_factory=MatchConfig)


def search(
    problem: PairProblem, config: FeatureConfig, seed: int, runner: StageRunner
) -> Generator[Step, None, Found]:
    """Yield the steps of a merge by features.

    raises : NoAnswerError where too few matches agree on a transform; SettingError where the features
             come from a package that is not installed
    """
    matches: MatchesDetail = yield from runner.stage(
        "match",
        (problem, config.picture, config.detector, config.match.ratio),
        lambda: [match_features(problem, config)],
    )
    found: AnswersDetail = yield from runner.stage(
        "search", (matches, config.match, seed), lambda: _agree(matches, config.match, seed)
    )
    best = found.answers[0].T_ref_mov
    covariance = fit_covariance(agreeing(matches, best, config.match.tolerance), best)
    return (yield from weigh_best(problem, config, runner, found, covariance))


def match_features(problem: PairProblem, config: FeatureConfig) -> MatchesDetail:
    """The features of both maps, and which of them look alike: mutually nearest, by the ratio test."""
    from skimage.feature import match_descriptors  # slow to load, and no other method needs it

    cell = common_cell(problem.ref, problem.mov, config.picture.pixels)
    places, looks = [], []
    for grid in (problem.ref, problem.mov):
        drawn = picture(grid, cell, config.picture.reach, MARGIN)
        at, look = describe(drawn, config.detector)
        places.append(drawn.places(at))
        looks.append(look)
    pairs = np.empty((0, 2), dtype=np.intp)
    if all(len(at) > 1 for at in places):
        pairs = match_descriptors(looks[0], looks[1], cross_check=True, max_ratio=config.match.ratio)
    inliers = np.zeros(len(pairs), dtype=np.bool_)
    ref_at, mov_at = places
    return MatchesDetail(ref_at, mov_at, ref_at[pairs[:, 0]], mov_at[pairs[:, 1]], inliers)


def _agree(matches: MatchesDetail, config: MatchConfig, seed: int) -> Iterator[Detail]:
    from skimage.measure import ransac
    from skimage.transform import EuclideanTransform

    T, ref, mov = None, matches.ref, matches.mov
    if len(ref) >= max(LEAST, config.least):
        with catch_warnings():
            filterwarnings("ignore", "No inliers found")  # an answer, too, and reported below
            model, _ = ransac(
                (mov, ref),
                EuclideanTransform,
                min_samples=LEAST,
                residual_threshold=config.tolerance,
                is_data_valid=lambda a, b: _rigid(a, b, config.tolerance),
                max_trials=config.trials,
                stop_probability=0.9999,
                rng=seed,
            )
        T = Pose2.from_matrix(model.params) if model else None
    matched = matches if T is None else agreeing(matches, T, config.tolerance)
    yield matched
    agreed = int(matched.inliers.sum())
    if T is None or agreed < config.least:
        few = f"{min(len(matches.ref_features), len(matches.mov_features))} features"
        if len(ref) >= config.least:
            few = f"of {len(ref)} matched features {agreed or 'none'}"
        raise NoAnswerError(
            f"{few} agree on a transform, and {config.least} must; let the robots see more of the same, "
            "or take a method that uses the observation"
        )
    yield AnswersDetail((Answer(T, float(agreed), f"{agreed} of {len(ref)} matches agree"),))


def _rigid(mov: FloatArray, ref: FloatArray, tolerance: float) -> bool:
    """Whether two matches lie as far apart in one map as in the other, and far enough to tell a turn."""
    apart = np.linalg.norm(mov[1] - mov[0]), np.linalg.norm(ref[1] - ref[0])
    return bool(abs(apart[0] - apart[1]) < 2 * tolerance < apart[0])


def agreeing(matches: MatchesDetail, T_ref_mov: Pose2, tolerance: float) -> MatchesDetail:
    """The matches with those marked that a transform takes to their partners."""
    off = np.linalg.norm(T_ref_mov.apply(matches.mov) - matches.ref, axis=1)
    return replace(matches, inliers=off <= tolerance, T_ref_mov=T_ref_mov)


def fit_covariance(matches: MatchesDetail, T_ref_mov: Pose2) -> FloatArray:
    """(3, 3) of x, y, theta of the least-squares fit to the matches that agree; m and rad."""
    mov, ref = matches.mov[matches.inliers], matches.ref[matches.inliers]
    off = T_ref_mov.apply(mov) - ref
    turned = T_ref_mov.apply(mov) - T_ref_mov.xy
    jacobian = np.zeros((len(mov), 2, 3))
    jacobian[:, 0, 0] = jacobian[:, 1, 1] = 1
    jacobian[:, 0, 2], jacobian[:, 1, 2] = -turned[:, 1], turned[:, 0]
    rows = jacobian.reshape(-1, 3)
    variance = float((off**2).sum()) / max(1, 2 * len(mov) - 3)
    variance = max(variance, LEAST_DEVIATION**2)
    return np.asarray(variance * np.linalg.pinv(rows.T @ rows), dtype=np.float64)
