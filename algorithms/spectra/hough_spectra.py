"""Hough, X and Y spectra of augmented maps and their correlations, eqs. (11)–(16)."""

from __future__ import annotations

from dataclasses import dataclass
from math import pi
from typing import Annotated

import numpy as np
from numpy.fft import irfft, rfft  # not scipy's, which starts threads and takes 10 MB

from algorithms.common.parallel_kernels import kernel, run_in_threads
from algorithms.common.pose import FloatArray
from algorithms.common.setting_bounds import Bounds, CheckedConfig
from algorithms.spectra.augmented_map import AugmentedMap


@dataclass(frozen=True)
class SpectraConfig(CheckedConfig):
    """Settings of the Hough spectrum, eq. (11)."""

    directions: Annotated[int, Bounds(90, 1440, 90, "", "n_θ", "directions")] = 360
    """Directions over half a turn; 360 is one every half degree."""


@dataclass(frozen=True, eq=False)
class HoughMatch:
    """Two Hough spectra and what they say about the turn.

    angles      : (K,) k π / K; radians. Direction of a line's normal for the spectra, turn of the
                  mov map (or that turn + π) for the correlation
    ref, mov    : (K,) Hough spectra, each of sum 1 (all zeros for a map without walls)
    correlation : (K,) CC(k), eq. (12), highest value 1; the turn is +k, see ``correlate_turns``
    turns       : ranked turns in (−π, π], each with its twin; radians
    strengths   : correlation at each of the turns
    twins       : whether each of them is a peak's + π
    """

    angles: FloatArray
    ref: FloatArray
    mov: FloatArray
    correlation: FloatArray
    turns: tuple[float, ...]
    strengths: tuple[float, ...]
    twins: tuple[bool, ...]


@dataclass(frozen=True, eq=False)
class ShiftMatch:
    """X or Y spectra of two maps and what they say about the shift on that axis.

    ref, mov        : (A,), (B,) spectra, eq. (13) or (14); mov is turned already
    ref_at, mov_at  : (A,), (B,) where the bins lie on the axis; metres, ref frame
    shifts          : (C,) shifts of the pivot that were tried: where T puts it; metres, ref frame
    correlation     : (C,) eq. (15) or (16), highest value 1
    low, high       : the allowed window, eqs. (9), (10); metres
    shift           : best allowed shift; metres
    """

    ref: FloatArray
    mov: FloatArray
    ref_at: FloatArray
    mov_at: FloatArray
    shifts: FloatArray
    correlation: FloatArray
    low: float
    high: float
    shift: float


