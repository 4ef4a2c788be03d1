"""The numbers behind the curves: aligned arrays for one x axis, no widgets."""

from __future__ import annotations

from math import degrees

import numpy as np

from algorithms.pose import FloatArray
from algorithms.smm import Candidate
from algorithms.spectra import HoughMatch, ShiftMatch

Columns = tuple[FloatArray, ...]


def _to_one(values: FloatArray) -> FloatArray:
    top = float(values.max(initial=0.0))
    return np.asarray(values / top if top > 0 else values, dtype=np.float64)


def _marked(x: FloatArray, at: FloatArray, height: FloatArray) -> FloatArray:
    """Heights at the samples of x nearest to ``at``, NaN elsewhere."""
    marks = np.full(len(x), np.nan)
    if len(x) and len(at):
        marks[np.abs(x[:, None] - at[None, :]).argmin(axis=0)] = height
    return marks


def hough_spectra(match: HoughMatch) -> Columns:
    """Direction in degrees, spectrum of map 1, of map 2; highest value 1."""
    return np.degrees(match.angles), _to_one(match.ref), _to_one(match.mov)


def turn_correlation(match: HoughMatch, chosen: float | None) -> Columns:
    """Turn in degrees, correlation, candidates, and the chosen one (radians, any twin)."""
    x = np.degrees(match.angles)
    turns = np.mod(np.degrees(np.array(match.turns)), 180.0)
    marks = _marked(x, turns, np.array(match.strengths))
    best = np.full(len(x), np.nan)
    if chosen is not None and len(x):
        k = int(np.abs(np.mod(x - degrees(chosen) + 90, 180) - 90).argmin())
        best[k] = match.correlation[k]
    return x, match.correlation, marks, best


def shift_spectra(match: ShiftMatch) -> Columns:
    """Position in metres, spectrum of map 1, of map 2 turned and shifted by the best shift."""
    step = float(match.ref_at[1] - match.ref_at[0]) if len(match.ref_at) > 1 else 1.0
    moved = np.round((match.mov_at + match.shift) / step).astype(int)
    fixed = np.round(match.ref_at / step).astype(int)
    first, last = min(fixed[0], moved[0]), max(fixed[-1], moved[-1])
    columns = np.zeros((2, last - first + 1))
    columns[0, fixed - first] = _to_one(match.ref)
    columns[1, moved - first] = _to_one(match.mov)
    return np.arange(first, last + 1) * step, columns[0], columns[1]


def shift_correlation(match: ShiftMatch) -> Columns:
    """Shift in metres, the allowed window as a bar of height 1.05, correlation, the chosen shift.

    The axis reaches over the window and some metres beyond, so that both its edges are seen.
    """
    pad = max(4.0, 0.25 * (match.high - match.low))
    near = (match.shifts >= match.low - pad) & (match.shifts <= match.high + pad)
    shifts, correlation = match.shifts[near], match.correlation[near]
    if len(shifts) == 0:
        shifts, correlation = np.array([match.low, match.high]), np.zeros(2)
    extra = np.array([match.low - pad, match.low, match.low, match.high, match.high, match.high + pad])
    extra[1] -= 1e-6
    extra[4] += 1e-6
    x = np.concatenate([shifts, extra])
    y = np.concatenate([correlation, np.interp(extra, match.shifts, match.correlation, left=0.0, right=0.0)])
    order = np.argsort(x, kind="stable")
    x, y = x[order], y[order]
    window = np.where((x >= match.low) & (x <= match.high), 1.05, 0.0)
    top = float(np.interp(match.shift, shifts, correlation))
    return x, window, y, _marked(x, np.array([match.shift]), np.array([top]))


def gammas(courses: list[list[float]], lines: int) -> Columns:
    """Iteration, then best Γ so far for each refined candidate; one that has ended stays where it was, one
    that has not begun lies on the axis (NaN would keep the chart from finding its own scale).
    """
    longest = max(2, max((len(course) for course in courses), default=0))
    table = np.zeros((lines, longest))
    for row, course in zip(table, courses, strict=False):
        if course:
            row[: len(course)], row[len(course) :] = course, course[-1]
    return (np.arange(1, longest + 1, dtype=float), *table)


def candidate_rows(candidates: tuple[Candidate, ...], refined: list[list[float]]) -> list[tuple[str, ...]]:
    """Rank, turn, shift, Γ of the first look, Γ after refining."""
    rows = []
    for rank, candidate in enumerate(candidates):
        T = candidate.T_ref_mov
        after = f"{refined[rank][-1]:.4g}" if rank < len(refined) and refined[rank] else "–"
        rows.append(
            (
                f"{rank + 1}{'  + π' if candidate.twin else ''}",
                f"{degrees(T.theta):.1f}°",
                f"{T.x:.2f}",
                f"{T.y:.2f}",
                f"{candidate.value or 0:.4g}",
                after,
            )
        )
    return rows
