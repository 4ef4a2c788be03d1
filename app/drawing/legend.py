"""What the colours of the picture at hand mean."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from algorithms.maps.map_fusion import Fusion
from algorithms.methods import steps
from algorithms.methods.merge_result import MergeResult
from algorithms.methods.steps import AugmentDetail, CandidatesDetail, ProvenDetail
from app.drawing.palette import ROBOTS, Palette, Rgb, css, level_colours, robot_colour
from app.model.run_state import RunState

Entry = dict[str, Any]
_FAINT: Rgb = (156, 163, 175)  # walls of the difference that are not denied, light or dark


def _chip(shape: str, colour: Rgb, text: str) -> Entry:
    return {"s": shape, "c": css(colour), "t": text}


def _maps(palette: Palette) -> list[Entry]:
    return [_chip("square", colour, f"map {number}") for number, colour in enumerate(palette.maps, 1)]


def peak_level(detail: AugmentDetail) -> str:
    """The level that a wall at the meeting place would have; I_aug per m²."""
    return f"{detail.ref.peak:.3g}"


def level_scale(detail: AugmentDetail, palette: Palette) -> Entry:
    """The colour scale of the levels, from nothing to the peak."""
    colours = level_colours(np.linspace(0, 1, 6), palette.dark).tolist()
    stops = [css((red, green, blue)) for red, green, blue in colours]
    return {"s": "scale", "c": stops, "low": "0", "high": peak_level(detail), "t": "level, eq. (4)"}


def fleet_legend(palette: Palette, robots: Sequence[str]) -> list[Entry]:
    """Entries for a fleet's robots, and for what its lines mean; of many robots those with colours alone."""
    shown = [_chip("square", robot_colour(number), name) for number, name in enumerate(robots[: len(ROBOTS)])]
    lines = [_chip("line", palette.mov, "saw"), _chip("line", palette.conflict, "left out")]
    return [*shown, *lines]


def in_hand(palette: Palette) -> list[Entry]:
    """Entries for maps that lie over each other."""
    both, against = (palette.agreed, "both"), (palette.conflict, "contradiction")
    return [*_maps(palette), *(_chip("square", *entry) for entry in (both, against))]


def legend(
    palette: Palette, view: str, run: RunState, preview: bool = False, mode: str = "overlay"
) -> list[Entry]:
    """Entries for the view and for what the run has come to.

    preview : the map shows levels, not candidates
    mode    : how two maps that lie over each other are compared
    """
    detail = run.last.detail if run.last else None
    augmented = run.get(AugmentDetail)
    scale = [level_scale(augmented, palette)] if augmented else []
    maps = _maps(palette)
    margin, best, particle = palette.margin, palette.best, palette.particle
    swarm = [_chip("dot", particle, "particle"), _chip("diamond", best, "swarm best")]
    star, rival = _chip("star", palette.answer, "proven optimum"), _chip("dot", palette.rival, "rival")
    if view == "Heights":
        return scale
    if view == "Swarm space":
        return [*swarm, star] if run.reached(ProvenDetail) else swarm
    if preview and scale:
        return [*scale, _chip("line", margin, "Σ_aug, windows, box")]
    if mode in ("blink", "curtain"):
        return maps
    if mode == "result":
        kinds = (palette.agreed, "wall"), (palette.free, "free floor"), (palette.unknown, "unknown")
        return [_chip("square", *kind) for kind in kinds]
    if mode == "difference":
        alone = [entry | {"t": f"{entry['t']} alone"} for entry in maps]
        return [*alone, _chip("square", _FAINT, "other walls")]
    if run.reached(Fusion):
        result = run.get(MergeResult)
        in_doubt = result is not None and result.verdict.rival is not None
        seen = run.get(steps.ObservationDetail)
        name = "robot 2" if seen is None or seen.encounters else "answer"
        return [*in_hand(palette), _chip("star", palette.answer, name), *([rival] if in_doubt else [])]
    if isinstance(detail, (steps.ProofDetail, ProvenDetail)):
        if not detail.state.proven:
            star["t"] = "best so far"
        rivals = [rival] if len(detail.state.rivals) else []
        return [*maps, star, *rivals, _chip("line", margin, "coupled window")]
    if isinstance(detail, steps.MatchesDetail):
        if not detail.inliers.any():
            return [*maps, _chip("line", particle, "match")]
        return [*maps, _chip("line", best, "matches that agree"), _chip("line", margin, "other matches")]
    if isinstance(detail, steps.RefineDetail):
        return [*maps, *swarm, _chip("line", margin, "box")]
    if isinstance(detail, (steps.WindowDetail, steps.ShiftDetail)):
        return [*maps, _chip("diamond", particle, "robot 2 under a candidate")]
    if isinstance(detail, steps.PlaneDetail):
        return [
            *maps,
            _chip("diamond", best, "best place so far"),
            _chip("diamond", particle, "other places"),
        ]
    if isinstance(detail, CandidatesDetail) and augmented:
        others = [_chip("diamond", particle, "under another")] if len(detail.candidates) > 1 else []
        return [*maps, _chip("diamond", best, "robot 2 under the best candidate"), *others]
    return scale if scale and isinstance(detail, (AugmentDetail, steps.HoughDetail)) else maps
