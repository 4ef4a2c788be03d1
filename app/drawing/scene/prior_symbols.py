"""What is roughly known, as signs over the map: rings and wedges of two standard deviations."""

from __future__ import annotations

from math import pi

import numpy as np

from algorithms.common.pose import FloatArray, rotation
from algorithms.observations.priors import InitialPose, NearPlace, TurnPrior
from app.drawing.draw_items import Item, ellipse, mark, path
from app.drawing.palette import Palette, css
from app.drawing.scene_layout import SceneLayout

DEVIATIONS = 2.0  # that rings and wedges reach
REACH = 0.4  # of a wedge, as a share of map 2's size
FAINT = 0.14  # opacity of what a wedge or ring covers


def rough_pose(prior: InitialPose, layout: SceneLayout, colours: Palette) -> list[Item]:
    """A ring and a wedge at the point of map 2 whose error is told; they move with map 2."""
    at, turned = prior.about - layout.anchor_mov, rotation(prior.pose.theta)
    spread = turned.T @ np.diag([prior.sigma_x, prior.sigma_y]) ** 2 @ turned  # map 1's axes, in map 2's
    ring = ellipse(at, spread, DEVIATIONS)
    top = ring[int(ring[:, 1].argmax())]
    of = "middle" if prior.about.any() else "origin"
    name = {"t": f"map 2's {of}, 2 σ", "tp": top, "dy": -11, "align": "center"}
    return [
        *_wedge(at, prior.sigma_yaw, layout, colours),
        path(ring, colours.mov, "map2", w=1.6, close=True, halo=True, fill=css(colours.mov, FAINT), **name),
        mark("cross", at, colours.mov, "map2", r=5),
    ]


def rough_turn(prior: TurnPrior, layout: SceneLayout, colours: Palette) -> list[Item]:
    """A wedge around map 2's x axis, which turns with map 2."""
    return _wedge(np.zeros(2), prior.sigma, layout, colours)


def near_place(prior: NearPlace, layout: SceneLayout, colours: Palette) -> list[Item]:
    """A ring in each map."""
    items: list[Item] = []
    for number, frame, point, colour in (
        (1, "scene", np.array([prior.ref_x, prior.ref_y]) - layout.anchor_ref, colours.ref),
        (2, "map2", np.array([prior.mov_x, prior.mov_y]) - layout.anchor_mov, colours.mov),
    ):
        ring = ellipse(point, np.eye(2), prior.radius)
        items.append(path(ring, colour, frame, w=1.6, close=True, halo=True, fill=css(colour, FAINT)))
        items.append(mark("cross", point, colour, frame, r=6, t=f"here, in map {number}", size=11))
    return items


def _wedge(at: FloatArray, sigma: float, layout: SceneLayout, colours: Palette) -> list[Item]:
    """Both edges of a turn's deviations about map 2's x axis, in map 2's frame."""
    corners = layout.corners[1]
    size = 5.0 if corners is None else float(np.ptp(corners, axis=0).max())
    half = min(pi, DEVIATIONS * sigma)
    turns = np.linspace(-half, half, 33)
    rim = at + REACH * size * np.stack([np.cos(turns), np.sin(turns)], axis=1)
    axis = np.array([at, at + [REACH * size, 0.0]])
    fan, fill = np.vstack([at[None], rim]), css(colours.best, FAINT)
    name = {"t": "turn, 2 σ", "tp": rim[0], "dy": 12, "align": "center"}
    return [
        path(fan, colours.best, "map2", w=1.2, close=True, fill=fill, **name),
        path(axis, colours.best, "map2", w=1.6, d=[6, 4], halo=True),
    ]
