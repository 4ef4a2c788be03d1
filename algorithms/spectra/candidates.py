"""Spectra-based map merging: from two augmented maps to ranked candidates for the transform."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from math import pi
from typing import Annotated

import numpy as np

from algorithms.common.pose import FloatArray, Pose2, rotation, wrap_angle
from algorithms.common.setting_bounds import Bounds, CheckedConfig
from algorithms.observations.search_window import CoupledWindow, Window
from algorithms.spectra.augmented_map import AugmentedMap
from algorithms.spectra.hough_spectra import (
    HoughMatch,
    ShiftMatch,
    SpectraConfig,
    correlate_turns,
    hough_spectrum,
    match_shift,
    parabolic_offset,
)


@dataclass(frozen=True)
class CandidateConfig(CheckedConfig):
    """How many answers of the spectra are followed up."""

    peaks: Annotated[int, Bounds(1, 12, 1, "", "", "peaks")] = 4
    """Peaks of the correlation that are tried. The paper takes the highest alone."""
    twins: bool = True
    """Try every turn + π too: a Hough spectrum has period π and cannot tell them apart."""


@dataclass(frozen=True, eq=False)
class Candidate:
    """One answer of the spectra.

    T_ref_mov : turn from the Hough spectra, shift from the X and Y spectra
    strength  : correlation of the Hough spectra at this turn, highest 1
    twin      : whether the turn is a peak's + π
    x, y      : the X and Y spectra it came from
    value     : best Γ that a first look into its box found; None before that look
    """

    T_ref_mov: Pose2
    strength: float
    twin: bool
    x: ShiftMatch
    y: ShiftMatch
    value: float | None = None


def match_turns(
    ref: AugmentedMap, mov: AugmentedMap, spectra: SpectraConfig, candidates: CandidateConfig
) -> HoughMatch:
    """Hough spectra, correlation and ranked turns, eqs. (11), (12).

    Both maps vote in bins as wide as the coarser map's cells: with the finer width the coarser
    raster itself would look like a set of lines.
    """
    step = max(ref.grid.resolution, mov.grid.resolution)
    first = hough_spectrum(ref, spectra.directions, step)
    second = hough_spectrum(mov, spectra.directions, step)
    correlation = correlate_turns(first, second)
    size, ranked = len(correlation), []
    for peak in circular_peaks(correlation)[: candidates.peaks]:
        left, strength, right = correlation[[peak - 1, peak, (peak + 1) % size]].tolist()
        turn = (peak + parabolic_offset(left, strength, right)) * pi / size
        for twin in (0.0, pi) if candidates.twins else (0.0,):
            ranked.append((wrap_angle(turn + twin), strength, twin > 0))
    angles = np.arange(size, dtype=np.float64) * (pi / size)
    turns, strengths, twins = zip(*ranked, strict=True)
    return HoughMatch(angles, first, second, correlation, turns, strengths, twins)


def circular_peaks(signal: FloatArray) -> list[int]:
    """Indices of the local maxima of a periodic signal, highest first; index 0 of a flat one."""
    higher = (signal > np.roll(signal, 1)) & (signal >= np.roll(signal, -1))
    peaks = np.flatnonzero(higher)
    if len(peaks) == 0:
        return [0]
    return [int(k) for k in peaks[np.argsort(-signal[peaks], kind="stable")]]


def shift_candidates(
    ref: AugmentedMap, mov: AugmentedMap, match: HoughMatch, window: Window | CoupledWindow
) -> Iterator[Candidate]:
    """Yield one candidate per turn: X and Y spectra of the turned map, eqs. (13)–(16)."""
    step = max(ref.grid.resolution, mov.grid.resolution)
    for turn, strength, twin in zip(match.turns, match.strengths, match.twins, strict=True):
        cells = (mov.points - window.pivot) @ rotation(turn).T  # T(0, 0, turn) M2, seen from its pivot
        x, y = (
            match_shift(
                ref.points[:, axis],
                cells[:, axis],
                ref.levels,
                mov.levels,
                step,
                float(window.low[axis]),
                float(window.high[axis]),
            )
            for axis in (0, 1)
        )
        goes_to = np.array([x.shift, y.shift])
        shift_x, shift_y = (goes_to - rotation(turn) @ window.pivot).tolist()
        yield Candidate(Pose2(shift_x, shift_y, turn), strength, twin, x, y)
