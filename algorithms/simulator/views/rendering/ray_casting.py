"""What rays of a camera meet first: walls by slope, then solids, floor and ceiling by height.

A ray goes ``forward + a · right − b · up``: a and b are the camera's plane one metre ahead, to the right and
down, and what grows along the ray is depth. A wall's reciprocal depth is linear in a: no angle is needed.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from algorithms.common.parallel_kernels import kernel
from algorithms.common.pose import FloatArray
from algorithms.simulator.portable_random import cosine, sine
from algorithms.simulator.views.interiors.wall_outlines import WallFaces
from algorithms.simulator.views.rendering.solid_hits import box_hit, drum_hit, egg_hit
from algorithms.simulator.views.solids import SolidTable

FLOOR, CEILING = -1, -2
NEAR = 0.03  # metres; what is nearer than that is not seen
FAR = 200.0  # metres; where no wall is
BINS = 4096  # of slope over the width of an image, for telling which wall a ray meets
PARTS = 128  # of those slopes, each with its own list of solids
BEHIND_ALL = 1e9

Index = NDArray[np.int32]


@dataclass(frozen=True, eq=False)
class Viewpoint:
    """Where rays start and how they go; metres, world frame.

    x, y, height   : of the camera
    forward, right : (2,) unit vectors; of a camera that is seen in a mirror ``right`` lies to its left
    """

    x: float
    y: float
    height: float
    forward: FloatArray
    right: FloatArray

    @staticmethod
    def looking(x: float, y: float, height: float, ticks: int) -> Viewpoint:
        c, s = float(cosine(ticks)), float(sine(ticks))
        return Viewpoint(x, y, height, np.array([c, s]), np.array([s, -c]))

    def reflected(self, x: float, y: float, normal: FloatArray) -> Viewpoint:
        """As it is seen in a mirror through (x, y) with a unit vector across."""
        nx, ny = normal.tolist()
        off = 2 * ((self.x - x) * nx + (self.y - y) * ny)
        forward, right = (
            way - 2 * (way[0] * nx + way[1] * ny) * normal for way in (self.forward, self.right)
        )
        return Viewpoint(self.x - off * nx, self.y - off * ny, self.height, forward, right)

    def seen_from(self, points: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Depth and distance to the right of (…, 2) points; metres."""
        x, y = points[..., 0] - self.x, points[..., 1] - self.y
        (fx, fy), (rx, ry) = self.forward.tolist(), self.right.tolist()
        return x * fx + y * fy, x * rx + y * ry


@dataclass(frozen=True, eq=False)
class Hits:
    """What (n,) rays met first.

    depth   : along the camera's axis; metres
    surface : FLOOR, CEILING, a wall's number, or the number of walls + a solid's
    face    : of a solid, FRONT … BOTTOM
    """

    depth: FloatArray
    surface: Index
    face: NDArray[np.int8]


@kernel
def _fill_bins(
    low: FloatArray, high: FloatArray, at_0: FloatArray, per_slope: FloatArray, first: float, step: float,
    behind: FloatArray, which: Index,
) -> None:  # fmt: skip
    """Put into each bin of slope the wall with the greatest reciprocal depth that is not before a mirror.

    low, high       : (N,) slopes between which a wall is seen
    at_0, per_slope : (N,) its reciprocal depth; 1 / metres
    behind          : (BINS,) reciprocal depth of the mirror
    """
    best = np.zeros(len(which))
    for n in range(len(low)):
        begin = max(0, int(np.ceil((low[n] - first) / step - 0.5)))
        end = min(len(which) - 1, int(np.floor((high[n] - first) / step - 0.5)))
        for k in range(begin, end + 1):
            inverse = at_0[n] + per_slope[n] * (first + (k + 0.5) * step)
            if best[k] < inverse < behind[k]:
                best[k] = inverse
                which[k] = n


