"""What the page says of a run while it works: one sentence, in one place."""

from __future__ import annotations

import re
from collections.abc import Callable
from math import degrees, isfinite
from typing import Any

import numpy as np

from algorithms.common.pose import Pose2, pose_error
from algorithms.maps.map_fusion import Fusion
from algorithms.methods import steps
from algorithms.methods.merge_result import MergeResult
from algorithms.methods.steps import AnswersDetail, ObservationDetail, ProvenDetail
from algorithms.optimisation.branch_and_bound import ProofState
from app.model.objective_label import ObjectiveLabel
from app.model.run_state import RunState
from app.model.step_table import row_of
from app.model.verdict_text import fits_nowhere

_MANY_BLOCKS = 20_000  # a proof has seldom more; nobody knows before its end how many there will be

READY = "Ready. Press Merge."
READY_FOR_ALL = "Ready. Nothing is known of how the maps lie: Merge tries every turn and shift."
# what to do next while the robots are placed by hand, by what is missing
PLACING = {
    "observer": "1 of 3: where robot 1 stood, in map 1. Press there, and drag the way it looked.",
    "seen": "2 of 3: where it saw robot 2, in map 1. Press there.",
    "observed": "3 of 3: where robot 2 was, in its own map, map 2. Press there; drag its heading, if known.",
    None: "Drag a sign to move it, and the knob of a robot to turn it. Range and bearing follow.",
}
SIDE_BY_SIDE = "Two robots, two maps, no common frame."
UP_TO_DATE = "Everything up to the candidates is up to date. Press Merge."


def typeset(text: str) -> str:
    """The text with a minus sign before its negative numbers, where a keyboard has a hyphen."""
    return re.sub(r"(?<![\w.)\]-])-(?=\.?\d)", "−", text)


def sentence(run: RunState) -> str:
    """What a run is doing right now."""
    detail = run.last.detail if run.last else None
    says = _SAYS.get(type(detail))
    return says(detail, run) if says else "Starting."


def _observing(detail: steps.ObservationDetail, _: RunState) -> str:
    times = len(detail.encounters)
    if times > 1:
        return f"Robot 1 saw robot 2 at {times} places: they are in both maps."
    return "Robot 1 saw robot 2: this place is in both maps."


def _searching(detail: steps.RefineDetail, run: RunState) -> str:
    state, measure = detail.state, run.measure
    where = f"candidate {detail.index + 1} of {detail.total}, iteration {state.iteration + 1}"
    value = f"{measure.name} {measure.text(state.best_value)}"
    return f"Searching: {where}, {value if isfinite(state.best_value) else 'outside the window'}."


def _shifting(detail: steps.ShiftDetail, _: RunState) -> str:
    turn = degrees(detail.candidate.T_ref_mov.theta)
    of = f"{detail.index + 1} of {detail.total}"
    return typeset(f"Shifting candidate {of}: map 2 turned by {turn:.1f}°.")


def _matching(detail: steps.MatchesDetail, _: RunState) -> str:
    agreeing, all_of_them = int(detail.inliers.sum()), len(detail.ref)
    if agreeing:
        return f"{agreeing} of {all_of_them} matched features agree on one transform."
    found = f"{len(detail.ref_features)} features in map 1, {len(detail.mov_features)} in map 2"
    return f"{found}: {all_of_them} look alike."


def _turning(detail: steps.TurnsDetail, _: RunState) -> str:
    tried = int(np.isfinite(detail.scores).sum())
    if detail.best is not None:
        return typeset(f"Best of {tried} turns: map 2 turned by {degrees(detail.best):.1f}°.")
    return f"Turning: {tried} of {len(detail.turns)} turns tried."


def _correlating(detail: steps.PlaneDetail, run: RunState) -> str:
    best = run.measure.text(float(detail.values[0])) if len(detail.values) else "none yet"
    return f"Turning: {detail.done} of {detail.total} turns, at every shift. Best so far {best}."


def _weighing(detail: steps.WeighedDetail, _: RunState) -> str:
    best, places = detail.answers[0], len(detail.answers)
    named = "The whole maps agree here, too" if places == 1 else f"Of {places} places one is the likeliest"
    if not best.moved:
        return f"{named}: {best.evidence.floor:.0f} m² of floor in common."
    off = apart_by(*pose_error(best.T_ref_mov, best.began, np.zeros(2)))
    return f"{named}, {off} from where the search had ended."


def _proving(detail: steps.ProofDetail, run: RunState) -> str:
    state, measure = detail.state, run.measure
    blocks = f"{state.nodes:,} blocks bounded"
    if state.empty:
        return f"Proving: {blocks}, none of them agrees with every sighting."
    if state.rival_sought:
        return f"Proven. Rivals: {blocks}, none above {measure.text(state.ceiling)}."
    return f"Proving: {blocks}, nothing above {measure.text(state.ceiling)} is left."


