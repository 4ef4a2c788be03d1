"""Whether what a step of the lesson asks for was done, told from what the page knows: no answer is typed."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import degrees, exp, pi

import numpy as np

from algorithms.common.pose import wrap_angle
from algorithms.maps.map_fusion import ConflictRule
from algorithms.methods.merge_result import MergeResult
from algorithms.methods.steps import AugmentDetail, CandidatesDetail, HoughDetail, ProofDetail, WindowDetail
from app.page.lesson.figures import chain_figure, fit_figure, knowledge_figure, verdict_figure, window_figure
from app.page.lesson.figures.figure_slider import shown
from app.page.lesson.figures.map_figures import SPREAD
from app.page.lesson.figures.proof_figure import looks
from app.page.lesson.figures.search_figures import best_of, transforms
from app.page.lesson.figures.sighting_figure import HOW_FAR
from app.page.lesson.figures.spectra_figures import CELL_X, CELL_Y
from app.page.lesson.lesson_run import FEW, LessonRun


@dataclass(frozen=True)
class Seen:
    """What is on the page while a step is open.

    lesson : its run, with the maps and the settings, as far as it has come
    way    : in which a thing to try has the picture drawn; empty for the picture itself
    at     : where its dials stand
    """

    lesson: LessonRun
    way: str = ""
    at: tuple[int, ...] = ()


Check = Callable[[Seen], bool]


def _laser(seen: Seen) -> bool:
    return seen.at[:1] == (HOW_FAR,)


def _laid_as_merged(seen: Seen) -> bool:
    """Map 2 is turned by hand to within 5° of the merge."""
    if seen.way != "laid":
        return False
    off = np.radians(shown(fit_figure.TURN, seen.at[0])) - seen.lesson.get(MergeResult).T_ref_mov.theta
    return abs(degrees(wrap_angle(float(off)))) <= 5.0


def _half_at_3_m(seen: Seen) -> bool:
    """A wall 3 m from the meeting place counts half, to 5 %."""
    spread = shown(SPREAD, seen.at[0]) if seen.way == "ring" else seen.lesson.config.augment.spread
    return abs(exp(-(3.0**2) / (2 * spread**2)) - 0.5) <= 0.05


def _short_list(seen: Seen) -> bool:
    """The walls of map 2 are less than 2 % of its cells."""
    grid = seen.lesson.inputs.mov
    return grid is not None and float(grid.occupied.mean()) < 0.02


def _flat_wave(seen: Seen) -> bool:
    """The cell in the hand is, to 0.3 m, the wall cell that is nearest to the meeting place."""
    if seen.way != "wave":
        return False
    lifted = seen.lesson.get(AugmentDetail).ref
    away = lifted.points - lifted.x_hat
    handle = np.array([shown(CELL_X, seen.at[0]), shown(CELL_Y, seen.at[1])])
    cell = away[int(np.hypot(*(away - handle).T).argmin())]
    return float(np.hypot(*cell)) <= float(np.hypot(*away.T).min()) + 0.3


def _step_of_1_degree(seen: Seen) -> bool:
    return bool(seen.lesson.config.spectra.directions == 180)


def _least_alike(seen: Seen) -> bool:
    """The spectra are slid to within a tenth of where they coincide least."""
    values = seen.lesson.get(HoughDetail).match.correlation
    here = values[round(seen.at[0] / 180 * len(values)) % len(values)]
    return bool(here <= values.min() + 0.1 * (values.max() - values.min()))


def _twin_of_first(seen: Seen) -> bool:
    turns = seen.lesson.get(HoughDetail).match.turns
    off = turns[min(seen.at[0], len(turns) - 1)] - turns[0]
    return abs(abs(wrap_angle(off)) - pi) < 1e-6


def _wide_shifts(seen: Seen) -> bool:
    """The window of the shift is at least 4 m wide, in x and in y."""
    window = seen.lesson.get(WindowDetail).window
    return bool((window.high - window.low).min() >= 4.0)


def _across_the_ring(seen: Seen) -> bool:
    """Map 2's origin is, to 10°, as far from the best candidate's as the ring allows."""
    return seen.way == "origins" and abs(seen.at[0] / window_figure.TURNS - 0.5) <= 10 / 360


def _gamma_is_fooled(seen: Seen) -> bool:
    """Γ is at least a quarter of that of the best place, and the agreement below zero."""
    if seen.way != "fit":
        return False
    lesson, met = seen.lesson, seen.lesson.inputs.encounters[0]
    place = met.x_ref + [shown(dial, k) for dial, k in zip(_SHIFTS, seen.at, strict=False)]
    here = transforms(*place[:, None], np.radians(shown(fit_figure.TURN, seen.at[2])), met.x_mov)
    best = best_of(lesson).array()[None]
    share = float(lesson.gamma(here)[0]) / max(float(lesson.gamma(best)[0]), 1e-12)
    return share >= 0.25 and float(lesson.agreement(here)[0]) < 0


def _no_better_dart(seen: Seen) -> bool:
    """No later throw has a better dart."""
    states = seen.lesson.samples
    return states[min(seen.at[0], len(states) - 1)].best_value >= states[-1].best_value


def _leader(seen: Seen) -> bool:
    """The particle that is followed stands on the best place that the swarm has met."""
    states = seen.lesson.few
    before = states[max(0, min(seen.at[0] + 1, len(states) - 1) - 1)]
    return bool(np.allclose(before.poses[min(seen.at[1], FEW - 1)], before.best))


def _circle_open(seen: Seen) -> bool:
    """At the chosen look a tenth of the circle or more may still hold something better."""
    chosen = looks(seen.lesson)
    state = seen.lesson.all(ProofDetail)[chosen[min(seen.at[0], len(chosen) - 1)]].state
    return float((state.ceilings > state.best_value).mean()) >= 0.1


def _twin_wins(seen: Seen) -> bool:
    """What is named is turned by half against the truth, to 20°; nobody can tell where that is not known."""
    truth = seen.lesson.inputs.truth
    if truth is None or truth.T_ref_mov is None:
        return False
    off = seen.lesson.get(MergeResult).T_ref_mov.theta - truth.T_ref_mov.theta
    return abs(degrees(wrap_angle(off))) >= 160.0


def _map_2_wins(seen: Seen) -> bool:
    return bool(seen.lesson.config.conflict is ConflictRule.MOV_WINS)


def _too_little_wall(seen: Seen) -> bool:
    """An accepted merge is none any more, and only agreeing wall was taken away."""
    if seen.way != "without" or not seen.lesson.get(MergeResult).verdict.accepted:
        return False
    return seen.at[1] == 0 and not verdict_figure.verdict_without(seen.lesson, seen.at).accepted


def _nothing_known(seen: Seen) -> bool:
    """The merge with nothing known is on the map, and all of them are over."""
    return seen.at[:1] == (0,) and knowledge_figure.runs_of(seen.lesson).next is None


def _other_answer(seen: Seen) -> bool:
    """A second sighting makes the answer that was less likely the right one, to 90 %."""
    shares = chain_figure.second_at(seen.lesson, seen.at) if seen.way == "second" else None
    return shares is not None and shares[1] >= 0.9


_SHIFTS = fit_figure.ALONG_X, fit_figure.ALONG_Y
Needs = tuple[type, ...]

CHECKS: dict[str, tuple[Needs, Check]] = {
    "laser": ((), _laser),
    "laid-as-merged": ((MergeResult,), _laid_as_merged),
    "half-at-3-m": ((), _half_at_3_m),
    "short-list": ((), _short_list),
    "flat-wave": ((AugmentDetail,), _flat_wave),
    "step-of-1-degree": ((HoughDetail,), _step_of_1_degree),
    "least-alike": ((HoughDetail,), _least_alike),
    "twin-of-first": ((HoughDetail,), _twin_of_first),
    "wide-shifts": ((WindowDetail,), _wide_shifts),
    "across-the-ring": ((WindowDetail,), _across_the_ring),
    "gamma-is-fooled": ((CandidatesDetail,), _gamma_is_fooled),
    "no-better-dart": ((CandidatesDetail,), _no_better_dart),
    "leader": ((CandidatesDetail,), _leader),
    "circle-open": ((ProofDetail,), _circle_open),
    "twin-wins": ((MergeResult,), _twin_wins),
    "map-2-wins": ((MergeResult,), _map_2_wins),
    "too-little-wall": ((MergeResult,), _too_little_wall),
    "nothing-known": ((MergeResult,), _nothing_known),
    "other-answer": ((MergeResult,), _other_answer),
}
"""By their names in the front matter of a step: what the run must have come to, and the check."""


def done(name: str, seen: Seen) -> bool:
    """Whether what a step asks for is on the page now; not before the run has come to it."""
    return ready(name, seen.lesson) and CHECKS[name][1](seen)


def ready(name: str, lesson: LessonRun) -> bool:
    """Whether a run has come to what a check looks at."""
    return lesson.possible and lesson.reached(*CHECKS[name][0])