@kernel
def _nearest(
    a: FloatArray, b: FloatArray, behind: FloatArray, h: float, ceiling: float,
    bins: Index, first: float, step: float, at_0: FloatArray, per_slope: FloatArray,
    rows: FloatArray, shape: Index, number: Index, starts: Index, listed: Index,
    depth: FloatArray, surface: Index, face: NDArray[np.int8],
) -> None:  # fmt: skip
    """Fill what ``Hits`` holds.

    rows           : (K, 15) solids, see ``_candidates``
    starts, listed : which of them are seen in each part of the slopes, in order of their least depth
    """
    bins_per_part = len(bins) // (len(starts) - 1)
    for i in range(len(a)):
        k = min(len(bins) - 1, max(0, int((a[i] - first) / step)))
        depth[i], surface[i], face[i] = 200.0, -2, 0
        if bins[k] >= 0:
            inverse = at_0[bins[k]] + per_slope[bins[k]] * a[i]
            if inverse > 0.005:
                depth[i], surface[i] = 1.0 / inverse, bins[k]
        if b[i] > 0 and h / b[i] < depth[i]:
            depth[i], surface[i] = h / b[i], -1
        elif b[i] < 0 and (h - ceiling) / b[i] < depth[i]:
            depth[i], surface[i] = (h - ceiling) / b[i], -2
        part = k // bins_per_part
        for m in range(starts[part], starts[part + 1]):
            n = listed[m]
            if rows[n, 0] > depth[i]:
                break
            if a[i] < rows[n, 1] or a[i] > rows[n, 2] or b[i] < rows[n, 3] or b[i] > rows[n, 4]:
                continue
            dx, dy = rows[n, 7] + a[i] * rows[n, 9], rows[n, 8] + a[i] * rows[n, 10]
            ox, oy, half_x, half_y = rows[n, 5], rows[n, 6], rows[n, 11], rows[n, 12]
            if shape[n] == 0:
                t, side = box_hit(ox, oy, dx, dy, -b[i], h, half_x, half_y, rows[n, 13], rows[n, 14])
            elif shape[n] == 1:
                t, side = drum_hit(ox, oy, dx, dy, -b[i], h, half_x, half_y, rows[n, 13], rows[n, 14])
            else:
                t, side = egg_hit(ox, oy, dx, dy, -b[i], h, half_x, half_y, rows[n, 13], rows[n, 14])
            if behind[i] < t < depth[i]:
                depth[i], surface[i], face[i] = t, number[n], side


