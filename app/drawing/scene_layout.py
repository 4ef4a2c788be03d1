"""Where the two maps lie in the scene: around the meeting place, or side by side before the merge."""

from __future__ import annotations

from dataclasses import dataclass, replace

import cv2
import numpy as np

from algorithms.common.pose import FloatArray, Pose2, wrap_angle
from algorithms.maps.grid_map import UNKNOWN, GridMap
from algorithms.observations.observation import Encounter

Rect = tuple[float, float, float, float]  # x low, y low, x high, y high; metres

GAP = 0.10  # between two maps side by side, as a share of their size


def known_corners(grid: GridMap) -> FloatArray:
    """(4, 2) corners of the smallest rectangle of cells that holds all known ones; metres, map frame."""
    rows, cols = (np.flatnonzero(grid.cells.max(axis=axis) > UNKNOWN) for axis in (1, 0))
    if len(rows) == 0:
        return grid.corners()
    low, high = np.array([cols[0], rows[0]]), np.array([cols[-1] + 1, rows[-1] + 1])
    unit = np.array([[0, 0], [1, 0], [1, 1], [0, 1]], dtype=float)
    return grid.origin.apply((low + unit * (high - low)) * grid.resolution)


def known_hull(grid: GridMap) -> FloatArray:
    """(N, 2) corners of the convex hull of all known cells; metres, map frame."""
    known = grid.cells != UNKNOWN
    rows = np.flatnonzero(known.any(axis=1))
    if len(rows) == 0:
        return grid.corners()
    # the outermost cells of each row are enough
    first = known[rows].argmax(axis=1)
    last = grid.width - 1 - known[rows, ::-1].argmax(axis=1)
    ends = np.concatenate([np.stack([first, rows], axis=1), np.stack([last, rows], axis=1)])
    centres = ends.astype(np.float32) + 0.5
    return grid.origin.apply(cv2.convexHull(centres)[:, 0].astype(np.float64) * grid.resolution)


def rect_of(points: FloatArray) -> Rect:
    """Smallest upright rectangle around (N, 2) points; metres."""
    (x0, y0), (x1, y1) = points.min(axis=0).tolist(), points.max(axis=0).tolist()
    return x0, y0, x1, y1


def union(*rects: Rect) -> Rect:
    """Smallest rectangle around all of them."""
    lows, highs = np.array(rects)[:, :2].min(axis=0), np.array(rects)[:, 2:].max(axis=0)
    return (*lows.tolist(), *highs.tolist())  # type: ignore[return-value]


