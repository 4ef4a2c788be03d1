"""The walls of a raster as straight faces: the stairs of its cells go, corners stay."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from algorithms.common.parallel_kernels import kernel
from algorithms.common.pose import FloatArray
from algorithms.simulator.buildings.floor_plan import Surface

STAIR = 1.5  # cells; what a straight line may leave out: the stairs of a slanted wall
Edges = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class WallFaces:
    """Faces that stand from floor to ceiling.

    ends : (N, 4) x0, y0, x1, y1 from left to right as one sees who looks at the face; metres, world frame
    kind : (N,) WALL or DARK
    """

    ends: FloatArray
    kind: NDArray[np.uint8]

    def __len__(self) -> int:
        return len(self.ends)

    def lengths(self) -> FloatArray:
        """(N,) metres."""
        dx, dy = (self.ends[:, 2:] - self.ends[:, :2]).T
        return np.asarray(np.sqrt(dx * dx + dy * dy))

    def normals(self) -> FloatArray:
        """(N, 2) unit vectors from the faces into the air."""
        dx, dy = (self.ends[:, 2:] - self.ends[:, :2]).T
        return np.asarray(np.stack([dy, -dx], axis=1) / np.maximum(self.lengths(), 1e-9)[:, None])


@kernel
def _trace(surface: Surface) -> Edges:
    """Follow the edges between solid cells and air, solid to the left, loop after loop.

    returns : (N, 4) column and row of the corner that each edge starts at, its cell's kind, and 1 where a
              loop begins
    """
    height, width = surface.shape
    across, up = (1, 0, -1, 0), (0, 1, 0, -1)  # along the lower, right, upper and left side of a cell
    corner_x, corner_y = (0, 1, 1, 0), (0, 0, 1, 1)
    seen = np.zeros((height, width, 4), dtype=np.uint8)
    found = np.empty((max(1, 4 * int((surface != 0).sum())), 4), dtype=np.int64)
    n = 0
    for first_row in range(height):
        for first_col in range(width):
            if surface[first_row, first_col] == 0:
                continue
            for first_side in range(4):
                out_row, out_col = (
                    first_row - up[(first_side + 1) % 4],
                    first_col - across[(first_side + 1) % 4],
                )
                inside = 0 <= out_row < height and 0 <= out_col < width
                if seen[first_row, first_col, first_side] or (inside and surface[out_row, out_col] != 0):
                    continue
                row, col, side, begins = first_row, first_col, first_side, 1
                while not seen[row, col, side]:
                    seen[row, col, side] = 1
                    found[n, 0], found[n, 1] = col + corner_x[side], row + corner_y[side]
                    found[n, 2], found[n, 3] = surface[row, col], begins
                    n, begins = n + 1, 0
                    ahead_row, ahead_col = row + up[side], col + across[side]
                    right = (side + 3) % 4
                    far_row, far_col = ahead_row + up[right], ahead_col + across[right]
                    ahead = 0 <= ahead_row < height and 0 <= ahead_col < width
                    far = 0 <= far_row < height and 0 <= far_col < width
                    if not ahead or surface[ahead_row, ahead_col] == 0:
                        side = (side + 1) % 4
                    elif not far or surface[far_row, far_col] == 0:
                        row, col = ahead_row, ahead_col
                    else:
                        row, col, side = far_row, far_col, right
    return np.asarray(found[:n].copy())


@kernel
def _kept(x: FloatArray, y: FloatArray, most: float) -> NDArray[np.bool_]:
    """Which points of a polyline are needed so that no other is further from it than ``most``."""
    n = len(x)
    keep = np.zeros(n, dtype=np.bool_)
    keep[0] = keep[n - 1] = True
    todo = np.empty((n + 1, 2), dtype=np.int64)
    todo[0, 0], todo[0, 1] = 0, n - 1
    waiting = 1
    while waiting > 0:
        waiting -= 1
        first, last = todo[waiting, 0], todo[waiting, 1]
        dx, dy = x[last] - x[first], y[last] - y[first]
        length = np.sqrt(dx * dx + dy * dy)
        worst, at = most, -1
        for k in range(first + 1, last):
            ex, ey = x[k] - x[first], y[k] - y[first]
            off = abs(ex * dy - ey * dx) / length if length > 0 else np.sqrt(ex * ex + ey * ey)
            if off > worst:
                worst, at = off, k
        if at >= 0:
            keep[at] = True
            todo[waiting, 0], todo[waiting, 1] = first, at
            todo[waiting + 1, 0], todo[waiting + 1, 1] = at, last
            waiting += 2
    return keep


def wall_faces(surface: Surface, resolution: float) -> WallFaces:
    """The faces of all solid cells of a raster; metres per cell."""
    edges = _trace(surface)
    starts = np.flatnonzero(edges[:, 3]).tolist()
    ends: list[FloatArray] = []
    kinds: list[NDArray[np.uint8]] = []
    for first, last in zip(starts, [*starts[1:], len(edges)], strict=True):
        loop = edges[first:last, :3]
        turns = np.flatnonzero(loop[:, 2] != np.roll(loop[:, 2], 1))
        # begun where the material changes, or else at the lowest corner at the left, which is one
        begin = int(turns[0]) if len(turns) else int(np.lexsort((loop[:, 1], loop[:, 0]))[0])
        loop = np.roll(loop, -begin, axis=0)
        cuts = [0, *(np.flatnonzero(np.diff(loop[:, 2])) + 1).tolist(), len(loop)]
        closed = np.concatenate([loop, loop[:1]])
        for a, b in pairwise(cuts):
            run = closed[a : b + 1, :2].astype(np.float64)
            corners = run[_kept(run[:, 0], run[:, 1], STAIR)] * resolution
            ends.append(np.concatenate([corners[:-1], corners[1:]], axis=1))
            kinds.append(np.full(len(corners) - 1, loop[a, 2], dtype=np.uint8))
    if not ends:
        return WallFaces(np.zeros((0, 4)), np.zeros(0, dtype=np.uint8))
    return WallFaces(np.concatenate(ends), np.concatenate(kinds))
