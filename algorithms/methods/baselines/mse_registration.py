"""Image registration by the mean squared error: every turn, every shift, then the best ones refined.

The paper compares with "MSE based image registration" and does not say more. A descent from where the maps
happen to lie finds nothing, so this one looks everywhere. It does not use the observation. Of 28 pairs of
real maps and 16 simulated ones 24 and 16 come out right. The coarse search alone finds 24 and 16 roughly at a
least overlap of 20 %, 18 and 16 at 10 %; of half of them 11 and 4 at 30 %, 9 and 2 at 50 %. With blurred
walls in place of distances it finds 12 and 9 at 15 %.
"""

from __future__ import annotations

from collections.abc import Generator, Iterator
from dataclasses import dataclass, field
from typing import Annotated, Any

import numpy as np
import scipy  # its parts are loaded where they are first used
from numpy.typing import NDArray

from algorithms.common.errors import NoAnswerError
from algorithms.common.pose import FloatArray, Pose2, wrap_angle
from algorithms.common.setting_bounds import Bounds, CheckedConfig
from algorithms.methods.baselines.base import BaselineConfig, weigh_best
from algorithms.methods.baselines.distance_image import (
    DistanceImage,
    PictureConfig,
    Turn,
    common_cell,
    picture,
    pose_of,
)
from algorithms.methods.baselines.overlap_error import OverlapError, extent
from algorithms.methods.merge_result import Answer
from algorithms.methods.shared_stages import Found
from algorithms.methods.stage_runner import StageRunner
from algorithms.methods.steps import AnswersDetail, Detail, Step, TurnsDetail
from algorithms.observations.pair_problem import PairProblem
from algorithms.spectra.candidates import circular_peaks

YIELD_EVERY = 10  # turns


@dataclass(frozen=True)
class TurnConfig(CheckedConfig):
    """The search through all turns and shifts."""

    step: Annotated[float, Bounds(1, 10, 0.5, "°", "", "turn step")] = 3.0
    """Turns that are tried lie so far apart."""
    pixels: Annotated[int, Bounds(50, 400, 10, "", "", "coarse side")] = 150
    """Pixels on the longest side of the pictures that are turned and shifted."""
    overlap: Annotated[float, Bounds(0.01, 1, 0.01, "", "", "least overlap")] = 0.2
    """Share of the smaller map's known area that both maps must know. With less, a strip of free floor on a
    strip of free floor fits best of all."""
    kept: Annotated[int, Bounds(1, 24, 1, "", "", "refined")] = 6
    """How many of the best turns are refined."""


@dataclass(frozen=True, kw_only=True)
class MseConfig(BaselineConfig):
    """Settings of the registration by mean squared error."""

    picture: PictureConfig = field(default_factory=PictureConfig)
    turns: TurnConfig = field(default_factory=TurnConfig)


def search(
    problem: PairProblem, config: MseConfig, seed: int, runner: StageRunner
) -> Generator[Step, None, Found]:
    """Yield the steps of the registration.

    raises : NoAnswerError where a map has no walls, or where the maps share too little at every turn
    """
    found: AnswersDetail = yield from runner.stage(
        "search", (problem, config.picture, config.turns, seed), lambda: _search(problem, config, seed)
    )
    return (yield from weigh_best(problem, config, runner, found, raster_covariance(problem)))


def check_walls(problem: PairProblem) -> None:
    """Raise NoAnswerError where one of the maps has no walls to compare."""
    for grid in (problem.ref, problem.mov):
        if not grid.occupied.any():
            raise NoAnswerError(f"{grid.name} has no walls that could be compared with the other map's")


def raster_covariance(problem: PairProblem) -> FloatArray:
    """(3, 3) of a method that says nothing of how sure it is: a cell, and the turn that moves by a cell."""
    cell = max(problem.ref.resolution, problem.mov.resolution)
    return np.diag([cell, cell, cell / max(extent(problem.mov), cell)]) ** 2


def _search(problem: PairProblem, config: MseConfig, seed: int) -> Iterator[Detail]:
    """All turns at a coarse raster, the best of them on finer ones."""
    check_walls(problem)
    ref, mov = problem.ref, problem.mov
    cell = common_cell(ref, mov, config.turns.pixels)
    wide = max(config.picture.reach, 2 * cell)
    coarse = picture(ref, cell, wide), picture(mov, cell, wide)
    turns = np.radians(np.arange(-180, 180, config.turns.step))
    scores, poses = np.full(len(turns), np.nan), []
    compare = _Shifts(*coarse, config.turns.overlap)
    for index, angle in enumerate(turns.tolist()):
        scores[index], pose = compare.best(angle)
        poses.append(pose)
        if index % YIELD_EVERY == 0:
            yield TurnsDetail(turns, scores.copy())
    best = [index for index in circular_peaks(scores) if np.isfinite(scores[index])][: config.turns.kept]
    if not best:
        raise NoAnswerError(f"at no turn do both maps know {config.turns.overlap:.0%} of the smaller area")
    fine = common_cell(ref, mov, config.picture.pixels)
    levels = []
    for size, reach in ((max(fine, cell / 2), wide), (fine, config.picture.reach)):
        pair = picture(ref, size, reach), picture(mov, size, reach)
        levels.append((OverlapError.of(*pair, 0.8 * config.turns.overlap, seed), size))
    answers = []
    for index in best:
        T, error = poses[index], 1.0
        for overlap, size in levels:
            T, error = overlap.best_near(T, 2 * size)
        answers.append(Answer(T, 1 - error, f"mean squared error {error:.4f}"))
    answers.sort(key=lambda answer: -answer.value)
    askew = ref.origin.theta - mov.origin.theta
    yield TurnsDetail(turns, scores, wrap_angle(answers[0].T_ref_mov.theta - askew))
    yield AnswersDetail(tuple(answers))


class _Shifts:
    """The mean squared error of two pictures at all shifts at once, by Fourier transforms."""

    def __init__(self, ref: DistanceImage, mov: DistanceImage, least: float) -> None:
        self._ref, self._mov = ref, mov
        side = Turn.of(mov.far.shape, 0.0).side
        self._size = tuple(scipy.fft.next_fast_len(length + side, real=True) for length in ref.far.shape)
        self._need = least * min(int(ref.known.sum()), int(mov.known.sum()))
        self._ref_sums = self._sums(ref.far, ref.known.astype(np.float32))

    def _sums(self, far: NDArray[Any], known: NDArray[Any]) -> tuple[NDArray[Any], ...]:
        return tuple(scipy.fft.rfft2(part, self._size) for part in (far * known, far**2 * known, known))

    def best(self, angle: float) -> tuple[float, Pose2]:
        """One less the least error of this turn, and the transform; −inf where the overlap is too small."""
        turn = Turn.of(self._mov.far.shape, angle)
        known = turn(self._mov.known.astype(np.float32))
        far = turn(self._mov.far, 1.0)
        once, squared, counted = self._ref_sums
        mov_once, mov_squared, mov_counted = (part.conj() for part in self._sums(far, known))
        both = scipy.fft.irfft2(counted * mov_counted, self._size)
        off = scipy.fft.irfft2(
            squared * mov_counted + counted * mov_squared - 2 * once * mov_once, self._size
        )
        error = np.where(both >= self._need, off / np.maximum(both, 1), np.inf)
        at = np.unravel_index(int(error.argmin()), error.shape)
        row, col = (
            int(k) if k < length else int(k) - size
            for k, length, size in zip(at, self._ref.far.shape, self._size, strict=True)
        )
        return 1 - float(error[at]), pose_of(self._ref, self._mov, turn, np.array([col, row]))
