"""Where the maps of a fleet lie in the scene: those that are placed as they were found, the others beside."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import sqrt

import numpy as np

from algorithms.common.pose import FloatArray, Pose2
from algorithms.maps.grid_map import GridMap
from app.drawing.scene_layout import GAP, Rect, known_corners, rect_of, union

Group = Mapping[str, Pose2]
"""Robots that lie together: T_root_robot of each."""


@dataclass(frozen=True, eq=False)
class FleetLayout:
    """The scene's coordinates: metres, the first group's axes, the middle of its root's map at zero.

    anchors : by name, the (2,) point of a robot's frame that is its map's middle
    poses   : T_scene_robot by name
    boxes   : of each group the rectangle around what is known of its maps; scene
    """

    anchors: Mapping[str, FloatArray]
    poses: Mapping[str, Pose2]
    boxes: tuple[Rect, ...]

    def at(self, name: str) -> Pose2:
        """Where the middle of a robot's map lies, and the map's turn; scene."""
        x, y = self.poses[name].apply(self.anchors[name]).tolist()
        return Pose2(x, y, self.poses[name].theta)

    @property
    def extent(self) -> Rect:
        """All of it."""
        return union(*self.boxes)


def lay_out_fleet(maps: Mapping[str, GridMap], groups: Sequence[Group], aspect: float = 0.9) -> FleetLayout:
    """Groups in rows, the first at the top left, about ``aspect`` as wide as high."""
    corners = {name: known_corners(grid) for name, grid in maps.items()}
    anchors = {name: np.asarray(points.mean(axis=0), dtype=np.float64) for name, points in corners.items()}
    rects = [
        rect_of(np.concatenate([T.apply(corners[name]) for name, T in group.items()])) for group in groups
    ]
    sizes = [(x1 - x0, y1 - y0) for x0, y0, x1, y1 in rects]
    gap = GAP * max(max(size) for size in sizes)
    area = sum((wide + gap) * (high + gap) for wide, high in sizes)
    most = max(max(wide for wide, _ in sizes), sqrt(area * aspect))
    poses: dict[str, Pose2] = {}
    boxes: list[Rect] = []
    x = y = row = 0.0
    for group, (x0, y0, _, y1), (wide, high) in zip(groups, rects, sizes, strict=True):
        if x > 0 and x + wide > most:
            x, y, row = 0.0, y - row - gap, 0.0
        shift = Pose2(x - x0, y - y1)
        poses |= {name: shift @ T for name, T in group.items()}
        boxes.append((x, y - (y1 - y0), x + wide, y))
        x, row = x + wide + gap, max(row, high)
    root = next(iter(groups[0]))
    zero = poses[root].apply(anchors[root])
    back = Pose2(-float(zero[0]), -float(zero[1]))
    dx, dy = back.x, back.y
    moved = tuple((a + dx, b + dy, c + dx, d + dy) for a, b, c, d in boxes)
    return FleetLayout(anchors, {name: back @ T for name, T in poses.items()}, moved)
