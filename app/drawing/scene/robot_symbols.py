"""The robots as signs over the map, as data: where they stood, what they saw, what they are held by."""

from __future__ import annotations

from collections.abc import Sequence
from math import cos
from typing import Any

import numpy as np

from algorithms.common.pose import FloatArray
from algorithms.observations.observation import Encounter, Observation
from app.drawing.draw_items import Item, ellipse, mark, path
from app.drawing.palette import Palette, Rgb
from app.drawing.scene_layout import SceneLayout
from app.model.observation_draft import ObservationDraft

ZERO = np.zeros(2)  # the meeting place of the first sighting, in both frames
TURN_ARM = 90  # px from robot 2 to the knob that turns map 2; map_editing.js knows it as the knob's arm
KNOB_ARM = 34  # px from a robot to the knob that turns it; map_editing.js knows it as ARM
QUIET = 0.55  # opacity of what is drawn beside the first sighting


def robot(
    at: FloatArray, heading: float | None, sizes: tuple[float, float], colour: Rgb, frame: str, **more: Any
) -> Item:
    """A robot, or a dot where its heading is not known; ``sizes`` of both in pixels."""
    if heading is None:
        return mark("dot", at, colour, frame, r=sizes[1], **more)
    return mark("robot", at, colour, frame, a=heading, r=sizes[0], **more)


def robots(
    o: Observation,
    layout: SceneLayout,
    colours: Palette,
    mov: bool,
    together: bool,
    seen: bool,
) -> list[Item]:
    """Both robots.

    mov      : whether map 2 is there
    together : map 2 lies on map 1; the meeting place is then marked by robot 2 itself
    seen     : whether robot 2 is drawn
    """
    near, far = _sides(o, 14)
    first = o.observer.xy - layout.anchor_ref
    items = [mark("robot", first, colours.ref, a=o.observer.theta, r=9, t="robot 1", **near)]
    if mov and seen:
        items.append(robot(ZERO, o.observed_heading, (9, 6), colours.mov, "map2", t="robot 2", **far))
    if not together:
        items.append(mark("ring", ZERO, colours.conflict, r=7, t="x̂₁ seen here", size=11, **far))
        if mov:
            items.append(mark("ring", ZERO, colours.conflict, "map2", r=13))
    return items


def sight(
    o: Observation, at: Encounter, layout: SceneLayout, colours: Palette, apart: bool, close: bool
) -> list[Item]:
    """The line of sight, the doubt of its far end, and which two places of the maps are one.

    apart : map 2 lies beside map 1
    close : seen from so near that the doubt is more than a dot
    """
    first = o.observer.xy - layout.anchor_ref
    items = [path(np.array([first, ZERO]), colours.text, w=1.6, d=[5, 4], halo=True)]
    if close:
        doubt = ellipse(ZERO, at.covariance + 1e-9 * np.eye(2), 3)
        lowest = doubt[int(doubt[:, 1].argmin())]
        name = {"t": "3 σ of the sighting", "tp": lowest, "dy": 11, "align": "center"}
        items.append(path(doubt, colours.text, w=1, close=True, halo=True, **name))
    if apart:
        items.append(path(np.array([ZERO, layout.apart.xy]), colours.margin, w=1, d=[1, 5]))
    return items


def further(
    seen: Sequence[Observation],
    places: Sequence[Encounter],
    layout: SceneLayout,
    colours: Palette,
    mov: bool,
    together: bool,
) -> list[Item]:
    """Every sighting beyond the first, with its number; ``together``: robot 2 stands as far off as T fits."""
    items = []
    for number, (o, at) in enumerate(zip(seen[1:], places[1:], strict=True), 2):
        first, end = o.observer.xy - layout.anchor_ref, at.x_ref - layout.anchor_ref
        _, far = _sides(o, 9)
        name = {"t": str(number), "size": 11, **far}
        items.append(path(np.array([first, end]), colours.text, alpha=QUIET, w=1, d=[2, 5]))
        items.append(mark("robot", first, colours.ref, alpha=QUIET, a=o.observer.theta, r=6))
        # once the maps lie together, the number stands beside robot 2 alone
        items.append(mark("ring", end, colours.conflict, alpha=QUIET, r=4, **({} if together else name)))
        if mov:
            there = at.x_mov - layout.anchor_mov
            items.append(robot(there, o.observed_heading, (6, 4), colours.mov, "map2", alpha=QUIET, **name))
    return items


def _sides(o: Observation, dx: float) -> tuple[dict[str, Any], dict[str, Any]]:
    """Where names stand at the near and the far end of a line of sight: beyond it."""
    left, right = {"dx": -dx, "align": "right"}, {"dx": dx, "align": "left"}
    return (left, right) if cos(o.observer.theta + o.bearing) >= 0 else (right, left)


def drafts(
    draft: ObservationDraft, others: Sequence[ObservationDraft], layout: SceneLayout, colours: Palette
) -> list[Item]:
    """Robots as they are being placed, with knobs on the chosen draft's; the other drafts are quiet."""
    shown = [*((one, QUIET) for one in others), (draft, 1.0)]
    return [item for one, alpha in shown for item in _draft(one, layout, colours, alpha)]


def _draft(draft: ObservationDraft, layout: SceneLayout, colours: Palette, alpha: float) -> list[Item]:
    items: list[Item] = []
    chosen = alpha == 1.0
    first = draft.observer.xy - layout.anchor_ref if draft.observer else None
    if first is not None and draft.seen is not None:
        end = np.array(draft.seen) - layout.anchor_ref
        items.append(path(np.array([first, end]), colours.text, alpha=alpha, w=1.6, d=[5, 4], halo=chosen))
        name = {"t": "robot 2, seen here", "size": 11, "dx": 14} if chosen else {}
        items.append(mark("ring", end, colours.conflict, alpha=alpha, r=7, **name))
    if first is not None and draft.observer is not None:
        a = draft.observer.theta
        if chosen:
            items.append(mark("dot", first, colours.ref, a=a, r=5, arm=KNOB_ARM))
        name = {"t": "robot 1", **_beside(a)} if chosen else {}
        items.append(mark("robot", first, colours.ref, alpha=alpha, a=a, r=9, **name))
    if draft.observed is not None:
        there = np.array(draft.observed) - layout.anchor_mov
        name = {"t": "robot 2", **_beside(draft.heading or 0.0)} if chosen else {}
        if chosen:  # where nobody knows which way it looked, the knob can tell
            known = draft.heading is not None
            how = {"alpha": 1.0 if known else QUIET, "a": draft.heading or 0.0, "r": 5, "arm": KNOB_ARM}
            items.append(mark("dot" if known else "ring", there, colours.mov, "map2", **how))
        items.append(robot(there, draft.heading, (9, 7), colours.mov, "map2", alpha=alpha, **name))
    return items


def _beside(heading: float) -> dict[str, Any]:
    """Where a robot's name stands clear of its knob."""
    return {"dx": -14, "align": "right"} if cos(heading) >= 0 else {"dx": 14, "align": "left"}


def grip(hull: FloatArray, colours: Palette) -> list[Item]:
    """What map 2 is held by: its outline, and a knob to turn it about its anchor; in its own frame."""
    return [
        path(hull, colours.mov, "map2", w=1.4, close=True, d=[7, 5], halo=True),
        mark("dot", ZERO, colours.mov, "map2", r=8, a=0.0, arm=TURN_ARM, t="turn"),
    ]
