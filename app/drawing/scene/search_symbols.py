"""What a search shows over the map, as data: rings, windows, boxes, rivals, matches. Nothing here sends."""

from __future__ import annotations

from typing import Any

import numpy as np

from algorithms.common.pose import FloatArray, Pose2, rotation
from algorithms.methods.steps import MatchesDetail, WindowDetail
from algorithms.observations.observation import Observation
from algorithms.observations.search_window import CoupledWindow, Window
from algorithms.optimisation.branch_and_bound import ProofState
from algorithms.optimisation.search_box import SearchBox
from app.drawing.draw_items import Item, ellipse, mark, path, rectangle
from app.drawing.palette import Palette, css
from app.drawing.scene.robot_symbols import QUIET, ZERO, robot
from app.drawing.scene_layout import Rect, SceneLayout

MOST_MATCHES = 160  # drawn; more would be a blot
DASHED = {"close": True, "d": [6, 4], "halo": True}


def rings(covariance: FloatArray, colours: Palette) -> list[Item]:
    """Σ_aug around the meeting place: one and two standard deviations, in both maps."""
    items = []
    for k, name in ((1, "σ_aug"), (2, "2 σ_aug")):
        points = ellipse(ZERO, covariance, k)
        label = {"t": name, "tp": points[16], "dy": -8, "align": "center"}
        how = {"close": True, "w": 1.2, "d": [3, 4], "halo": True}
        items += [path(points, colours.margin, **how, **label), path(points, colours.margin, "map2", **how)]
    return items


def windows(
    detail: WindowDetail, turn: float, layout: SceneLayout, colours: Palette, view: Rect
) -> list[Item]:
    """Both windows as the places where T may put robot 2: the one in use strong, the other faint.

    turn : of map 2 at hand, radians: as printed the window bounds where map 2's origin goes, and robot 2
           stands off that by the turned x̂2
    view : what the camera shows; a window beyond it is given by its size
    """
    coupled = isinstance(detail.window, CoupledWindow)
    printed = detail.paper if coupled else detail.window
    assert isinstance(printed, Window)
    items = _paper_window(printed, turn, layout, colours, view, strong=not coupled)
    return items + discs(detail.coupled, layout, colours, strong=coupled)


def window_size(w: Window | CoupledWindow) -> str:
    """Sides of a window as words."""
    width, height = (w.high - w.low).tolist()
    return f"{width:.1f} m × {height:.1f} m"


def _paper_window(
    w: Window, turn: float, layout: SceneLayout, colours: Palette, view: Rect, strong: bool
) -> list[Item]:
    off = rotation(turn) @ (layout.anchor_mov - w.pivot) - layout.anchor_ref
    low, high = w.low + off, w.high + off
    width = float(high[0] - low[0])
    words = f"paper's window, eqs. (6)–(10): {window_size(w)}"
    x0, y0, x1, y1 = view
    middle = float(np.clip((x0 + x1) / 2, low[0], high[0]))
    # the words stand on an edge that is seen, away from the meeting place, where much is written
    edges = [(edge, dy) for edge, dy in ((low[1], 11), (high[1], -11)) if y0 < edge < y1]
    clear = [(edge, dy) for edge, dy in edges if abs(edge) > 0.2 * (y1 - y0)]
    edge, dy = max(clear, key=lambda found: abs(found[0]), default=(y0, 14))
    if width < (x1 - x0) / 4:  # small: above the words of the disc in it
        edge, dy = high[1], -25
    if not edges:
        words += ", beyond this view"
    label = {
        "t": words,
        "tp": np.array((middle, edge)),
        "dy": dy,
        "align": "center",
        "tc": css(colours.margin),
    }
    how = {"close": True, "d": [6, 4], "w": 1.8 if strong else 1.0, "halo": strong}
    return [path(rectangle(low, high), colours.margin, alpha=1.0 if strong else QUIET, **how, **label)]


def discs(
    w: CoupledWindow, layout: SceneLayout, colours: Palette, strong: bool = True, below: bool = False
) -> list[Item]:
    """The disc per sighting in which T may put the seen robot; ``below``: its name stands at its foot."""
    items = []
    for number, (x_ref, covariance) in enumerate(zip(w.x_ref, w.covariances, strict=True), 1):
        ring = ellipse(x_ref - layout.anchor_ref, covariance, w.k)
        how: dict[str, Any] = {"close": True, "w": 1.8 if strong else 1.0, "halo": strong}
        if not strong:
            how["d"] = [2, 3]
        if number == 1:
            edge = ring[int(ring[:, 1].argmin() if below else ring[:, 1].argmax())]
            name = {"t": f"coupled window, {w.k:g} σ", "tc": css(colours.margin)}
            how |= name | {"tp": edge, "dy": 13 if below else -11, "align": "center"}
        alpha = 1.0 if strong and number == 1 else QUIET
        items.append(path(ring, colours.margin, alpha=alpha, **how))
    return items