def hough_transform(augmented: AugmentedMap, directions: int, rho_step: float) -> FloatArray:
    """M_H: weighted votes of the cells for the lines through them.

    A line is x cos θ + y sin θ = ρ, with x, y taken from the encounter. A cell votes with its
    level, shared between three bins of ρ (a quadratic spline), so that a wall on the border of two
    bins weighs almost like one in the middle of a bin once the votes are squared.

    directions : K directions of the normal over [0, π)
    rho_step   : width of a bin of ρ; metres; one cell is a good choice
    returns    : (K, R) float64, the middle bin is ρ = 0; transposed against the paper's M_H(ρ, θ)
    """
    offset = augmented.points - augmented.x_hat
    reach = float(np.hypot(offset[:, 0], offset[:, 1]).max(initial=0.0)) / rho_step
    middle = int(reach) + 2
    votes = np.zeros((directions, 2 * middle + 1))
    x, y = np.ascontiguousarray(offset.T) / rho_step
    theta = np.arange(directions) * (pi / directions)
    cosines, sines = np.cos(theta), np.sin(theta)

    def work(start: int, stop: int) -> None:
        rows = slice(start, stop)
        _vote(x, y, augmented.levels, cosines[rows], sines[rows], middle, votes[rows])

    run_in_threads(work, directions, at_least=1 + 200_000 // (1 + len(x)))
    return votes


@kernel
def _vote(
    x: FloatArray,
    y: FloatArray,
    levels: FloatArray,
    cosines: FloatArray,
    sines: FloatArray,
    middle: int,
    votes: FloatArray,
) -> None:
    for k in range(cosines.shape[0]):
        for n in range(x.shape[0]):
            rho = x[n] * cosines[k] + y[n] * sines[k] + middle
            nearest = int(rho + 0.5)
            off = rho - nearest
            votes[k, nearest - 1] += levels[n] * 0.5 * (0.5 - off) ** 2
            votes[k, nearest] += levels[n] * (0.75 - off**2)
            votes[k, nearest + 1] += levels[n] * 0.5 * (0.5 + off) ** 2


def hough_spectrum(augmented: AugmentedMap, directions: int, rho_step: float) -> FloatArray:
    """HS(j) = Σ_ρ M_H(ρ, j)², eq. (11): how much of a map lies on straight lines, per direction.

    returns : (K,) of sum 1; all zeros for a map without walls. Period π: a shift of α between two
              spectra means a turn of α or of α + π.
    """
    votes = hough_transform(augmented, directions, rho_step)
    energy = np.einsum("kr,kr->k", votes, votes)  # eq. (11)
    total = float(energy.sum())
    return np.asarray(energy / total if total > 0 else energy, dtype=np.float64)


def correlate_turns(ref: FloatArray, mov: FloatArray) -> FloatArray:
    """CC(k) = Σ_i HS1(i + k) HS2(i), circular: eq. (12), highest value 1.

    The print has HS1(i) HS2(i + k), which peaks at minus the turn: where T turns map 2 by Δθ,
    HS1(θ) = HS2(θ − Δθ). Ours peaks at k = +Δθ.
    """
    size = len(ref)
    correlation = irfft(rfft(ref) * np.conj(rfft(mov)), size)  # eq. (12)
    best = float(correlation.max())
    return np.asarray(correlation / best if best > 0 else correlation, dtype=np.float64)


def parabolic_offset(left: float, middle: float, right: float) -> float:
    """Where, in bins from the middle one, the parabola through three samples has its top."""
    bend = left - 2 * middle + right
    return 0.0 if bend >= 0 else min(0.5, max(-0.5, 0.5 * (left - right) / bend))


def project(points: FloatArray, levels: FloatArray, step: float) -> tuple[FloatArray, FloatArray]:
    """A spectrum of eq. (13) or (14): levels summed over the cells that share a coordinate.

    points  : (N,) coordinate on the axis; metres
    step    : width of a bin; metres. A level is shared between the two nearest bins
    returns : (A,) sums and (A,) where the bins lie; metres, whole multiples of ``step``
    """
    if len(points) == 0:
        return np.zeros(1), np.zeros(1)
    at = points / step
    below = np.floor(at).astype(np.intp)
    first = int(below.min())
    share = at - below
    size = int(below.max()) - first + 2
    sums = np.zeros(size)
    sums += np.bincount(below - first, levels * (1 - share), size)
    sums += np.bincount(below - first + 1, levels * share, size)
    return sums, np.arange(first, first + size, dtype=np.float64) * step


def match_shift(
    ref: FloatArray,
    mov: FloatArray,
    ref_levels: FloatArray,
    mov_levels: FloatArray,
    step: float,
    low: float,
    high: float,
) -> ShiftMatch:
    """Shift along one axis from two spectra, eqs. (13)–(16), inside the window of eqs. (9), (10).

    ref, mov  : (N,), (M,) coordinates of the cells on the axis, mov turned already; metres
    low, high : allowed shifts; metres. Where no bin falls inside, the window's middle is taken
    """
    ref_sums, ref_at = project(ref, ref_levels, step)
    mov_sums, mov_at = project(mov, mov_levels, step)
    size = len(ref_sums) + len(mov_sums) - 1  # padded: eqs. (15), (16) are sums without wrap
    fast = fast_length(size)
    correlation = irfft(rfft(ref_sums, fast) * rfft(mov_sums[::-1], fast), fast)[:size]
    best = float(correlation.max())
    correlation = correlation / best if best > 0 else correlation
    shifts = ref_at[0] - mov_at[-1] + np.arange(size) * step
    allowed = np.flatnonzero((shifts >= low) & (shifts <= high))
    if len(allowed) == 0 or best <= 0:
        shift = (low + high) / 2
    else:
        k = int(allowed[np.argmax(correlation[allowed])])
        shift = float(shifts[k])
        if 0 < k < size - 1:
            shift += step * parabolic_offset(*correlation[k - 1 : k + 2].tolist())
        shift = min(high, max(low, shift))
    return ShiftMatch(ref_sums, mov_sums, ref_at, mov_at, shifts, correlation, low, high, shift)


def fast_length(least: int) -> int:
    """The next length of which a Fourier transform is quick: without a prime factor above 11."""
    while True:
        rest = least
        for prime in (2, 3, 5, 7, 11):
            while rest % prime == 0:
                rest //= prime
        if rest == 1:
            return least
        least += 1