class RayCaster:
    """Casts rays from one viewpoint at walls and solids.

    view          : from where
    walls, solids : what there is
    ceiling       : its height; metres
    slopes        : least and greatest a of all rays
    mirror        : (4,) x0, y0, x1, y1 of the mirror that ``view`` is seen in; nothing before it counts
    """

    def __init__(
        self,
        view: Viewpoint,
        walls: WallFaces,
        solids: SolidTable,
        ceiling: float,
        slopes: tuple[float, float],
        mirror: FloatArray | None = None,
    ) -> None:
        self.view, self.ceiling = view, ceiling
        self._walls, self._solids = walls, solids
        self._first, self._step = slopes[0], max(1e-6, (slopes[1] - slopes[0]) / BINS)
        behind = np.full(BINS, BEHIND_ALL)
        if mirror is not None:
            at_0, per_slope, _, _ = self._reciprocal(mirror[None])
            middles = self._first + (np.arange(BINS) + 0.5) * self._step
            behind = np.maximum(at_0[0] + per_slope[0] * middles, 1e-9) * (1 - 1e-9)
        self._at_0, self._per_slope, low, high = self._reciprocal(walls.ends)
        self._bins: Index = np.full(BINS, -1, dtype=np.int32)
        _fill_bins(low, high, self._at_0, self._per_slope, self._first, self._step, behind, self._bins)
        self._candidates = self._solids_seen()

    def cast(self, a: FloatArray, b: FloatArray, behind: FloatArray | float = NEAR) -> Hits:
        """What rays meet first.

        a, b   : (n,) where they cross the plane one metre ahead, to the right and down
        behind : depth that a solid must have at least; metres
        """
        n = len(a)
        hits = Hits(np.empty(n), np.empty(n, dtype=np.int32), np.empty(n, dtype=np.int8))
        least = np.broadcast_to(np.asarray(behind, dtype=np.float64), (n,)).copy()
        _nearest(
            np.ascontiguousarray(a), np.ascontiguousarray(b), least, self.view.height, self.ceiling,
            self._bins, self._first, self._step, self._at_0, self._per_slope,
            *self._candidates, hits.depth, hits.surface, hits.face,
        )  # fmt: skip
        return hits

    def _reciprocal(self, ends: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
        """Reciprocal depth of faces at slope 0 and per slope, and the slopes between which they are seen."""
        z0, r0 = self.view.seen_from(ends[:, :2])
        z1, r1 = self.view.seen_from(ends[:, 2:])
        across = z0 * r1 - z1 * r0  # twice the area of the triangle with the camera
        safe = np.where(across == 0, 1.0, across)
        at_0, per_slope = (r1 - r0) / safe, (z0 - z1) / safe
        before = (z0 > NEAR) | (z1 > NEAR)
        beside = np.where(across > 0, -BEHIND_ALL, BEHIND_ALL)  # where the left end is not before the camera
        slope_0 = np.where(z0 > NEAR, r0 / np.maximum(z0, NEAR), beside)
        slope_1 = np.where(z1 > NEAR, r1 / np.maximum(z1, NEAR), -beside)
        seen = before & (across != 0)
        low = np.where(seen, np.minimum(slope_0, slope_1), BEHIND_ALL)
        return at_0, per_slope, low, np.where(seen, np.maximum(slope_0, slope_1), -BEHIND_ALL)

    def _solids_seen(self) -> tuple[FloatArray, Index, Index, Index, Index]:
        """Solids that may be seen, as ``_nearest`` wants them: rows, shape, number, starts, listed.

        rows : least depth; slopes a from … to, b from … to; camera, forward and right in the solid's frame;
               half depth, half width, bottom, top
        """
        place = self._solids.place
        x, y, c, s, half_x, half_y, bottom, top = place.T
        signs = np.array([[1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0]])
        along, across = signs[:, :1] * half_x, signs[:, 1:] * half_y
        corners = np.stack([x + c * along - s * across, y + s * along + c * across], axis=-1)  # (4, K, 2)
        z, r = self.view.seen_from(corners)
        near, far = z.min(axis=0), z.max(axis=0)
        slopes = r / np.maximum(z, NEAR)
        whole = near > NEAR
        a_low = np.where(whole, slopes.min(axis=0), -BEHIND_ALL)
        a_high = np.where(whole, slopes.max(axis=0), BEHIND_ALL)
        nearest, h = np.maximum(near, NEAR), self.view.height
        b_low = np.minimum((h - top) / nearest, (h - top) / np.maximum(far, NEAR))
        b_high = np.maximum((h - bottom) / nearest, (h - bottom) / np.maximum(far, NEAR))
        dx, dy = self.view.x - x, self.view.y - y
        (fx, fy), (rx, ry) = self.view.forward.tolist(), self.view.right.tolist()
        rows = np.stack(
            [
                nearest, a_low, a_high, b_low, b_high, c * dx + s * dy, c * dy - s * dx,
                c * fx + s * fy, c * fy - s * fx, c * rx + s * ry, c * ry - s * rx,
                half_x, half_y, bottom, top,
            ],
            axis=1,
        )  # fmt: skip
        within = self._parts(z, r)
        seen = np.flatnonzero(within.any(axis=0))
        order = seen[np.argsort(nearest[seen], kind="stable")]
        part, listed = np.nonzero(within[:, order])
        starts = np.searchsorted(part, np.arange(PARTS + 1))
        number = order + len(self._walls)
        shape = self._solids.shape[order]
        return (
            np.ascontiguousarray(rows[order]), shape, number.astype(np.int32),
            starts.astype(np.int32), listed.astype(np.int32),
        )  # fmt: skip

    def _parts(self, z: FloatArray, r: FloatArray) -> NDArray[np.bool_]:
        """(PARTS, K) in which parts of the slopes solids may be seen, nearer than the furthest wall.

        z, r : (4, K) depth and distance to the right of their corners
        """
        middles = self._first + (np.arange(BINS) + 0.5) * self._step
        at_0, per_slope = np.append(self._at_0, 1 / FAR), np.append(self._per_slope, 0.0)  # −1: no wall
        inverse = at_0[self._bins] + per_slope[self._bins] * middles
        furthest = 1 / np.maximum(inverse.reshape(PARTS, -1).min(axis=1), 1 / FAR)
        edges = self._first + np.arange(PARTS + 1) * (self._step * (BINS // PARTS))
        within = np.zeros((PARTS, z.shape[1]), dtype=bool)
        ahead = np.flatnonzero(
            (z.max(axis=0) > NEAR)
            & ((r - edges[0] * z).max(axis=0) >= 0)
            & ((r - edges[-1] * z).min(axis=0) <= 0)
        )
        z, r = z[:, ahead], r[:, ahead]
        off = r - edges[:, None, None] * z  # (PARTS + 1, 4, K) to the right of the edges of the parts
        left_of, right_of = off.max(axis=1) < 0, off.min(axis=1) > 0
        nearer = z.min(axis=0) < furthest[:, None]
        within[:, ahead] = ~left_of[:-1] & ~right_of[1:] & nearer
        return within
