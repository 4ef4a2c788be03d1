"""What is drawn over the map, as data: robots, sight, rings, windows, boxes. Nothing here sends."""

from __future__ import annotations

from collections.abc import Sequence
from math import cos
from typing import Any

import numpy as np

from algorithms.observation import Encounter, Observation
from algorithms.pose import FloatArray
from algorithms.window import Box, Window
from app.layout import Layout, Rect
from app.palette import Palette
from app.stage import Item, ellipse, mark, path, rectangle

ZERO = np.zeros(2)  # the meeting place of the first sighting, in both frames
QUIET = 0.55  # opacity of what is told beside the first sighting
DASHED = {"close": True, "d": [6, 4], "halo": True}


def robots(
    o: Observation, layout: Layout, colours: Palette, mov: bool, together: bool, seen: bool
) -> list[Item]:
    """Both robots with their names.

    mov      : whether map 2 is there
    together : map 2 lies on map 1; the meeting place is then marked by robot 2 itself
    seen     : whether robot 2 is drawn
    """
    near, far = _sides(o, 14)
    first = o.observer.xy - layout.anchor_ref
    items = [mark("robot", first, colours.ref, a=o.observer.theta, r=9, t="robot 1", **near)]
    if mov and seen:
        known = o.observed_heading is not None
        shape, how = ("robot", {"a": o.observed_heading, "r": 9}) if known else ("dot", {"r": 6})
        items.append(mark(shape, ZERO, colours.mov, "mov", t="robot 2", **how, **far))
    if not together:
        items.append(mark("ring", ZERO, colours.conflict, r=7, t="x̂₁ seen here", size=11, **far))
        if mov:
            items.append(mark("ring", ZERO, colours.conflict, "mov", r=13))
    return items


def sight(
    o: Observation, at: Encounter, layout: Layout, colours: Palette, mov: bool, together: bool, close: bool
) -> list[Item]:
    """The line of sight, the doubt of its far end, and which two places of the maps are one.

    close : seen from so near that the doubt is more than a dot
    """
    first = o.observer.xy - layout.anchor_ref
    items = [path(np.array([first, ZERO]), colours.text, w=1.6, d=[5, 4], halo=True)]
    if close:
        doubt = ellipse(ZERO, at.covariance + 1e-9 * np.eye(2), 3)
        lowest = doubt[int(doubt[:, 1].argmin())]
        name = {"t": "3 σ of the sighting", "tp": lowest, "dy": 11, "align": "center"}
        items.append(path(doubt, colours.text, w=1, close=True, halo=True, **name))
    if mov and not together:
        items.append(path(np.array([ZERO, layout.apart.xy]), colours.margin, w=1, d=[1, 5]))
    return items


def further(
    seen: Sequence[Observation],
    places: Sequence[Encounter],
    layout: Layout,
    colours: Palette,
    mov: bool,
    together: bool,
) -> list[Item]:
    """Every sighting beyond the first, quieter and with its number: robots, line of sight and its end.

    together : map 2 lies on map 1; robot 2 then stands at the end of the line as far as T fits
    """
    items = []
    for number, (o, at) in enumerate(zip(seen, places, strict=True), 1):
        if number == 1:
            continue
        first, end = o.observer.xy - layout.anchor_ref, at.x_ref - layout.anchor_ref
        _, far = _sides(o, 9)
        name = {"t": str(number), "size": 11, **far}
        items.append(path(np.array([first, end]), colours.text, alpha=QUIET, w=1, d=[2, 5]))
        items.append(mark("robot", first, colours.ref, alpha=QUIET, a=o.observer.theta, r=6))
        # once the maps lie together, the number stands beside robot 2 alone
        items.append(mark("ring", end, colours.conflict, alpha=QUIET, r=4, **({} if together else name)))
        if mov:
            known = o.observed_heading is not None
            shape, how = ("robot", {"a": o.observed_heading, "r": 6}) if known else ("dot", {"r": 4})
            there = at.x_mov - layout.anchor_mov
            items.append(mark(shape, there, colours.mov, "mov", alpha=QUIET, **how, **name))
    return items


def _sides(o: Observation, dx: float) -> tuple[dict[str, Any], dict[str, Any]]:
    """Where names stand at the near and the far end of a line of sight: beyond it."""
    left, right = {"dx": -dx, "align": "right"}, {"dx": dx, "align": "left"}
    return (left, right) if cos(o.observer.theta + o.bearing) >= 0 else (right, left)


def rings(covariance: FloatArray, colours: Palette, both: bool) -> list[Item]:
    """Σ_aug around the meeting place: one and two standard deviations, in one map or in both."""
    items = []
    for k, name in ((1, "σ_aug"), (2, "2 σ_aug")):
        points = ellipse(ZERO, covariance, k)
        label = {"t": name, "tp": points[16], "dy": -8, "align": "center"}
        how = {"close": True, "w": 1.2, "d": [3, 4], "halo": True}
        items.append(path(points, colours.margin, **how, **label))
        if both:
            items.append(path(points, colours.margin, "mov", **how))
    return items


def window(w: Window, x_mov: FloatArray, layout: Layout, colours: Palette) -> list[Item]:
    """The window of the shift: where T may put the pivot."""
    corners = rectangle(w.low - layout.anchor_ref, w.high - layout.anchor_ref)
    whose = "robot 2" if np.allclose(w.pivot, x_mov) else "map 2's origin"
    label = {"t": f"window for {whose}, eqs. (9), (10)", "tp": corners[2], "dy": -12, "align": "center"}
    return [path(corners, colours.margin, **DASHED, **label)]


def margins(sigma_x: float, sigma_y: float, colours: Palette) -> list[Item]:
    """The size of the optimiser's box, before there is a candidate to put it on."""
    half = np.array([sigma_x, sigma_y])
    label = {"t": "± σ_x, ± σ_y", "tp": half * (0, -1), "dy": 10, "align": "center"}
    return [path(rectangle(-half, half), colours.margin, **DASHED, **label)]


def box(b: Box, layout: Layout, colours: Palette) -> list[Item]:
    """The optimiser's box around where its centre puts robot 2."""
    middle = layout.placed(b.transform(b.centre)).xy
    half = (b.high - b.low)[:2] / 2
    corners = rectangle(middle - half, middle + half)
    return [path(corners, colours.margin, w=1.5, t="box ± σ_x, ± σ_y", tp=corners[3], dy=-8, **DASHED)]


def seen_robot(transforms: FloatArray, layout: Layout) -> FloatArray:
    """(P, 3) where each (Δx, Δy, Δθ) puts x̂2 in the scene, and its turn; metres, metres, radians."""
    c, s = np.cos(transforms[:, 2]), np.sin(transforms[:, 2])
    x, y = layout.anchor_mov
    at = transforms[:, :2] + np.column_stack([c * x - s * y, s * x + c * y]) - layout.anchor_ref
    return np.column_stack([at, transforms[:, 2]])


def footprint(b: Box, layout: Layout) -> Rect:
    """Rectangle that shows a box of transforms at the seen robot, with walls around it."""
    edges = list(zip(b.low.tolist(), b.high.tolist(), strict=True))
    corners = np.array(np.meshgrid(*edges)).reshape(3, -1).T
    at = seen_robot(b.transforms(corners), layout)[:, :2]
    low, high = at.min(axis=0), at.max(axis=0)
    half = max(0.8, 0.85 * float((high - low).max()))
    x, y = ((low + high) / 2).tolist()
    return x - half, y - half, x + half, y + half
