"""The numbers of this pair that a text may hold: {walls1} in a file becomes 2,718 on the page."""

from __future__ import annotations

from collections.abc import Callable
from math import hypot, pi

import numpy as np

from algorithms.maps.grid_map import GridMap
from algorithms.maps.map_fusion import Fusion
from algorithms.methods.merge_result import MergeResult
from algorithms.methods.steps import (
    AnswersDetail,
    AugmentDetail,
    CandidatesDetail,
    HoughDetail,
    ObservationDetail,
    ProvenDetail,
    WindowDetail,
)
from algorithms.observations.observation import Encounter, Observation
from algorithms.observations.search_window import CoupledWindow
from algorithms.optimisation.branch_and_bound import ProofState
from algorithms.verdict.decision import Verdict
from app.drawing.legend import peak_level
from app.drawing.scene.search_symbols import window_size
from app.drawing.svg.svg_canvas import turn_label
from app.drawing.svg.verdict_bars import values
from app.model.objective_label import measure_of
from app.model.status_text import typeset
from app.page.lesson.figures.verdict_figure import evidence_says
from app.page.lesson.lesson_run import LessonRun
from app.page.lesson.sighting_look import SightingLook
from app.page.lesson.sighting_numbers import SIGHTING_NUMBERS

EQ_23 = "eq. (23), "  # begins the page's row of it
Number = tuple[tuple[type, ...], Callable[[LessonRun], str]]  # what the run must have come to, and the words


def _n(value: float, digits: int = 2) -> str:
    return f"{value:,.{digits}f}".replace("-", "−")


def _seen(lesson: LessonRun) -> Observation:
    return lesson.inputs.observations[0]


def _met(lesson: LessonRun) -> Encounter:
    return lesson.get(ObservationDetail).encounter


def _walls(grid: GridMap) -> int:
    return int(grid.occupied.sum())


def _next_peak(lesson: LessonRun) -> str:
    """How near the runner-up comes to the strongest turn, its own twin left out."""
    match = lesson.get(HoughDetail).match
    others = [s for s, twin in zip(match.strengths, match.twins, strict=True) if not twin][1:]
    return f"the next peak reaches {max(others):.0%} of it" if others else "no other peak is followed up"


def _turns(lesson: LessonRun) -> str:
    count = len(lesson.get(HoughDetail).match.turns)
    return "1 turn is" if count == 1 else f"{count} turns are"


def _paper_sigma(lesson: LessonRun) -> str:
    """By how much the paper's window is wider than ‖x̂₂‖ on each side."""
    window, pivot = lesson.get(WindowDetail).paper, _met(lesson).x_mov
    x, y = ((window.high - window.low) / 2 - hypot(*pivot.tolist())).tolist()
    return f"{_n(x)} m in x and {_n(y)} m in y"


def _disc(window: CoupledWindow) -> float:
    """Area of the first sighting's disc; m²."""
    return float(pi * window.k**2 * np.sqrt(np.linalg.det(window.covariances[0])))


def _ratio(lesson: LessonRun) -> str:
    windows = lesson.get(WindowDetail)
    return f"{float(np.prod(windows.paper.high - windows.paper.low)) / _disc(windows.coupled):,.0f}"


def _transforms(lesson: LessonRun) -> str:
    """How many transforms of the lattice the coupled window holds: a cell, and the turn that moves a
    wall at 2 σ_aug by a cell."""
    cell, spread = lesson.get(CandidatesDetail).objective.cell, lesson.config.augment.spread
    turns = 2 * pi / (cell / (2 * spread))
    return f"{turns * _disc(lesson.get(WindowDetail).coupled) / cell**2:,.0f}"


def _proof(lesson: LessonRun) -> ProofState:
    return lesson.get(ProvenDetail).state


def _value(lesson: LessonRun, value: float) -> str:
    return measure_of(lesson.config).text(value)


def _rival(lesson: LessonRun) -> str:
    state = _proof(lesson)
    if not len(state.rivals) or state.best_value <= 0:
        return "no rival above half of it"
    return f"a rival with {state.rival_value / state.best_value:.0%} of it"


def _verdict(lesson: LessonRun) -> Verdict:
    return lesson.get(MergeResult).verdict


def _of_look(words: Callable[[SightingLook], str]) -> Callable[[LessonRun], str]:
    """The same of a run; an ellipsis where no box was found in the picture."""

    def told(lesson: LessonRun) -> str:
        look = lesson.look
        return "…" if look is None or look.calibrated.one is None else words(look)

    return told


def _row(label: str) -> Callable[[LessonRun], str]:
    """What stands behind a label among the page's own numbers; a dash where there is none."""
    return lambda lesson: lesson.rows.get(label, "–")


def _index(lesson: LessonRun, part: int) -> str:
    """Of eq. (23) on the page: over which overlap (0), and its value (1)."""
    return next(row for row in lesson.rows.items() if row[0].startswith(EQ_23))[part].removeprefix(EQ_23)


_RESULT, _HOUGH, _WINDOW = (MergeResult,), (HoughDetail,), (WindowDetail,)
_FOUND, _MET, _FUSED = (CandidatesDetail, WindowDetail), (ObservationDetail,), (Fusion,)
_PROVEN = (ProvenDetail,)

