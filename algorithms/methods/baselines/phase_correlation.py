"""Phase correlation: the turn from the amplitudes of the spectra (Reddy and Chatterji 1996), then the shift.

The resolutions give the scale, so the amplitudes are looked up in polar coordinates, not log-polar ones. They
have period π: each turn is tried with its twin. It does not use the observation. Of 28 pairs of real maps and
16 simulated ones 23 and 13 come out right. Of half of them 9 and 7 with amplitudes up to half of the highest
frequency, with all of them 8 and 7, without whitening of the shift's spectrum 8 and 3.
"""

from __future__ import annotations

from collections.abc import Generator, Iterator
from dataclasses import dataclass, field, replace
from math import ceil, pi
from typing import Annotated

import numpy as np
import scipy  # its parts are loaded where they are first used

from algorithms.common.errors import NoAnswerError
from algorithms.common.pose import FloatArray, wrap_angle
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
from algorithms.methods.baselines.mse_registration import check_walls, raster_covariance
from algorithms.methods.baselines.overlap_error import UNLIKE, OverlapError
from algorithms.methods.merge_result import Answer
from algorithms.methods.shared_stages import Found
from algorithms.methods.stage_runner import StageRunner
from algorithms.methods.steps import AnswersDetail, Detail, Step, TurnsDetail
from algorithms.observations.pair_problem import PairProblem
from algorithms.spectra.candidates import circular_peaks

DIRECTIONS = 720  # over a whole turn
UPSAMPLED = 4  # steps per pixel of the shift


@dataclass(frozen=True)
class PhaseConfig(CheckedConfig):
    """The turn from the spectra's amplitudes, the shift from their phases."""

    frequencies: Annotated[float, Bounds(0.05, 1, 0.05, "", "", "frequencies")] = 0.5
    """Share of the frequencies, from the lowest on, whose amplitudes tell the turn."""
    peaks: Annotated[int, Bounds(1, 12, 1, "", "", "peaks")] = 4
    """Best turns that are tried, each with its twin."""
    overlap: Annotated[float, Bounds(0.01, 1, 0.01, "", "", "least overlap")] = 0.1
    """Share of the smaller map's known area that both maps must know. Of the turns tried, the one whose maps
    then differ least wins."""


@dataclass(frozen=True, kw_only=True)
class PhaseCorrelationConfig(BaselineConfig):
    """Settings of the phase correlation."""

    picture: PictureConfig = field(default_factory=lambda: PictureConfig(reach=0.2, pixels=400))
    phase: PhaseConfig = field(default_factory=PhaseConfig)


def search(
    problem: PairProblem, config: PhaseCorrelationConfig, seed: int, runner: StageRunner
) -> Generator[Step, None, Found]:
    """Yield the steps of the phase correlation.

    raises : NoAnswerError where a map has no walls, or where the maps share too little at every turn tried
    """
    found: AnswersDetail = yield from runner.stage(
        "search", (problem, config.picture, config.phase, seed), lambda: _search(problem, config, seed)
    )
    return (yield from weigh_best(problem, config, runner, found, raster_covariance(problem)))


def _search(problem: PairProblem, config: PhaseCorrelationConfig, seed: int) -> Iterator[Detail]:
    """The turns, then a shift for each of the best."""
    check_walls(problem)
    ref, mov = problem.ref, problem.mov
    cell = common_cell(ref, mov, config.picture.pixels)
    reach = max(config.picture.reach, 1.5 * cell)
    pair = picture(ref, cell, reach), picture(mov, cell, reach)
    size = 2 * scipy.fft.next_fast_len(max(ceil(np.hypot(*each.far.shape)) for each in pair) + 1)
    half = turn_correlation(*pair, size, config.phase.frequencies)
    angles = np.arange(DIRECTIONS, dtype=np.float64) * (2 * pi / DIRECTIONS) - pi
    tried = TurnsDetail(angles, np.concatenate([half, half]))
    yield tried
    overlap = OverlapError.of(*pair, config.phase.overlap, seed)
    answers = []
    for peak in circular_peaks(half)[: config.phase.peaks]:
        for twin in (0.0, pi):
            turn = Turn.of(pair[1].far.shape, wrap_angle(2 * pi * peak / DIRECTIONS + twin))
            shift = _shift(pair[0], pair[1], turn, size)
            T = pose_of(*pair, turn, shift)
            error = overlap.error(T)
            if error < UNLIKE:
                answers.append((Answer(T, 1 - error, f"mean squared error {error:.4f}"), turn.angle))
    if not answers:
        raise NoAnswerError(
            f"at none of the turns tried do both maps know {config.phase.overlap:.0%} of the smaller area"
        )
    answers.sort(key=lambda tried: -tried[0].value)
    yield replace(tried, best=answers[0][1])
    yield AnswersDetail(tuple(answer for answer, _ in answers))


def turn_correlation(ref: DistanceImage, mov: DistanceImage, size: int, frequencies: float) -> FloatArray:
    """(DIRECTIONS / 2,) how well the amplitudes coincide when mov is turned by k steps, or by those and π."""
    from skimage.transform import warp_polar  # slow to load, and no other method needs it

    polar = []
    for each in (ref, mov):
        amplitudes = np.log1p(
            np.abs(scipy.fft.fftshift(scipy.fft.fft2(1 - each.far.astype(np.float64), (size, size))))
        )
        radius = max(2, int(frequencies * size / 2))
        rays = warp_polar(
            amplitudes, (size // 2, size // 2), radius=radius, output_shape=(DIRECTIONS, radius), order=1
        )[: DIRECTIONS // 2, 1:]  # the mean brightness, in the middle, has no direction
        rays = rays - rays.mean(axis=0)  # a ring that is bright all around tells no turn
        polar.append(rays / np.maximum(rays.std(axis=0), 1e-9))
    product = scipy.fft.fft(polar[0], axis=0) * scipy.fft.fft(polar[1], axis=0).conj()
    return np.asarray(scipy.fft.ifft(product, axis=0).real.sum(axis=1) / polar[0].size, dtype=np.float64)


def _shift(ref: DistanceImage, mov: DistanceImage, turn: Turn, size: int) -> FloatArray:
    """(2,) columns and rows by which mov, turned, must be moved, from the phases of the spectra."""
    from skimage.registration import phase_cross_correlation

    images = np.zeros((2, size, size), dtype=np.float32)
    height, width = ref.far.shape
    images[0, :height, :width] = 1 - ref.far
    images[1, : turn.side, : turn.side] = turn(1 - mov.far)
    rows_cols, _, _ = phase_cross_correlation(
        images[0], images[1], normalization="phase", upsample_factor=UPSAMPLED
    )
    # the spectra have the period of the square: the shift under which both pictures can touch is meant
    rows_cols = np.where(rows_cols <= -turn.side, rows_cols + size, rows_cols)
    rows_cols = np.where(rows_cols >= ref.far.shape, rows_cols - size, rows_cols)
    return np.asarray(rows_cols[::-1], dtype=np.float64)
