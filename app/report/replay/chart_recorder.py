"""The charts of the stage at hand, as data for the player: those of the page, the spectra left out."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from algorithms.common.pose import FloatArray
from algorithms.common.robot_names import UNNAMED, RobotNames
from algorithms.methods.merge_result import MergeResult
from algorithms.methods.steps import (
    AnswersDetail,
    AugmentDetail,
    HoughDetail,
    ObservationDetail,
    PlaneDetail,
    ProofDetail,
    ProvenDetail,
    RefineDetail,
    WindowDetail,
)
from algorithms.optimisation.correlation_picture import CorrelationPicture
from app.drawing.palette import LIGHT, VIRIDIS, css
from app.drawing.png import data_uri
from app.drawing.svg.correlation_plot import scale_ends, surface_pixels, surface_title
from app.model import chart_data as charts
from app.model import status_text as words
from app.model.chart_data import Chart, Curve
from app.model.run_state import RunState

LEAST = 20.0  # iterations that the axis of the climb holds from the beginning
STOPS = 8  # colours by which a scale is drawn
FINEST = 360  # points of a curve, at most; of a finer one the highest of each group is kept

Recorded = dict[str, Any]


def curves(run: RunState, names: RobotNames = UNNAMED) -> list[Recorded]:
    """The charts for what the run has come to, and a line of words below them; [] where there is none."""
    return [_told(chart, names) for chart in _curves(run)]


def _told(chart: Recorded, names: RobotNames) -> Recorded:
    series = [one | {"t": names.told(one["t"])} for one in chart["series"]]
    says = {"says": names.told(chart["says"])} if "says" in chart else {}
    return chart | says | {"title": names.told(chart["title"]), "series": series}


def _curves(run: RunState) -> list[Recorded]:
    detail = run.last.detail if run.last else None
    if isinstance(detail, (ObservationDetail, AugmentDetail, MergeResult)):
        return []  # numbers are shown
    if isinstance(detail, HoughDetail):
        return _turning(run)
    if run.reached(PlaneDetail):
        return _plane(run)
    searching = isinstance(detail, (RefineDetail, AnswersDetail))
    if isinstance(detail, ProvenDetail) or (run.reached(ProofDetail) and not searching):
        return [_proof(run)]
    if run.courses or searching:
        return [_climb(run)]
    return _shifting(run) or _turning(run)


def _turning(run: RunState) -> list[Recorded]:
    hough = run.get(HoughDetail)
    if hough is None:
        return []
    return [recorded(charts.hough_spectra(hough.match)), recorded(charts.turn_correlation(hough.match, None))]


def _shifting(run: RunState) -> list[Recorded]:
    """The turn at hand among all turns, and how far map 2 is off along x and y."""
    hough, chosen = run.get(HoughDetail), run.at_hand
    if chosen is None or hough is None or not run.reached(WindowDetail):
        return []
    return [
        recorded(charts.turn_correlation(hough.match, chosen.T_ref_mov.theta)),
        recorded(charts.shift_correlation(chosen.x, charts.SHIFT_X)),
        recorded(charts.shift_correlation(chosen.y, charts.SHIFT_Y)),
    ]


def _plane(run: RunState) -> list[Recorded]:
    """The best of every turn, and the surface of the turn at hand; after the search that of the best."""
    plane = run.get(PlaneDetail)
    assert plane is not None
    told = [recorded(charts.plane_turns(plane, run.measure))]
    searching = run.last is not None and run.last.detail is plane
    shown = plane if searching or run.plane is None else run.plane
    if shown.picture is not None:
        told.append(_surface(shown.picture, float(plane.values[0]) if len(plane.values) else 1.0))
    return told


def _surface(picture: CorrelationPicture, top: float) -> Recorded:
    """A picture in place of curves, and the colours of its scale from dark to bright."""
    across, up = zip(picture.low, picture.high, strict=True)
    stops = VIRIDIS[np.linspace(0, 255, STOPS).astype(int)].tolist()
    marks = {"t": "best", "c": css(LIGHT.best), "k": "dots", "r": 4, "rim": "#ffffff"}
    hill = picture.hills[:1]
    return {
        "title": surface_title(picture),
        "label": "Δx (m)",
        "up": "Δy (m)",
        "x": _short(across),
        "y": _short(up),
        "image": data_uri(surface_pixels(picture, top)),
        "scale": {"stops": [css(tuple(stop)) for stop in stops], "ends": scale_ends(top)},
        "series": [marks | {"x": _short(hill[:, 0]), "y": _short(hill[:, 1])}] if len(hill) else [],
    }


def _climb(run: RunState) -> Recorded:
    chart = charts.climb(run.courses, run.measure)
    x, *values = chart.columns
    top = max(float(course.max()) for course in values)
    lengths = [*map(len, run.courses), *[0] * len(values)]
    values = [np.where(x <= length, course, np.nan) for course, length in zip(values, lengths, strict=False)]
    across, up = (0.0, max(LEAST, float(x[-1]))), (0.0, 1.1 * top if top > 0 else 1.0)
    named = tuple(replace(curve, name=f"candidate {curve.name}") for curve in chart.curves)
    return recorded(replace(chart, curves=named, across=across, up=up, columns=(x, *values)))


def _proof(run: RunState) -> Recorded:
    proof = run.get(ProofDetail)
    assert proof is not None
    chart = charts.proof(proof.state, run.ceiling, run.measure)
    return recorded(chart) | {"says": words.proof_says(proof.state, run.measure)}


def recorded(chart: Chart) -> Recorded:
    """A chart as charts.js draws it; a curve without a point is left out."""
    x, *columns = chart.columns
    series = [_series(curve, x, y) for curve, y in zip(chart.curves, columns, strict=True)]
    return {
        "title": chart.title,
        "label": chart.axis,
        "x": _short(chart.across or (x.min(), x.max())),
        "y": _short(chart.up),
        "series": [one for one in series if one["x"]],
    }


def _series(curve: Curve, x: FloatArray, y: FloatArray) -> Recorded:
    there = np.isfinite(y)
    x, y = x[there], y[there]
    rgb, more, kind = getattr(LIGHT, curve.colour), {}, curve.kind
    if kind == "dots":
        more = {"r": curve.size / 2} | ({"rim": css(LIGHT.rim)} if curve.colour == "answer" else {})
    elif kind == "dash":
        x, y = x[[0, -1]], y[[0, -1]]
    else:
        x, y = thinned(x, y)
    colour = css(rgb, 0.25 if kind == "band" else 1.0)
    kind = "area" if kind == "band" else kind
    return {"t": curve.name, "c": colour, "k": kind, **more, "x": _short(x), "y": _short(y)}


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