NUMBERS: dict[str, Number] = {
    "range": ((), _row("range r")),
    "bearing": ((), _row("bearing β")),
    "heading": ((), lambda s: turn_label(_seen(s).observer.theta)),
    "sideways_m": ((), lambda s: _n(_seen(s).range * _seen(s).sigma_bearing)),
    "sightings": ((), lambda s: str(len(s.inputs.observations))),
    "x1": (_MET, _row("x̂₁, seen here")),
    "x2": (_MET, _row("robot 2 in map 2")),
    "x2_norm_m": (_MET, lambda s: _n(hypot(*_met(s).x_mov.tolist()))),
    "walls1": ((), lambda s: f"{_walls(s.inputs.ref):,}"),
    "walls2": ((), lambda s: f"{_walls(s.inputs.mov):,}"),
    "cells1": ((), lambda s: f"{s.inputs.ref.cells.size:,}"),
    "cells2": ((), lambda s: f"{s.inputs.mov.cells.size:,}"),
    "walls_share": ((), lambda s: f"{_walls(s.inputs.mov) / s.inputs.mov.cells.size:.1%}"),
    "intensity": ((), lambda s: f"{s.config.augment.intensity:g}"),
    "spread_m": ((), lambda s: f"{s.config.augment.spread:g}"),
    "peak": ((AugmentDetail,), lambda s: peak_level(s.get(AugmentDetail))),
    "lifted1": ((AugmentDetail,), lambda s: f"{len(s.get(AugmentDetail).ref.levels):,}"),
    "lifted2": ((AugmentDetail,), lambda s: f"{len(s.get(AugmentDetail).mov.levels):,}"),
    "directions": ((), lambda s: str(s.config.spectra.directions)),
    "direction_step": ((), lambda s: f"{180 / s.config.spectra.directions:g}°"),
    "turns": (_HOUGH, _turns),
    "turn": (_HOUGH, lambda s: turn_label(s.get(HoughDetail).match.turns[0])),
    "next_peak": (_HOUGH, _next_peak),
    "paper_window": (_WINDOW, lambda s: window_size(s.get(WindowDetail).paper)),
    "paper_sigma": (_WINDOW, _paper_sigma),
    "coupled_window": (_WINDOW, lambda s: window_size(s.get(WindowDetail).coupled)),
    "window_ratio": (_WINDOW, _ratio),
    "margin_m": ((), lambda s: f"{s.config.window.margin:g}"),
    "deviations": ((), lambda s: f"{s.config.window.deviations:g}"),
    "candidates": (_FOUND, lambda s: str(len(s.get(CandidatesDetail).candidates))),
    "particles": ((), lambda s: f"{s.config.swarm.particles:,}"),
    "iterations": ((), lambda s: str(s.config.swarm.iterations)),
    "omega": ((), lambda s: f"{s.config.swarm.omega:g}"),
    "tau": ((), lambda s: f"{s.config.swarm.tau:g}"),
    "sigma_x_m": ((), lambda s: f"{s.config.box.sigma_x:g}"),
    "sigma_theta": ((), lambda s: f"{s.config.box.sigma_theta:g}°"),
    "transforms": (_FOUND, _transforms),
    "search_value": ((AnswersDetail,), lambda s: _value(s, s.get(AnswersDetail).answers[0].value)),
    "search_ended": ((AnswersDetail,), lambda s: s.get(AnswersDetail).answers[0].stopped),
    "blocks": (_PROVEN, lambda s: f"{_proof(s).nodes:,}"),
    "proven_value": (_PROVEN, lambda s: _value(s, _proof(s).best_value)),
    "rival": (_PROVEN, _rival),
    "shift_x": (_RESULT, _row("T: Δx")),
    "shift_y": (_RESULT, _row("T: Δy")),
    "merged_turn": (_RESULT, _row("T: Δθ")),
    "value": (_RESULT, lambda s: f"{_row(measure_of(s.config).row)(s)} {measure_of(s.config).unit}".strip()),
    "overlap_cells": (_FUSED, lambda s: f"{s.get(Fusion).overlap:,}"),
    "conflicting_cells": (_FUSED, lambda s: f"{s.get(Fusion).conflicting:,}"),
    "acceptance": (_RESULT, _row("acceptance index")),
    "performance": (_RESULT, lambda s: _index(s, 1)),
    "performance_over": (_RESULT, lambda s: _index(s, 0)),
    "contradiction": (_RESULT, _row("contradicted, patches slipped")),
    "rigid_contradiction": (_RESULT, _row("contradicted, as the maps are")),
    "shared_wall": (_RESULT, _row("wall in view of both")),
    "across": (_RESULT, _row("agreeing wall across the others")),
    "unbent": (_RESULT, lambda s: values(_verdict(s)).get("unbent", "–")),
    "off_sighting": (_RESULT, _row("robot 2 off its sighting")),
    "named_says": (_RESULT, lambda s: evidence_says(s.get(MergeResult).weighed[0].evidence)),
    "answers_weighed": (_RESULT, lambda s: str(len(s.get(MergeResult).weighed))),
    "probability": (_RESULT, _row("likely right")),
    "accept_from": ((), lambda s: f"{s.config.verdict.accept_from:.3g}"),
    "bent_from": ((), lambda s: f"{s.config.verdict.bent_from:.0%}"),
    "verdict": (_RESULT, lambda s: typeset(_verdict(s).reason)),
}
NUMBERS |= {name: ((SightingLook,), _of_look(words)) for name, words in SIGHTING_NUMBERS.items()}


def numbers_of(lesson: LessonRun) -> dict[str, str]:
    """The words for every number that the run has come to."""
    return {name: words(lesson) for name, (needs, words) in NUMBERS.items() if lesson.reached(*needs)}
