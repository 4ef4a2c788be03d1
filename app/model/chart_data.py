"""The numbers behind the curves: aligned arrays for one x axis, no widgets."""

from __future__ import annotations

from math import degrees

import numpy as np

from algorithms.common.pose import FloatArray
from algorithms.methods.steps import TurnsDetail
from algorithms.optimisation.branch_and_bound import ProofState
from algorithms.spectra.candidates import Candidate
from algorithms.spectra.hough_spectra import HoughMatch, ShiftMatch
from app.model.objective_label import ObjectiveLabel

Columns = tuple[FloatArray, ...]

# title, and what the x axis is; {} stands for what is maximised
HOUGH = ("Hough spectra, eq. (11)", "direction (°)")
TURNS = ("Their correlation, eq. (12)", "turn Δθ (°), or that + 180°")
SHIFT_X = ("Correlation, window shaded", "Δx (m)")
SHIFT_Y = ("Correlation, window shaded", "Δy (m)")
CLIMB = ("Best {} so far", "iteration")
CIRCLE = ("Best {} at every turn", "turn Δθ (°)")
PROOF = ("Best {} at every turn", "turn Δθ (°), the whole circle")


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


def circle(detail: TurnsDetail) -> Columns:
    """Turn in degrees, how well the maps agree, and the best turn; turns that are not tried yet lie where
    the worst of the others does.
    """
    x, y = np.degrees(detail.turns), np.asarray(detail.scores, dtype=np.float64)
    y = np.where(np.isfinite(y), y, float(y[np.isfinite(y)].min(initial=np.inf)))
    y = np.where(np.isfinite(y), y, 0.0)
    best = np.full(len(x), np.nan)
    turn = detail.turns[y.argmax()] if detail.best is None else detail.best
    k = int(np.abs(np.mod(x - degrees(turn) + 180, 360) - 180).argmin())
    best[k] = y[k]
    return x, y, best


def circle_range(detail: TurnsDetail) -> tuple[float, float]:
    """Axis of the agreement: from the worst of the turns to the best, and a little more."""
    y = detail.scores[np.isfinite(detail.scores)]
    low, high = (float(y.min()), float(y.max())) if len(y) else (0.0, 1.0)
    room = 0.08 * max(high - low, 1e-3)
    return low - room, high + room


def turn_range(match: HoughMatch) -> tuple[float, float]:
    """Axis of the correlation: every direction has some lines, drawn from zero the peaks would be ripples."""
    low = float(match.correlation.min())
    return (low - 0.05 * (1 - low), 1 + 0.1 * (1 - low)) if low < 0.99 else (0.0, 1.1)


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


def courses(told: list[list[float]], lines: int) -> Columns:
    """Iteration, then best value so far for each refined candidate; one that has ended stays where it was,
    one that has not begun, or has met nothing in the window yet, lies on the axis (NaN would keep the
    chart from finding its own scale).
    """
    longest = max(2, max((len(course) for course in told), default=0))
    table = np.zeros((lines, longest))
    for row, course in zip(table, told, strict=False):
        if course:
            row[: len(course)], row[len(course) :] = course, course[-1]
    table[~np.isfinite(table)] = 0.0
    return (np.arange(1, longest + 1, dtype=float), *table)


def proof_range(state: ProofState, ceiling: float) -> tuple[float, float]:
    """Lower and upper end of the axis on which a proof is drawn.

    ceiling : the bound that it began with, so that the axis stands still while the bounds come down
    """
    top = max(value if np.isfinite(value) else 0.0 for value in (ceiling, state.ceiling, state.best_value))
    return 0.0, 1.06 * top if top > 0 else 1.0


def proof(state: ProofState, top: float) -> Columns:
    """Turn in degrees over the whole circle, the ceiling of each sector as a stair, the best value met in
    it, the floor under which no rival is looked for, the optimum, the rivals.

    What lies outside of 0 … top, −inf included, is drawn on that border.
    """
    turns = np.degrees(state.turns)
    order = np.argsort(turns)
    width = 360.0 / max(1, len(turns))
    low = turns[order] - width / 2
    # the sector at ±180° may lie on either side, or across
    low = np.concatenate([low[-1:] - 360.0, low, low[:1] + 360.0])
    which = np.concatenate([order[-1:], order, order[:1]])
    high = np.append(low[1:], low[-1] + width)
    seen = (high > -180.0) & (low < 180.0)
    low, high, which = low[seen], high[seen], which[seen]
    x = np.clip(np.stack([low, high], axis=1).ravel(), -180.0, 180.0)
    sector = np.repeat(which, 2)
    poses = [] if state.best is None else [state.best, *state.rivals]
    values = [] if state.best is None else [state.best_value, *state.rival_values]
    # a mark has a place of its own on the axis, between the edges of its sector
    at = np.degrees([pose[2] for pose in poses]).reshape(-1)
    inside = np.clip(np.searchsorted(high, at, side="right"), 0, len(which) - 1)
    x, sector = np.concatenate([x, at]), np.concatenate([sector, which[inside]])
    marks = np.full((2, len(x)), np.nan)
    for k, value in enumerate(values):
        marks[0 if k == 0 else 1, len(x) - len(at) + k] = value
    order = np.argsort(x, kind="stable")
    columns = [state.ceilings[sector], state.found[sector], np.full(len(x), state.floor), *marks]
    return (x[order], *(np.clip(_bounded(column, top)[order], 0.0, top) for column in columns))


def _bounded(values: FloatArray, top: float) -> FloatArray:
    return np.nan_to_num(values, nan=np.nan, posinf=top, neginf=0.0)


def proof_rows(result: ProofState, measure: ObjectiveLabel) -> list[tuple[str, ...]]:
    """The optimum and its rivals: turn, where map 2 goes, value, share of the best value."""
    if result.best is None:
        return []
    rows = []
    poses, values = [result.best, *result.rivals], [result.best_value, *result.rival_values]
    for rank, (pose, value) in enumerate(zip(poses, values, strict=True)):
        name = f"rival {rank}" if rank else "optimum" if result.proven else "best so far"
        share = f"{value / result.best_value:.0%}" if result.best_value > 0 else "–"
        rows.append((name, f"{degrees(pose[2]):.1f}°", measure.number(float(value)), share))
    return rows


def candidate_rows(
    candidates: tuple[Candidate, ...], refined: list[list[float]], measure: ObjectiveLabel
) -> list[tuple[str, ...]]:
    """Rank, turn, shift, value of the first look, value after refining."""
    rows = []
    for rank, candidate in enumerate(candidates):
        T = candidate.T_ref_mov
        looked = 0.0 if candidate.value is None else candidate.value
        after = measure.number(refined[rank][-1]) if rank < len(refined) and refined[rank] else "–"
        rows.append(
            (
                f"{rank + 1}{'  + π' if candidate.twin else ''}",
                f"{degrees(T.theta):.1f}°",
                f"{T.x:.1f}",
                f"{T.y:.1f}",
                measure.number(looked),
                after,
            )
        )
    return rows
