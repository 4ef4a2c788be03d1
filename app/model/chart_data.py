"""The charts of a run as data: the curves, their axes and how each is drawn; no widgets."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import degrees
from typing import Literal

import numpy as np

from algorithms.common.pose import FloatArray
from algorithms.methods.steps import PlaneDetail, TurnsDetail
from algorithms.optimisation.branch_and_bound import ProofState
from algorithms.spectra.candidates import Candidate
from algorithms.spectra.hough_spectra import HoughMatch, ShiftMatch
from app.model.objective_label import ObjectiveLabel

Columns = tuple[FloatArray, ...]
Range = tuple[float, float]


@dataclass(frozen=True)
class Curve:
    """One curve of a chart.

    colour : a name of the palette
    kind   : a band is an area without a line
    size   : width of a line or diameter of a dot; pixels
    """

    name: str
    colour: str
    kind: Literal["line", "area", "band", "dash", "dots"] = "line"
    size: float = 1.5


@dataclass(frozen=True, eq=False)
class Chart:
    """Curves over one axis; without columns it says how a chart of its kind looks.

    axis       : label of the x axis
    across, up : both axes; None: as far as the curves go
    columns    : x, then a column per curve; NaN where there is nothing
    """

    title: str
    axis: str
    curves: tuple[Curve, ...]
    across: Range | None = None
    up: Range | None = None
    columns: Columns = ()


_MAPS = (Curve("map 1", "ref"), Curve("map 2", "mov"))
_SHIFT = (Curve("window", "margin", "band"), Curve("C", "margin"), Curve("shift", "best", "dots", 9))
HOUGH = Chart("Hough spectra, eq. (11)", "direction (°)", _MAPS, (0.0, 180.0), (0.0, 1.1))
TURNS = Chart(
    "Their correlation, eq. (12)",
    "turn Δθ (°), or that + 180°",
    (Curve("CC", "margin"), Curve("candidates", "particle", "dots", 8), Curve("at hand", "best", "dots", 10)),
    (0.0, 180.0),
    (0.0, 1.1),
)
CIRCLE = Chart(
    "Best agreement at every turn",
    "turn Δθ (°)",
    (Curve("agreement", "margin"), Curve("best", "best", "dots", 10)),
    (-180.0, 180.0),
)
X_SPECTRA = Chart("X spectra, eq. (13); map 2 turned and shifted", "x (m)", _MAPS, up=(0.0, 1.1))
Y_SPECTRA = Chart("Y spectra, eq. (14); map 2 turned and shifted", "y (m)", _MAPS, up=(0.0, 1.1))
SHIFT_X = Chart("Correlation, window shaded", "Δx (m)", _SHIFT, up=(0.0, 1.1))
SHIFT_Y = replace(SHIFT_X, axis="Δy (m)")
_LATER = [Curve(str(rank), colour, size=1.3) for rank, colour in enumerate(("particle", "ref", "margin"), 2)]
CLIMB = Chart("Best value so far", "iteration", (Curve("1", "best", size=2.2), *_LATER))
PROOF = Chart(
    "Best value at every turn",
    "turn Δθ (°), the whole circle",
    (
        Curve("ceiling", "margin", "area"),
        Curve("best met", "particle", "area", 1),
        Curve("floor", "rival", "dash", 1),
        Curve("optimum", "answer", "dots", 11),
        Curve("rivals", "rival", "dots", 9),
    ),
    (-180.0, 180.0),
    (0.0, 1.1),
)


def to_one(values: FloatArray) -> FloatArray:
    """The values with 1 as the highest."""
    top = float(values.max(initial=0.0))
    return np.asarray(values / top if top > 0 else values, dtype=np.float64)


def _marked(x: FloatArray, at: FloatArray, height: FloatArray) -> FloatArray:
    """Heights at the samples of x nearest to ``at``, NaN elsewhere."""
    marks = np.full(len(x), np.nan)
    if len(x) and len(at):
        marks[np.abs(x[:, None] - at[None, :]).argmin(axis=0)] = height
    return marks


def hough_spectra(match: HoughMatch) -> Chart:
    """Direction in degrees, spectrum of map 1, of map 2; highest value 1."""
    return replace(HOUGH, columns=(np.degrees(match.angles), to_one(match.ref), to_one(match.mov)))


def turn_correlation(match: HoughMatch, chosen: float | None) -> Chart:
    """Turn in degrees, correlation, candidates, and the chosen one (radians, any twin).

    Every direction has some lines: drawn from zero the peaks would be ripples.
    """
    x = np.degrees(match.angles)
    turns = np.mod(np.degrees(np.array(match.turns)), 180.0)
    marks = _marked(x, turns, np.array(match.strengths))
    best = np.full(len(x), np.nan)
    if chosen is not None and len(x):
        k = int(np.abs(np.mod(x - degrees(chosen) + 90, 180) - 90).argmin())
        best[k] = match.correlation[k]
    low = float(match.correlation.min())
    up = (low - 0.05 * (1 - low), 1 + 0.1 * (1 - low)) if low < 0.99 else (0.0, 1.1)
    return replace(TURNS, up=up, columns=(x, match.correlation, marks, best))


def circle(detail: TurnsDetail, measure: str = "agreement") -> Chart:
    """Turn in degrees, how well the maps agree (turns not tried yet as badly as the worst), the best turn."""
    x, scores = np.degrees(detail.turns), np.asarray(detail.scores, dtype=np.float64)
    tried = scores[np.isfinite(scores)]
    low, high = (float(tried.min()), float(tried.max())) if len(tried) else (0.0, 1.0)
    y = np.where(np.isfinite(scores), scores, low)
    best = np.full(len(x), np.nan)
    turn = detail.turns[y.argmax()] if detail.best is None else detail.best
    k = int(np.abs(np.mod(x - degrees(turn) + 180, 360) - 180).argmin())
    best[k] = y[k]
    room = 0.08 * max(high - low, 1e-3)
    title = f"Best {measure} at every turn"
    return replace(CIRCLE, title=title, up=(low - room, high + room), columns=(x, y, best))


def plane_turns(detail: PlaneDetail, measure: ObjectiveLabel) -> Chart:
    """Turn in degrees, the highest hill of each (0 where there is none, or it is not tried yet), the best."""
    y = np.where(np.isfinite(detail.tops), detail.tops, 0.0)
    best = np.full(len(y), np.nan)
    top = float(y.max(initial=0.0))
    if top > 0:
        best[y.argmax()] = top
    title, up = f"Best {measure.row} at every turn", (0.0, 1.08 * top if top > 0 else 1.0)
    return replace(CIRCLE, title=title, up=up, columns=(np.degrees(detail.turns), y, best))


def shift_spectra(match: ShiftMatch, form: Chart = X_SPECTRA) -> Chart:
    """Position in metres, spectrum of map 1, of map 2 turned and shifted by the best shift."""
    step = float(match.ref_at[1] - match.ref_at[0]) if len(match.ref_at) > 1 else 1.0
    moved = np.round((match.mov_at + match.shift) / step).astype(int)
    fixed = np.round(match.ref_at / step).astype(int)
    first, last = min(fixed[0], moved[0]), max(fixed[-1], moved[-1])
    columns = np.zeros((2, last - first + 1))
    columns[0, fixed - first] = to_one(match.ref)
    columns[1, moved - first] = to_one(match.mov)
    return replace(form, columns=(np.arange(first, last + 1) * step, columns[0], columns[1]))


def shift_correlation(match: ShiftMatch, form: Chart = SHIFT_X) -> Chart:
    """Shift in metres, to beyond the allowed window; the window as a bar of height 1.05, correlation, the
    chosen shift.
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
    return replace(form, columns=(x, window, y, _marked(x, np.array([match.shift]), np.array([top]))))