def proof_says(state: ProofState, measure: ObjectiveLabel) -> str:
    """What the picture of the proof means, in a line."""
    if state.empty:
        return "No transform agrees with every sighting: there is nothing to bound."
    if fits_nowhere(state):
        return "No turn gets above zero: wherever robot 2 may have stood, more wall contradicts than agrees."
    if not state.proven:
        return (
            f"Every turn stays below its grey ceiling, and all of them below {measure.text(state.ceiling)}. "
            "It comes down until only the best is left."
        )
    best = f"Nothing on the whole circle is better than {measure.text(state.best_value)}"
    if len(state.rivals):
        return f"{best}; the best rival has {state.rival_value / state.best_value:.0%} of it."
    if state.stopped is None:
        return f"{best}. Is there a rival elsewhere?"
    return f"{best}, and no other place has {state.floor / state.best_value:.0%} of it."


def found_it(run: RunState) -> str:
    """Whether the optimiser had come to the proven optimum; empty for a method without a proof."""
    proven, answers = run.get(ProvenDetail), run.get(AnswersDetail)
    if proven is None or answers is None:
        return ""
    state = proven.state
    if state.empty:
        return "No transform at all agrees with every sighting."
    if fits_nowhere(state):
        return f"Proven: nothing anywhere is above {run.measure.text(0.0)}."
    if not state.proven:
        left = run.measure.text(state.ceiling)
        return f"Not proven after {state.nodes:,} blocks: somewhere there may be up to {left}."
    if proven.search_found_it:
        return f"{run.searcher} found the proven optimum."
    seen = run.get(ObservationDetail)
    stuck = f"{run.searcher} got stuck"
    if seen is None:
        return f"{stuck} below the proven optimum."
    away = apart(answers.answers[0].T_ref_mov, proven.peak.T_ref_mov, seen)
    return f"{stuck}: the proven optimum lies {away} from its best."


def apart(a: Pose2, b: Pose2, seen: ObservationDetail | MergeResult) -> str:
    """How far two transforms lie apart, at the seen robot."""
    return apart_by(*pose_error(a, b, seen.pivot))


def apart_by(distance: float, turn: float) -> str:
    """A distance in metres and a turn in radians, as words."""
    return f"{distance:.1f} m and {degrees(turn):.0f}°"


_SAYS: dict[type, Callable[[Any, RunState], str]] = {
    steps.ObservationDetail: _observing,
    steps.AugmentDetail: lambda _, __: "Augmenting: walls near the meeting place are lifted.",
    steps.HoughDetail: lambda detail, _: (
        f"Turning: {len(detail.match.turns)} turns where the Hough spectra coincide."
    ),
    steps.WindowDetail: lambda _, __: "Shifting: the observation leaves this window.",
    steps.ShiftDetail: _shifting,
    steps.CandidatesDetail: lambda detail, run: (
        f"{len(detail.candidates)} candidates, ranked by {run.measure.name}."
    ),
    steps.RefineDetail: _searching,
    steps.MatchesDetail: _matching,
    steps.TurnsDetail: _turning,
    steps.PlaneDetail: _correlating,
    steps.AnswersDetail: lambda detail, _: f"The search is done: {detail.answers[0].stopped}.",
    steps.ProofDetail: _proving,
    steps.ProvenDetail: lambda _, run: found_it(run),
    steps.WeighedDetail: _weighing,
    Fusion: lambda _, __: "Merging the cells: what agrees, what contradicts.",
    steps.TriedDetail: lambda detail, _: (
        f"Refused. Looking for the cause, {detail.index + 1} of {detail.total}: {detail.clause}?"
    ),
    MergeResult: lambda detail, _: typeset(detail.verdict.reason),
}


def progress(run: RunState) -> float:
    """Share of the run that is done, 0 … 1."""
    detail = run.last.detail if run.last else None
    share = row_of(detail).share
    if isinstance(detail, steps.ShiftDetail):
        share += 0.2 * (detail.index + 1) / max(1, detail.total)
    if isinstance(detail, steps.RefineDetail):
        share += 0.4 * detail.index / max(1, detail.total)
    if isinstance(detail, steps.TurnsDetail):
        share += 0.7 * float(np.isfinite(detail.scores).mean())
    if isinstance(detail, steps.PlaneDetail):
        share += 0.7 * detail.done / detail.total
    if isinstance(detail, steps.ProofDetail):
        share += 0.15 * detail.state.nodes / (detail.state.nodes + _MANY_BLOCKS)
    return share
