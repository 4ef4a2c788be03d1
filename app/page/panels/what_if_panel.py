"""Folder "What if": the verdict on numbers that a person chooses, beginning with those of the last merge."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from math import exp, log, pi
from threading import RLock, get_ident
from typing import Any, NamedTuple

import viser

from algorithms.common.pose import Pose2
from algorithms.common.robot_names import UNNAMED, RobotNames
from algorithms.methods.merge_result import MergeResult
from algorithms.verdict.decision import Verdict, VerdictConfig, judge
from algorithms.verdict.probability_model import (
    LITTLE,
    Fit,
    misfit_of,
    probability,
    quantities_of,
    shipped_model,
)
from algorithms.verdict.ranking import WINDOW_EDGE, Weighed
from app.drawing.palette import LIGHT, QUIET
from app.drawing.svg.verdict_bars import bars
from app.model import verdict_text as words
from app.page.panels.html_widgets import box, put

HOW = (
    "What the verdict would be, were these numbers others. How the search ended is left aside: only the "
    "numbers count."
)
SMALL = "margin:2px 12px 6px;font-size:12px;line-height:1.45;opacity:.85"
MOST_LIKELY = 99.9  # per cent, of another answer
DEVIATION, OTHER = "deviation", "other"  # beside the fields of Evidence


class Dial(NamedTuple):
    """A slider; ``most`` is its upper end: in metres and m² it grows with what is there."""

    label: str
    hint: str
    most: float
    step: float = 0.5


DIALS: dict[str, Dial] = {
    "rigid_agreeing": Dial("agrees (m)", "Wall that both maps have in one place, as they lie.", 40.0),
    "rigid_contradicting": Dial(
        "contradicts (m)", "Wall of one map on free floor of the other, as they lie.", 40.0
    ),
    "contradicting": Dial(
        "left when slipped (m)", "What still contradicts when every patch of 7 m may slip by 0.6 m.", 40.0
    ),
    "floor": Dial("floor in common (m²)", "Free floor that both robots saw.", 100.0, 1.0),
    "across": Dial("across (m)", "Agreeing wall across the direction of most of it.", 40.0),
    DEVIATION: Dial("off its sighting (σ)", "Robot 2 from where it was seen, in deviations.", 8.0, 0.1),
    OTHER: Dial(
        "other answer (%)",
        "How likely the best other answer would be, were it alone. 0: none.",
        MOST_LIKELY,
        0.1,
    ),
}


def numbers_of(result: MergeResult) -> dict[str, float]:
    """What each slider stands at for a merge: metres, m², standard deviations, per cent."""
    named, *others = result.weighed
    other = max((each.score for each in others), default=None)
    return {
        **{name: getattr(named.evidence, name) for name in DIALS if name not in (DEVIATION, OTHER)},
        DEVIATION: max(named.deviations, default=0.0),
        OTHER: 0.0 if other is None else min(MOST_LIKELY, 100 * probability(other)),
    }


def supposed(result: MergeResult, rules: VerdictConfig, changed: Mapping[str, float]) -> Verdict:
    """The verdict on a merge with some numbers changed: by the names of ``DIALS``, in their units."""
    named, *others = result.weighed
    changed = dict(changed)
    if "rigid_agreeing" in changed:  # more wall that agrees agrees when patches slip, too
        more = changed["rigid_agreeing"] - named.evidence.rigid_agreeing
        changed["agreeing"] = max(0.0, named.evidence.agreeing + more)
    walls = {name: value for name, value in changed.items() if hasattr(named.evidence, name)}
    evidence = replace(named.evidence, **walls)
    deviations = list(named.deviations)
    if DEVIATION in changed and deviations:
        deviations[deviations.index(max(deviations))] = changed[DEVIATION]
    model, searched = shipped_model(result.kind), exp(named.quantities["searched"]) - LITTLE
    quantities = quantities_of(Fit(evidence, misfit_of(deviations, WINDOW_EDGE), searched))
    score = model.score(quantities)
    found = {"evidence": evidence, "deviations": tuple(deviations), "quantities": quantities, "score": score}
    if OTHER in changed:
        others = _with_best(others, named, changed[OTHER] / 100)
    return judge(result.fusion, replace(named, **found), others, result.pivot, rules, model=model)


def _with_best(others: list[Weighed], named: Weighed, likely: float) -> list[Weighed]:
    """The other answers, the best of them so likely; where there is none, one that is turned by half."""
    ranked = sorted(others, key=lambda each: -each.score)
    if likely <= 0:
        return ranked[1:]
    turned = replace(named, T_ref_mov=named.T_ref_mov @ Pose2(theta=pi))
    best = ranked[0] if ranked else turned
    return [replace(best, score=log(likely / (1 - likely))), *ranked[1:]]


class WhatIfPanel:
    """The sliders, and the verdict below them."""

    def __init__(self, gui: viser.GuiApi, rules: Callable[[], VerdictConfig]) -> None:
        self._rules = rules
        self._result: MergeResult | None = None
        self._names = UNNAMED
        self._wanted = False
        self._shown: dict[str, float] = {}  # of the result, as the sliders show it
        self._turn = RLock()  # sliders call back from many threads
        self._writer = 0  # a value that is written calls back at once
        self._folder = gui.add_folder("What if", order=61.0, expand_by_default=False, visible=False)
        with self._folder:
            gui.add_html(f'<p style="{SMALL}">{HOW}</p>')
            self._handles: dict[str, Any] = {
                name: gui.add_slider(
                    dial.label, min=0.0, max=dial.most, step=dial.step, initial_value=0.0, hint=dial.hint
                )
                for name, dial in DIALS.items()
            }
            for handle in self._handles.values():
                handle.on_update(lambda _: self._read())
            self._says = gui.add_html("")
            gui.add_button("Reset what if", color=QUIET).on_click(
                lambda _: self.offer(self._result, self._names)
            )

    def offer(self, result: MergeResult | None, names: RobotNames = UNNAMED) -> None:
        """Begin with the numbers of this merge; None where there is none."""
        with self._turn:
            self._names = names
            self._result = result if result is not None and result.weighed else None
            self._show()
            if self._result is None:
                return
            self._writer = get_ident()
            try:
                self._write(self._result)
            finally:
                self._writer = 0
            self._tell(self._result)

    def research(self, yes: bool) -> None:
        """Show the folder where there is a result, or hide it."""
        with self._turn:
            self._wanted = yes
            self._show()

    def _show(self) -> None:
        put(self._folder, visible=self._wanted and self._result is not None)

    def _write(self, result: MergeResult) -> None:
        for name, value in numbers_of(result).items():
            dial, handle = DIALS[name], self._handles[name]
            most = dial.most
            while most < value and name not in (DEVIATION, OTHER):
                most *= 2
            handle.max = most
            put(handle, hint=self._names.told(dial.hint))
            self._shown[name] = handle.value = round(min(value, most) / dial.step) * dial.step

    def _read(self) -> None:
        if self._writer != get_ident():
            with self._turn:
                if self._result is not None:
                    self._tell(self._result)

    def _tell(self, result: MergeResult) -> None:
        # what was not moved counts with all its digits
        changed = {
            name: float(handle.value)
            for name, handle in self._handles.items()
            if abs(float(handle.value) - self._shown[name]) > 1e-6
        }
        verdict = supposed(result, self._rules(), changed)
        self._says.content = (
            box(self._names.told(verdict.reason), words.mood(verdict))
            + f'<div style="margin:0 10px 8px">{bars(verdict, LIGHT, self._names)}</div>'
        )