@dataclass(frozen=True, eq=False)
class SceneLayout:
    """The scene's coordinates: metres, map 1's axes, the meeting place (or map 1's middle) at zero.

    anchors : of each map the (2,) point of its frame that lies at the scene's origin; map 2 turns about it
    corners : (4, 2) what is known of each map, relative to its anchor; or None
    beside  : where each anchor lies while the maps are side by side, and the map's turn there (none)
    """

    anchors: tuple[FloatArray, ...]
    corners: tuple[FloatArray | None, ...] = (None, None)
    beside: tuple[Pose2, ...] = (Pose2(), Pose2())

    @property
    def anchor_ref(self) -> FloatArray:
        """(2,) anchor of map 1; metres, its frame."""
        return self.anchors[0]

    @property
    def anchor_mov(self) -> FloatArray:
        """(2,) anchor of map 2; metres, its frame."""
        return self.anchors[1]

    @property
    def apart(self) -> Pose2:
        """Where map 2's anchor lies while the maps are side by side."""
        return self.beside[1]

    def frames(self) -> list[list[float] | None]:
        """Of each map its anchor and the rectangle around what is known of it, relative to the anchor."""
        return [
            None if corners is None else [*anchor.tolist(), *rect_of(corners)]
            for anchor, corners in zip(self.anchors, self.corners, strict=True)
        ]

    def placed(self, T_ref_mov: Pose2) -> Pose2:
        """Where ``anchor_mov`` lies under a transform, and map 2's turn; scene."""
        x, y = (T_ref_mov.apply(self.anchor_mov) - self.anchor_ref).tolist()
        return Pose2(x, y, T_ref_mov.theta)

    def transform(self, at: Pose2) -> Pose2:
        """T_ref_mov that puts ``anchor_mov`` at this place of the scene: ``placed``, undone."""
        turned = Pose2(0.0, 0.0, at.theta).apply(self.anchor_mov)
        x, y = (at.xy + self.anchor_ref - turned).tolist()
        return Pose2(x, y, at.theta)

    def with_number(self, at: Pose2, field: str, value: float, of_origin: bool) -> Pose2:
        """Where map 2 lies once one of its three numbers is another, and the two others are what they were.

        at        : where ``anchor_mov`` lies; scene
        field     : x, y or theta; metres, radians, map 1
        of_origin : whether the numbers are of map 2's origin; else of ``anchor_mov``
        """
        if of_origin:
            at = self.placed(replace(self.transform(at), **{field: value}))
        elif field == "theta":
            at = replace(at, theta=value)
        else:
            at = replace(at, **{field: value - float(self.anchor_ref["xy".index(field)])})
        return replace(at, theta=wrap_angle(at.theta))

    def view(self, mov_at: Pose2 | None = None) -> Rect:
        """Rectangle that holds map 1 and map 2 with its anchor at ``mov_at`` (apart if None)."""
        places = (self.beside[0], self.apart if mov_at is None else mov_at)
        points = [at.apply(c) for at, c in zip(places, self.corners, strict=True) if c is not None]
        return rect_of(np.concatenate(points)) if points else (-5.0, -5.0, 5.0, 5.0)

    def swept(self) -> Rect:
        """Rectangle that holds map 1 and map 2 at any turn about the meeting place."""
        ref, mov = self.corners
        rects = [rect_of(ref)] if ref is not None else []
        if mov is not None:
            reach = float(np.hypot(*mov.T).max())
            rects.append((-reach, -reach, reach, reach))
        return union(*rects) if rects else self.view()


def lay_out(
    ref: GridMap | None,
    mov: GridMap | None,
    at: Encounter | None,
    aspect: float = 0.9,
    mov_anchor: FloatArray | None = None,
) -> SceneLayout:
    """Choose anchors and the place of map 2 beside map 1.

    aspect : width over height of the free part of the page; the maps lie side by side or one above
             the other, whichever shows them larger
    mov_anchor : (2,) what map 2 is to turn about where nobody was seen; metres, its frame. None: its middle
    """
    seen = (at.x_ref, at.x_mov) if at else (None, mov_anchor)
    known = [known_corners(grid) if grid else None for grid in (ref, mov)]
    anchors = tuple(_anchor(x_hat, corners) for x_hat, corners in zip(seen, known, strict=True))
    corners = tuple(c - anchor if c is not None else None for c, anchor in zip(known, anchors, strict=True))
    apart = Pose2()
    if corners[0] is not None and corners[1] is not None:
        r, m = rect_of(corners[0]), rect_of(corners[1])
        (rw, rh), (mw, mh) = (r[2] - r[0], r[3] - r[1]), (m[2] - m[0], m[3] - m[1])
        beside = max((rw + mw) * (1 + GAP) / aspect, max(rh, mh))  # height of page needed
        below = max(max(rw, mw) / aspect, (rh + mh) * (1 + GAP))
        if beside <= below:
            x = r[2] + GAP * (rw + mw) - m[0]
            apart = Pose2(x, (r[1] + r[3]) / 2 - (m[1] + m[3]) / 2)
        else:
            y = r[1] - GAP * (rh + mh) - m[3]
            apart = Pose2((r[0] + r[2]) / 2 - (m[0] + m[2]) / 2, y)
    return SceneLayout(anchors, corners, (Pose2(), apart))


def _anchor(x_hat: FloatArray | None, corners: FloatArray | None) -> FloatArray:
    if x_hat is not None:
        return x_hat
    return np.zeros(2) if corners is None else np.asarray(corners.mean(axis=0), dtype=np.float64)