def climb(courses: Sequence[Sequence[float]], measure: ObjectiveLabel) -> Chart:
    """Iteration, then best value so far for each refined candidate; one that has ended stays where it was,
    one without a value lies on the axis (NaN would keep the chart from finding its scale).
    """
    longest = max([2, *map(len, courses)])
    table = np.zeros((len(CLIMB.curves), longest))
    for row, course in zip(table, courses, strict=False):
        if course:
            row[: len(course)], row[len(course) :] = course, course[-1]
    table[~np.isfinite(table)] = 0.0
    x = np.arange(1, longest + 1, dtype=float)
    return replace(CLIMB, title=f"Best {measure.row} so far", columns=(x, *table))


def proof(state: ProofState, ceiling: float, measure: ObjectiveLabel) -> Chart:
    """Turn in degrees over the whole circle, the ceiling of each sector as a stair, the best value met in
    it, the floor under which no rival is looked for, the optimum, the rivals.

    What lies outside of the y axis, −inf included, is drawn on its border.

    ceiling : the bound that it began with, so that the axis stands still while the bounds come down
    """
    highest = max(
        value if np.isfinite(value) else 0.0 for value in (ceiling, state.ceiling, state.best_value)
    )
    top = 1.06 * highest if highest > 0 else 1.0
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
    clipped = (np.clip(column[order], 0.0, top) for column in columns)
    title = f"Best {measure.row} at every turn"
    return replace(PROOF, title=title, up=(0.0, top), columns=(x[order], *clipped))


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
        T, name = candidate.T_ref_mov, f"{rank + 1}{'  + π' if candidate.twin else ''}"
        looked = measure.number(0.0 if candidate.value is None else candidate.value)
        after = measure.number(refined[rank][-1]) if rank < len(refined) and refined[rank] else "–"
        rows.append((name, f"{degrees(T.theta):.1f}°", f"{T.x:.1f}", f"{T.y:.1f}", looked, after))
    return rows
