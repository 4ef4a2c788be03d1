"""The curves of the stage at hand, as data: what the dock of the page shows, the spectra left out."""

from __future__ import annotations

from typing import Any

import numpy as np

from algorithms.common.pose import FloatArray
from algorithms.methods.merge_result import MergeResult
from algorithms.methods.steps import (
    AnswersDetail,
    AugmentDetail,
    CandidatesDetail,
    HoughDetail,
    ObservationDetail,
    ProofDetail,
    ProvenDetail,
    RefineDetail,
    WindowDetail,
)
from app.drawing.palette import LIGHT, css
from app.model import chart_data as charts
from app.model import status_text as words
from app.model.run_state import RunState

LEAST = 20.0  # iterations that the axis of the climb holds from the beginning
LINES = 4  # courses of the search that are drawn
FINEST = 360  # points of a curve, at most; of a finer one the highest of each group is kept

REF, MOV, MARK, BEST = css(LIGHT.ref), css(LIGHT.mov), css(LIGHT.particle), css(LIGHT.best)
GREY, OPTIMUM, RIVAL, RIM = css(LIGHT.margin), css(LIGHT.answer), css(LIGHT.rival), css(LIGHT.rim)

Chart = dict[str, Any]


def curves(story: RunState) -> list[Chart]:
    """The charts for what the run has come to, and a line of words below them; [] where there is none."""
    detail = story.last.detail if story.last else None
    if isinstance(detail, (ObservationDetail, AugmentDetail)):
        return []
    if isinstance(detail, HoughDetail):
        return _turning(story)
    if isinstance(detail, (RefineDetail, AnswersDetail)):
        return [_climb(story)]
    if isinstance(detail, (ProofDetail, ProvenDetail)):
        return [_proof(story)]
    if isinstance(detail, MergeResult):
        return []  # its numbers are shown
    if story.reached(ProofDetail):
        return [_proof(story)]
    if story.courses:
        return [_climb(story)]
    return _shifting(story) or _turning(story)


def _turning(story: RunState) -> list[Chart]:
    hough = story.get(HoughDetail)
    if hough is None:
        return []
    x, ref, mov = charts.hough_spectra(hough.match)
    return [
        _chart(
            charts.HOUGH, (0.0, 180.0), (0.0, 1.1), _line("map 1", REF, x, ref), _line("map 2", MOV, x, mov)
        ),
        _turns(hough, None),
    ]


def _shifting(story: RunState) -> list[Chart]:
    """The turn at hand among all turns, and how far map 2 is off along x and y."""
    hough, found = story.get(HoughDetail), story.get(CandidatesDetail)
    shift = story.shifts[-1].candidate if story.shifts else None
    at_hand = found.candidates[0] if found else shift
    if at_hand is None or hough is None or not story.reached(WindowDetail):
        return []
    theta = at_hand.T_ref_mov.theta
    drawn = [_turns(hough, theta)]
    for match, names in ((at_hand.x, charts.SHIFT_X), (at_hand.y, charts.SHIFT_Y)):
        at, window, values, best = charts.shift_correlation(match)
        drawn.append(
            _chart(
                names,
                (float(at.min()), float(at.max())),
                (0.0, 1.1),
                _line("window", "rgba(107,114,128,0.25)", at, window, kind="area"),
                _line("C", GREY, at, values),
                _dots("shift", BEST, at, best, 5),
            )
        )
    return drawn


def _turns(hough: HoughDetail, theta: float | None) -> Chart:
    """How well the directions of the walls agree at every turn.

    theta : the turn at hand, radians; None: none is
    """
    turns, correlation, candidates, chosen = charts.turn_correlation(hough.match, theta)
    lines = [_line("CC", GREY, turns, correlation), _dots("candidates", MARK, turns, candidates, 4)]
    if theta is not None:
        lines.append(_dots("at hand", BEST, turns, chosen, 5.5))
    return _chart(charts.TURNS, (0.0, 180.0), charts.turn_range(hough.match), *lines)


def _climb(story: RunState) -> Chart:
    x, *courses = charts.courses(story.courses, LINES)
    colours = (BEST, MARK, REF, GREY)
    lines = [
        _line(f"candidate {k + 1}", colours[k], x[: len(told)], course[: len(told)])
        for k, (told, course) in enumerate(zip(story.courses, courses, strict=False))
    ]
    top = max((float(course.max()) for course in courses), default=0.0)
    measure = story.measure
    title = charts.CLIMB[0].format(measure.row), charts.CLIMB[1]
    longest = max(LEAST, float(x[-1]))
    return _chart(title, (0.0, longest), (0.0, 1.1 * top if top > 0 else 1.0), *lines)


def _proof(story: RunState) -> Chart:
    proof = story.get(ProofDetail)
    assert proof is not None
    state, measure = proof.state, story.measure
    low, high = charts.proof_range(state, story.ceiling)
    x, ceiling, found, floor, optimum, rivals = charts.proof(state, high)
    title = charts.PROOF[0].format(measure.row), charts.PROOF[1]
    chart = _chart(
        title,
        (-180.0, 180.0),
        (low, high),
        _line("ceiling", GREY, x, ceiling, kind="area"),
        _line("best met", MARK, x, found, kind="area"),
        _line("floor", RIVAL, x[[0, -1]], floor[[0, -1]], kind="dash"),
        _dots("optimum", OPTIMUM, x, optimum, 6, RIM),
        _dots("rivals", RIVAL, x, rivals, 4.5),
    )
    return chart | {"says": words.proof_says(state, measure)}


def _chart(names: tuple[str, str], x: tuple[float, float], y: tuple[float, float], *series: Any) -> Chart:
    title, label = names
    shown = [one for one in series if one["x"]]
    return {"title": title, "label": label, "x": _short(x), "y": _short(y), "series": shown}


def _line(name: str, colour: str, x: FloatArray, y: FloatArray, kind: str = "line") -> dict[str, Any]:
    x, y = thinned(np.asarray(x), np.asarray(y))
    return {"t": name, "c": colour, "k": kind, "x": _short(x), "y": _short(y)}


def _dots(
    name: str, colour: str, x: FloatArray, y: FloatArray, radius: float, rim: str | None = None
) -> dict[str, Any]:
    there = np.isfinite(y)
    dots = {"t": name, "c": colour, "k": "dots", "r": radius, "x": _short(x[there]), "y": _short(y[there])}
    return dots | ({"rim": rim} if rim else {})


def thinned(x: FloatArray, y: FloatArray, most: int = FINEST) -> tuple[FloatArray, FloatArray]:
    """A curve of fewer points: of each group its highest, so that no peak is lost; the ends stay."""
    group = -(-len(x) // most)
    if group <= 1:
        return x, y
    starts = np.arange(0, len(x), group)
    keep = [start + int(np.argmax(y[start : start + group])) for start in starts]
    kept = np.unique([0, *keep, len(x) - 1])
    return x[kept], y[kept]


def _short(values: Any) -> list[float]:
    """Numbers in few letters: four digits are finer than the eye."""
    return [float(f"{value:.4g}") for value in np.asarray(values, dtype=float).tolist()]
