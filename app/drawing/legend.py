"""What the colours of the picture at hand mean."""

from __future__ import annotations

from typing import Any

from algorithms.maps.map_fusion import Fusion
from algorithms.methods.merge_result import MergeResult
from algorithms.methods.steps import (
    AugmentDetail,
    CandidatesDetail,
    HoughDetail,
    MatchesDetail,
    ProofDetail,
    ProvenDetail,
    RefineDetail,
    ShiftDetail,
    WindowDetail,
)
from app.drawing.palette import VIRIDIS, Palette, Rgb, css
from app.model.run_state import RunState

Entry = dict[str, Any]
_FAINT: Rgb = (156, 163, 175)  # walls of the difference that are not denied, light or dark


def _chip(shape: str, colour: Rgb, text: str) -> Entry:
    return {"s": shape, "c": css(colour), "t": text}


def level_scale(detail: AugmentDetail) -> Entry:
    """The colour scale of the levels, from nothing to the peak."""
    stops = [css(tuple(int(part) for part in VIRIDIS[k])) for k in range(0, 256, 51)]  # type: ignore[arg-type]
    return {"s": "scale", "c": stops, "low": "0", "high": f"{detail.ref.peak:.3g}", "t": "level, eq. (4)"}


def in_hand(palette: Palette) -> list[Entry]:
    """Entries for the map while map 2 is in a person's hand."""
    return [
        _chip("square", palette.ref, "map 1"),
        _chip("square", palette.mov, "map 2"),
        _chip("square", palette.agreed, "both"),
        _chip("square", palette.conflict, "contradiction"),
    ]


def legend(
    palette: Palette, view: str, story: RunState, preview: bool = False, mode: str = "overlay"
) -> list[Entry]:
    """Entries for the view and for what the run has come to.

    preview : the map shows levels, not candidates
    mode    : how two maps that lie over each other are compared
    """
    detail = story.last.detail if story.last else None
    augmented = story.get(AugmentDetail)
    maps = [_chip("square", palette.ref, "map 1"), _chip("square", palette.mov, "map 2")]
    particle = _chip("dot", palette.particle, "particle")
    best = _chip("diamond", palette.best, "swarm best")
    if preview and augmented and view == "Map":
        return [level_scale(augmented), _chip("line", palette.margin, "Σ_aug, windows, box")]
    if view == "Heights":
        return [level_scale(augmented)] if augmented else []
    if view == "Map" and mode in ("blink", "curtain"):
        return maps
    if view == "Map" and mode == "difference":
        return [
            _chip("square", palette.ref, "map 1 alone"),
            _chip("square", palette.mov, "map 2 alone"),
            _chip("square", _FAINT, "other walls"),
        ]
    star = _chip("star", palette.answer, "proven optimum")
    rival = _chip("dot", palette.rival, "rival")
    if view == "Swarm space":
        return [particle, best, *([star] if story.reached(ProvenDetail) else [])]
    if story.reached(Fusion):
        result = story.get(MergeResult)
        in_doubt = result is not None and result.verdict.rival is not None
        return [
            *maps,
            _chip("square", palette.agreed, "both"),
            _chip("square", palette.conflict, "contradiction"),
            _chip("star", palette.answer, "robot 2"),
            *([rival] if in_doubt else []),
        ]
    if isinstance(detail, (ProofDetail, ProvenDetail)):
        best_yet = star if detail.state.proven else _chip("star", palette.answer, "best so far")
        rivals = [rival] if len(detail.state.rivals) else []
        return [*maps, best_yet, *rivals, _chip("line", palette.margin, "coupled window")]
    if isinstance(detail, MatchesDetail):
        agree = _chip("line", palette.best, "matches that agree")
        others = _chip("line", palette.margin, "other matches")
        return (
            [*maps, agree, others]
            if detail.inliers.any()
            else [*maps, _chip("line", palette.particle, "match")]
        )
    if isinstance(detail, RefineDetail):
        return [*maps, particle, best, _chip("line", palette.margin, "box")]
    if isinstance(detail, (WindowDetail, ShiftDetail)):
        return [*maps, _chip("diamond", palette.particle, "robot 2 under a candidate")]
    if isinstance(detail, (AugmentDetail, HoughDetail, CandidatesDetail)) and augmented:
        first = _chip("diamond", palette.best, "robot 2 under the best candidate")
        if not isinstance(detail, CandidatesDetail):
            return [level_scale(augmented)]
        others = [_chip("diamond", palette.particle, "under another")] if len(detail.candidates) > 1 else []
        return [*maps, first, *others]
    return maps