def proof(state: ProofState, layout: SceneLayout, colours: Palette) -> list[Item]:
    """The best so far and its rivals, as map 2's robot would stand there."""
    rivals = (layout.placed(Pose2.from_array(pose)).xy for pose in state.rivals)
    items = [mark("dot", at, colours.rival, r=4.5) for at in rivals]
    if state.best is not None:
        at = layout.placed(Pose2.from_array(state.best)).xy
        items.append(mark("star", at, colours.answer, r=9, rim=css(colours.rim)))
    return items


def rival(at: Pose2, hull: FloatArray, seen: Observation | None, words: str, colours: Palette) -> list[Item]:
    """Where map 2 and its robot would lie under the rival that leaves the answer in doubt.

    at   : where the rival puts map 2's anchor, and its turn; scene
    hull : (N, 2) outline of map 2, from its anchor
    seen : the sighting of robot 2, which stands at the anchor; None: where it stood is not known
    """
    outline = at.apply(hull)
    foot = outline[int(outline[:, 1].argmin())]
    label = {"t": f"rival: {words}", "tp": foot, "dy": 13, "align": "center", "size": 12}
    label["tc"] = css(colours.rival)
    around = path(outline, colours.rival, alpha=0.8, w=1.4, close=True, d=[7, 5], **label)
    if seen is None:
        return [around]
    # larger than the star of the answer, which lies on it: both put robot 2 where it was seen
    turned = None if seen.observed_heading is None else seen.observed_heading + at.theta
    return [around, robot(at.xy, turned, (13, 12), colours.rival, "scene")]


def margins(sigma_x: float, sigma_y: float, colours: Palette) -> list[Item]:
    """The size of the optimiser's box, before there is a candidate to put it on."""
    half = np.array([sigma_x, sigma_y])
    label = {"t": "± σ_x, ± σ_y", "tp": half * (0, -1), "dy": 10, "align": "center"}
    return [path(rectangle(-half, half), colours.margin, **DASHED, **label)]


def box(b: SearchBox, layout: SceneLayout, colours: Palette) -> list[Item]:
    """The optimiser's box around where its centre puts robot 2."""
    middle = layout.placed(b.transform(b.centre)).xy
    half = (b.high - b.low)[:2] / 2
    corners = rectangle(middle - half, middle + half)
    return [path(corners, colours.margin, w=1.5, t="box ± σ_x, ± σ_y", tp=corners[3], dy=-8, **DASHED)]


def seen_robot(transforms: FloatArray, layout: SceneLayout) -> FloatArray:
    """(P, 3) where each (Δx, Δy, Δθ) puts x̂2 in the scene, and its turn; metres, metres, radians."""
    c, s = np.cos(transforms[:, 2]), np.sin(transforms[:, 2])
    x, y = layout.anchor_mov
    at = transforms[:, :2] + np.column_stack([c * x - s * y, s * x + c * y]) - layout.anchor_ref
    return np.column_stack([at, transforms[:, 2]])


def footprint(b: SearchBox, layout: SceneLayout) -> Rect:
    """Rectangle that shows a box of transforms at the seen robot, with walls around it."""
    edges = list(zip(b.low.tolist(), b.high.tolist(), strict=True))
    corners = np.array(np.meshgrid(*edges)).reshape(3, -1).T
    at = seen_robot(b.transforms(corners), layout)[:, :2]
    low, high = at.min(axis=0), at.max(axis=0)
    half = max(0.8, 0.85 * float((high - low).max()))
    x, y = ((low + high) / 2).tolist()
    return x - half, y - half, x + half, y + half


def matches(found: MatchesDetail, mov_at: Pose2, layout: SceneLayout, colours: Palette) -> list[Item]:
    """Lines between the features that look alike, from map 1 to map 2; those that agree on a transform on
    top and strong.

    mov_at : where map 2's anchor lies, and its turn; scene
    """
    first = found.ref - layout.anchor_ref
    second = mov_at.apply(found.mov - layout.anchor_mov)
    agreeing = bool(found.inliers.any())
    items = []
    for strong in (False, True):
        some = np.flatnonzero(found.inliers == strong)
        for k in some[:: max(1, -(-len(some) // MOST_MATCHES))].tolist():
            ends = np.array([first[k], second[k]])
            if strong:
                items.append(path(ends, colours.best, w=1.7, alpha=0.9))
                items.append(mark("dot", ends[0], colours.ref, r=2.6, rim="#ffffff"))
                items.append(mark("dot", ends[1], colours.mov, r=2.6, rim="#ffffff"))
            else:
                faint = 0.22 if agreeing else 0.6
                items.append(path(ends, colours.margin if agreeing else colours.particle, w=0.9, alpha=faint))
    return items
