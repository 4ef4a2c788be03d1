"""The picture of the verdict: every number beside the limit it has to keep."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from algorithms.merit import performance_index
from algorithms.steps import MergeResult
from algorithms.verdict import HALF
from app.lesson.study import Study
from app.palette import LIGHT, Palette, Rgb, css
from app.pictures.sheet import INK, Sheet, worded

GOOD, BAD = css(LIGHT.mov), css(LIGHT.conflict)


@dataclass(frozen=True)
class Gauge:
    """A number on a bar, and the limit it has to stay on the right side of.

    limit : None where nothing is decided by it
    below : whether it has to stay below the limit
    doubt : whether the verdict finds fault with it, whatever the limit says
    """

    name: str
    value: float
    words: str
    top: float
    limit: float | None
    below: bool = True
    doubt: bool = False

    @property
    def kept(self) -> bool:
        """Whether the number keeps its limit."""
        if self.limit is None or self.doubt:
            return not self.doubt
        return self.value <= self.limit if self.below else self.value >= self.limit


def gauges(study: Study) -> list[Gauge]:
    """What the verdict rests on, then what is told for comparison."""
    result, rules = study.get(MergeResult), study.config.verdict
    v = result.verdict
    most = rules.contradiction if v.contradiction <= rules.contradiction or v.bent < rules.bent else (
        rules.bent_contradiction
    )  # fmt: skip
    rival = v.ambiguity or 0.0
    spans = (rules.wall, max(rules.wall + 1e-9, rules.plenty)), (HALF, rules.ambiguity)
    doubted = float(np.interp(v.shared_wall, *spans))  # little wall fits in several places
    index = performance_index(result.fusion) or 0.0
    return [
        Gauge("wall denied by the other map", v.contradiction, f"{v.contradiction:.1%}", 2.5 * most, most),
        Gauge(
            "wall that both should have seen", v.shared_wall, f"{v.shared_wall:.0f} m",
            max(5 * rules.wall, 1.1 * v.shared_wall), rules.wall, False,
        ),
        Gauge(
            "best rival's share of the value", rival, f"{rival:.0%}", 1.0, doubted, True, v.rival is not None
        ),
        Gauge(
            "robot 2 from where it was seen", v.deviation, f"{v.deviation:.1f} σ",
            max(1.5 * rules.deviations, 1.1 * v.deviation), rules.deviations,
        ),
        Gauge("cells that agree, eq. (23)", index, f"{index:.1%}", 1.0, None),
        Gauge("acceptance index", v.acceptance_index, f"{v.acceptance_index:.1%}", 1.0, None),
    ]  # fmt: skip


def _words(good: bool, palette: Palette) -> Rgb:
    return worded(palette.mov if good else palette.conflict, palette)


def verdict(study: Study, at: Sequence[int], palette: Palette) -> str:
    """The bars, one below the other, under the verdict itself."""
    result = study.get(MergeResult)
    sheet, told = Sheet(268), gauges(study)
    accepted = result.verdict.accepted
    sheet.text(0, 13, "Accepted" if accepted else "Refused", 15, colour=_words(accepted, palette), bold=True)
    sheet.text(380, 13, "line: the limit", 10.5, "end", alpha=0.8)
    for k, gauge in enumerate(told):
        y = 34 + 40 * k
        colour = css(palette.margin) if gauge.limit is None else GOOD if gauge.kept else BAD
        sheet.text(0, y, gauge.name + (" (told, not asked)" if gauge.limit is None else ""), 11)
        words = INK if gauge.limit is None else _words(gauge.kept, palette)
        sheet.text(380, y, gauge.words, 12, "end", words, True)
        sheet.rect(0, y + 5, 380, 10, palette.margin, None, 0.18)
        sheet.rect(0, y + 5, 380 * min(1.0, max(0.0, gauge.value / gauge.top)), 10, colour)
        if gauge.limit is not None:
            x = 380 * min(1.0, gauge.limit / gauge.top)
            sheet.path([(x, y + 1), (x, y + 19)], INK, 2)
    return sheet.svg("The numbers of the verdict beside their limits")
