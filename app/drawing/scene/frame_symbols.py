"""The frame of the merged map over the map, as data: its axes from its origin."""

from __future__ import annotations

import numpy as np

from algorithms.common.pose import FloatArray, Pose2
from app.drawing.draw_items import Item, mark, path
from app.drawing.palette import Palette
from app.drawing.scene_layout import SceneLayout

ARM = 0.12  # of an axis, as a share of what is seen


def axes(T_ref_frame: Pose2, layout: SceneLayout, colours: Palette, name: str) -> list[Item]:
    """Both axes of a frame, which lies so in map 1's, and its name."""
    x0, y0, x1, y1 = layout.view(Pose2())
    arm = ARM * max(x1 - x0, y1 - y0)
    at = T_ref_frame.apply(np.array([[0.0, 0.0], [arm, 0.0], [0.0, arm]])) - layout.anchor_ref
    how = {"halo": True, "align": "center", "size": 13, "dy": -10}
    return [
        path(at[[0, 1]], colours.text, w=2.6, t="x", tp=at[1], **how),
        path(at[[0, 2]], colours.text, w=1.4, t="y", tp=at[2], **how),
        mark("dot", at[0], colours.text, r=5, t=name, dy=14),
    ]


def origin(at: FloatArray, layout: SceneLayout, colours: Palette) -> list[Item]:
    """The origin of a frame whose x-axis is still to be chosen; (2,) metres, map 1's frame."""
    return [mark("cross", at - layout.anchor_ref, colours.text, r=8, t="origin", size=13)]
