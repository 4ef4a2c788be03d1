"""What a person corrected in a merged map, in words on map 1 and map 2."""

from __future__ import annotations

from collections import Counter
from datetime import datetime, timezone

from algorithms.maps.grid_map import CellArray
from algorithms.maps.map_corrections import Corrections, Does
from algorithms.maps.map_fusion import ConflictRule, Fusion, newer

RULES: dict[ConflictRule, str] = {
    ConflictRule.OCCUPIED_WINS: "a wall counts",
    ConflictRule.REF_WINS: "map 1 counts",
    ConflictRule.MOV_WINS: "map 2 counts",
    ConflictRule.NEWER_WINS: "the newer map counts",
    ConflictRule.SURER_WINS: "the map that saw it more often counts",
}
DONE: dict[Does, tuple[str, str]] = {
    "map1": ("place where map 1 counts", "places where map 1 counts"),
    "map2": ("place where map 2 counts", "places where map 2 counts"),
    "unknown": ("place left unknown", "places left unknown"),
    "erase": ("part erased", "parts erased"),
    "keep-out": ("keep-out line", "keep-out lines"),
}
"""One of each, and several."""


def said(corrections: Corrections, changed: int) -> str:
    """All that was corrected, and how many cells that changed, in a sentence; empty where nothing was."""
    counts = Counter(edit.does for edit in corrections.edits)
    parts = [] if corrections.rule is None else [f"where the maps contradict, {RULES[corrections.rule]}"]
    parts += [f"{counts[does]} {words[counts[does] > 1]}" for does, words in DONE.items() if counts[does]]
    parts += ["cropped to what is known"] * corrections.crop
    if not parts:
        return ""
    return f"Corrected by hand: {', '.join(parts)}. {changed:,} cells changed."


def step_label(before: Corrections, after: Corrections) -> str:
    """What a person did between the two."""
    if before.rule != after.rule:
        return f"contradictions: {'as merged' if after.rule is None else RULES[after.rule]}"
    if before.crop != after.crop:
        return "crop to known" if after.crop else "not cropped"
    more = [edit for edit in after.edits if edit not in before.edits]
    if not more:
        return "corrections taken back" if after.edits or not before.edits else "all corrections taken back"
    one, several = DONE[more[-1].does]
    return one if len(more) == 1 else f"{len(more)} {several}"


def why(rule: ConflictRule, fusion: Fusion) -> str:
    """What the maps tell of a rule that goes by more than their order; empty where it does not."""
    if rule is ConflictRule.NEWER_WINS:
        wins, (first, second) = newer(fusion.dates), fusion.dates
        if wins is None or first is None or second is None:
            return "Which map is newer is not known, or they are equally old: a wall counts."
        later = 2 if wins is ConflictRule.MOV_WINS else 1
        return f"Map {later} is newer: map 1 was written on {_day_of(first)}, map 2 on {_day_of(second)}."
    if rule is ConflictRule.SURER_WINS and not any(_graded(layer) for layer in fusion.layers):
        return "These maps say wall, free or unknown, and not how often it was seen: a wall counts."
    return ""


def _graded(cells: CellArray) -> bool:
    """Whether a map's cells say how sure they are."""
    return bool(((cells > 0) & (cells < 100)).any())


def _day_of(seconds: float) -> str:
    return datetime.fromtimestamp(seconds, timezone.utc).strftime("%Y-%m-%d %H:%M")
