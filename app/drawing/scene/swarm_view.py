"""The swarm in the space of what it searches: x, y and turn, inside its box."""

from __future__ import annotations

from itertools import product
from math import pi

import numpy as np

from algorithms.common.pose import FloatArray, Pose2, pose_error, wrap_angle
from algorithms.methods.steps import ProvenDetail, RefineDetail
from algorithms.optimisation.search_box import SearchBox
from app.drawing.browser_messages import BrowserMessages
from app.drawing.draw_items import Item, cloud, mark, path
from app.drawing.palette import Palette, css
from app.model import status_text as words
from app.model.run_state import RunState

TRAILS = 24  # particles that draw a trail
TRAIL_LENGTH = 10
POINTS = 500

# a box corner (x, y, turn) in -1 … 1 -> the page's axes: x right, turn up, y away from the eye
_AXES = np.array([[1.0, 0, 0], [0, 0, -1.0], [0, 1.0, 0]])


def to_cube(poses: FloatArray, low: FloatArray, high: FloatArray) -> FloatArray:
    """(P, 3) coordinates in a box as (P, 3) places in a cube of edge 2, in the page's axes."""
    width = np.where(high > low, high - low, 1.0)
    return np.asarray((2 * (poses - low) / width - 1) @ _AXES, dtype=np.float64)


def in_box(T_ref_mov: Pose2, box: SearchBox) -> FloatArray:
    """(3,) coordinates of a transform in a box: where the pivot goes, and the turn nearest to the box's."""
    middle = float(box.centre[2])
    turn = middle + wrap_angle(T_ref_mov.theta - middle)
    return np.append(T_ref_mov.apply(box.pivot), turn)


def proven_optimum(proven: ProvenDetail, detail: RefineDetail, palette: Palette) -> list[Item]:
    """The proven optimum as a star; where it lies outside of the box, on its border, with how far it is."""
    box, T = detail.box, proven.peak.T_ref_mov
    at = to_cube(in_box(T, box)[None], box.low, box.high)[0]
    beyond = float(np.abs(at).max())
    name = "proven optimum" if proven.state.proven else "best known"
    star = {"r": 10, "rim": css(palette.rim), "tc": css(palette.text), "size": 12, "dx": 16}
    if beyond <= 1.001:
        # larger than the swarm's best, which lies on it where the swarm found it, and its words above
        return [mark("star", at, palette.answer, t=name, dy=-16, **star | {"r": 15})]
    distance, turn = pose_error(box.transform(detail.state.best), T, box.pivot)
    edge = at / beyond
    best = to_cube(detail.state.best[None], box.low, box.high)[0]
    ray = path(np.array([best, edge]), palette.margin, w=1, d=[2, 4])
    first = star | {"t": f"{name}, outside", "dx": 0, "dy": 22, "align": "center"}
    second = first | {"t": f"{words.apart_by(distance, turn)} from the swarm's best", "dy": 38, "r": 0}
    del second["rim"]
    return [ray, mark("star", edge, palette.answer, **first), mark("none", edge, palette.text, **second)]


class SwarmView:
    """Particles, a few trails, the swarm's best, the proven optimum, and shadows on floor and walls."""

    def __init__(self, messages: BrowserMessages) -> None:
        self._messages = messages
        self._trail: list[FloatArray] = []
        self._of: tuple[SearchBox | None, Palette | None] = None, None  # whose frame is drawn

    def hide(self) -> None:
        for name in ("axes", "swarm", "trail", "best", "rival", "floor"):
            self._messages.layer(name, None)
        self._trail.clear()
        self._of = None, None

    def show(self, run: RunState, palette: Palette, look: bool) -> None:
        """Draw the newest snapshot; ``look`` puts the camera before the box."""
        detail = run.swarm
        if look:
            self._messages.look_at("swarm", np.array([0.0, 0.0, 0.0]), 1.95, 1.15, -0.55)
        if detail is None:
            how = {"t": "Press Merge: the swarm appears here.", "align": "center", "size": 14}
            self._messages.layer("axes", [mark("dot", np.zeros(3), palette.margin, r=0.1, **how)])
            return
        proven = run.get(ProvenDetail)
        known = proven is not None and proven.state.best is not None
        self._messages.layer("rival", proven_optimum(proven, detail, palette) if known else None)
        low, high = detail.box.low, detail.box.high
        if self._of[0] is not detail.box or self._of[1] is not palette:
            self._of = detail.box, palette
            self._trail.clear()
            self._messages.layer("axes", self._frame(detail, palette))
        step = -(-len(detail.state.poses) // POINTS)
        cube = to_cube(detail.state.poses[::step], low, high)
        best = to_cube(detail.state.best[None], low, high)[0]
        self._trail = [*self._trail[-TRAIL_LENGTH + 1 :], cube[:TRAILS]]
        glide = {"glide": f"{detail.index}", "n3": True}
        shadows = cube.copy(), cube.copy(), cube.copy()  # on the floor, behind, at the side
        shadows[0][:, 1], shadows[1][:, 2], shadows[2][:, 0] = -1, -1, 1
        flat = [cloud(shadow, palette.margin, r=1.4, alpha=0.28, **glide) for shadow in shadows]
        self._messages.layer("floor", flat)
        if len(self._trail) > 1:
            trails = np.stack(self._trail, axis=1)  # (particles, times, 3)
            self._messages.layer("trail", [path(line, palette.particle, alpha=0.35, w=1) for line in trails])
        self._messages.layer("swarm", [cloud(cube, palette.particle, r=3, alpha=0.9, **glide)])
        x, y, z = best.tolist()
        feet = [x, -1, z], [x, y, -1], [1, y, z]
        legs = [path(np.array([best, foot]), palette.best, w=1, d=[2, 3]) for foot in feet]
        diamond = mark("diamond", best, palette.best, r=7, rim="#ffffff", t="swarm best")
        self._messages.layer("best", [*legs, diamond])

    @staticmethod
    def _frame(detail: RefineDetail, palette: Palette) -> list[Item]:
        low, high = (edge * (1, 1, 180 / pi) for edge in (detail.box.low, detail.box.high))
        items: list[Item] = []
        for axis, corner in product(range(3), product((-1.0, 1.0), repeat=3)):
            if corner[axis] < 0:
                ends = np.array([corner, corner])
                ends[1, axis] = 1
                items.append(path(ends, palette.margin, w=1, d=[5, 4]))
        names = ("x", "y") if np.any(detail.box.pivot) else ("Δx", "Δy")

        def text(at: list[float], words: str, **more: object) -> Item:
            return mark("none", np.array(at), palette.text, r=0, t=words, size=12, **more)

        items += [
            text([-1, -1, 1], f"{low[0]:.2f}", align="center", dy=16, dx=0),
            text([1, -1, 1], f"{high[0]:.2f}", align="center", dy=16, dx=0),
            text([0, -1, 1], f"{names[0]} (m)", align="center", dy=26, dx=0),
            text([1, -1, 1], f"{low[1]:.2f}", dx=14, dy=2),
            text([1, -1, -1], f"{high[1]:.2f}", dx=10, dy=6),
            text([1, -1, 0], f"{names[1]} (m)", dx=22, dy=12),
            text([-1, -1, 1], f"{low[2]:.1f}", align="right", dx=-8, dy=-4),
            text([-1, 1, 1], f"{high[2]:.1f}", align="right", dx=-8, dy=0),
            text([-1, 0, 1], "Δθ (°)", align="right", dx=-12, dy=0),
        ]
        return items
