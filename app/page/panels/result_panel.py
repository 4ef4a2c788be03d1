"""The answer: what it means first, then why, then the numbers it rests on."""

from __future__ import annotations

from html import escape
from typing import Any

from algorithms.common.robot_names import UNNAMED, RobotNames
from algorithms.maps.map_corrections import NO_CORRECTIONS, Corrections, Does
from algorithms.methods.merge_result import MergeResult
from algorithms.verdict.contradictions import Contradictions
from algorithms.verdict.decision import Verdict
from app.drawing.palette import LIGHT
from app.drawing.svg.verdict_bars import bars
from app.model import verdict_text as words
from app.model.contradiction_text import MOST_PLACES, signed, summary, whose
from app.model.merge_inputs import MergeInputs
from app.page.panels.html_widgets import box, table
from app.report.result_rows import numbers, times

KEEP: dict[Does, str] = {"map1": "keep map 1", "map2": "keep map 2", "unknown": "unknown"}
CHOSEN: dict[Does, str] = {"map1": "map 1 kept", "map2": "map 2 kept", "unknown": "left unknown"}
"""What can be chosen at a place, and what is said of it then."""


def result_html(
    result: MergeResult,
    inputs: MergeInputs,
    config: Any = None,
    found: Contradictions | None = None,
    faded: bool = False,
    suggestions: str = "",
    corrections: Corrections = NO_CORRECTIONS,
) -> str:
    """HTML of the whole result but for the verdict's sentence, which stands above the map; where it is out of
    date faded, with that sentence.

    config : the settings that were used
    found  : where the maps contradict each other
    suggestions : HTML of what a refused merge suggests; never faded, since each can still be taken
    corrections : by which a map was chosen at some of those places
    """
    verdict, names = result.verdict, inputs.names
    if faded:
        head = box(
            names.told(verdict.reason), words.mood(verdict), "Out of date: something was changed.", True
        )
    else:
        remedy = names.told(words.remedy(result))
        head = box(remedy, words.mood(verdict)) if remedy else ""
    return (
        head
        + suggestions
        + why_html(verdict, faded, names)
        + (places_html(found, faded, names, corrections) if found is not None else "")
        + _fold("Numbers", "numbers", _numbers(result, inputs, config, faded), faded)
    )


def _numbers(result: MergeResult, inputs: MergeInputs, config: Any, faded: bool) -> str:
    return table(numbers(result, inputs, config), faded=faded) + table(
        times(result), ("time per stage", "ms"), faded
    )


def _fold(title: str, name: str, content: str, faded: bool) -> str:
    """HTML of something to be opened; the browser keeps it open in the next result, by its name."""
    dim = ";opacity:.4" if faded else ""
    return (
        f'<details data-mm-fold="{name}" style="margin:0 0 8px;font-size:12.5px{dim}">'
        f'<summary style="cursor:pointer;margin:0 10px 4px">{title}</summary>{content}</details>'
    )


def why_html(verdict: Verdict, faded: bool = False, names: RobotNames = UNNAMED) -> str:
    """HTML of the verdict to be opened: a bar per quantity that it rests on."""
    content = f'<div style="margin:0 10px">{bars(verdict, LIGHT, names)}</div>'
    return _fold(f"Why {words.likelihood(verdict.probability)}?", "why", content, faded)


def places_html(
    found: Contradictions,
    faded: bool = False,
    names: RobotNames = UNNAMED,
    corrections: Corrections = NO_CORRECTIONS,
) -> str:
    """HTML of the list, most wall first; faded and without effect where it is out of date. Which map counts
    at a place is chosen below its line, once that is pressed: see map_comparison.js.
    """
    dim, off = (' style="opacity:.4"', " disabled") if faded else ("", "")
    rows = []
    for n, place in enumerate(found.places[:MOST_PLACES], 1):
        chosen = corrections.chosen_at((place.x, place.y))
        side = whose(place) if chosen is None else CHOSEN[chosen]
        keep = "".join(
            f'<button type="button" data-mm-keep="{does}" data-mm-at="{n}"{off} '
            f'aria-pressed="{str(does == chosen).lower()}">{escape(names.told(label), quote=False)}</button>'
            for does, label in KEEP.items()
        )
        rows.append(
            f'<button type="button" data-mm-place="{n}" aria-pressed="false"{off} '
            f'title="Go there; press again for everything.">'
            f"<i>{n}</i><span>{place.wall:.1f} m</span><small>{escape(names.told(side), quote=False)}</small>"
            f"<small>x {signed(place.x)}, y {signed(place.y)}</small></button>"
            f'<span class="mm-keep" role="group" aria-label="What counts at place {n}">{keep}</span>'
        )
    said = escape(names.told(summary(found)), quote=False)
    return f'<div class="mm-places"{dim}><p>{said}</p>{"".join(rows)}</div>'
