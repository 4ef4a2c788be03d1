"""Where the points lie that a camera sees: on which face, where on it, and which way that looks."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from algorithms.common.parallel_kernels import kernel
from algorithms.common.pose import FloatArray
from algorithms.simulator.views.interiors.wall_outlines import WallFaces
from algorithms.simulator.views.rendering.ray_casting import Hits, Index, Viewpoint
from algorithms.simulator.views.solids import SolidTable
from algorithms.simulator.views.surfaces.noise import Tones

QUARTER = 1.5708  # radians
# of what ``_locate`` fills per point
U, V, WIDTH, HEIGHT, X, Y, Z, NORMAL_X, NORMAL_Y, NORMAL_Z, GRAIN = range(11)


@dataclass(frozen=True, eq=False)
class SeenPoints:
    """(n,) arrays of points; metres, world frame.

    u, v, width, height, grain : as in ``FacePoints``
    x, y, z    : where they lie
    normal     : (3, n) unit vectors
    """

    u: Tones
    v: Tones
    width: Tones
    height: Tones
    grain: Tones
    x: Tones
    y: Tones
    z: Tones
    normal: Tones


@kernel
def _on_box(
    qx: float, qy: float, half_x: float, half_y: float, face: int
) -> tuple[float, float, float, float]:
    """From the left edge, the width of the face, and its normal in the box's frame (level part)."""
    if face == 0:
        return qy + half_y, 2 * half_y, 1.0, 0.0
    if face == 1:
        return half_y - qy, 2 * half_y, -1.0, 0.0
    if face == 2:
        return half_x - qx, 2 * half_x, 0.0, 1.0
    if face == 3:
        return qx + half_x, 2 * half_x, 0.0, -1.0
    return half_y - qy, 2 * half_y, 0.0, 0.0


@kernel
def _around(qx: float, qy: float, half_x: float, half_y: float) -> tuple[float, float, float, float]:
    """The same of a drum's mantle; round it goes by a diamond's angle, which needs no arctangent."""
    px, py = qx / half_x, qy / half_y
    share = py / (abs(px) + abs(py) + 1e-12)
    turn = share if px >= 0 else (2.0 - share if py >= 0 else -2.0 - share)
    nx, ny = px / half_x, py / half_y
    length = np.sqrt(nx * nx + ny * ny) + 1e-12
    return (turn + 2.0) * 1.5708 * half_x, 6.2832 * half_x, nx / length, ny / length


@kernel
def _locate(
    a: FloatArray, b: FloatArray, depth: FloatArray, surface: Index, face: Index, eye: FloatArray,
    ends: FloatArray, place: FloatArray, shape: Index, ceiling: float, focal: float, out: Tones,
) -> None:  # fmt: skip
    """Fill out, (11, n). eye : camera x, y, height, forward x, y, right x, y."""
    for i in range(len(a)):
        t = depth[i]
        dx, dy, dz = eye[3] + a[i] * eye[5], eye[4] + a[i] * eye[6], -b[i]
        x, y, z = eye[0] + t * dx, eye[1] + t * dy, eye[2] + t * dz
        u, v, width, height, nx, ny, nz = x, y, 1.0, 1.0, 0.0, 0.0, 1.0
        n = surface[i]
        if n == -2:
            nz = -1.0
        elif 0 <= n < len(ends):
            ex, ey = ends[n, 2] - ends[n, 0], ends[n, 3] - ends[n, 1]
            width = np.sqrt(ex * ex + ey * ey)
            u = ((x - ends[n, 0]) * ex + (y - ends[n, 1]) * ey) / width
            v, height = z, ceiling
            nx, ny, nz = ey / width, -ex / width, 0.0
        elif n >= len(ends):
            k = n - len(ends)
            c, s, half_x, half_y = place[k, 2], place[k, 3], place[k, 4], place[k, 5]
            qx, qy = (
                c * (x - place[k, 0]) + s * (y - place[k, 1]),
                c * (y - place[k, 1]) - s * (x - place[k, 0]),
            )
            v, height, nz = z - place[k, 6], place[k, 7] - place[k, 6], 0.0
            if shape[k] == 2:
                u, width = qy + half_y, 2 * half_y
                mx, my, mz = qx / half_x**2, qy / half_y**2, (v - height / 2) * 4 / height**2
                length = np.sqrt(mx * mx + my * my + mz * mz) + 1e-12
                mx, my, nz = mx / length, my / length, mz / length
            elif face[i] >= 4:
                u, v, width, height = half_y - qy, qx + half_x, 2 * half_y, 2 * half_x
                mx, my, nz = 0.0, 0.0, (1.0 if face[i] == 4 else -1.0)
            elif shape[k] == 1:
                u, width, mx, my = _around(qx, qy, half_x, half_y)
            else:
                u, width, mx, my = _on_box(qx, qy, half_x, half_y, face[i])
            nx, ny = c * mx - s * my, s * mx + c * my
        facing = abs(nx * dx + ny * dy + nz * dz) / np.sqrt(1.0 + a[i] * a[i] + b[i] * b[i])
        out[0, i], out[1, i], out[2, i], out[3, i], out[4, i], out[5, i] = u, v, width, height, x, y
        out[6, i], out[7, i], out[8, i], out[9, i] = z, nx, ny, nz
        out[10, i] = t / (focal * max(facing, 0.04))


def seen_points(
    view: Viewpoint,
    walls: WallFaces,
    solids: SolidTable,
    ceiling: float,
    a: FloatArray,
    b: FloatArray,
    hits: Hits,
    focal: float,
) -> SeenPoints:
    """What rays hit.

    a, b  : (n,) the rays
    focal : pixels per metre one metre ahead
    """
    out = np.empty((11, len(a)), dtype=np.float32)
    eye = np.array([view.x, view.y, view.height, *view.forward.tolist(), *view.right.tolist()])
    face = hits.face.astype(np.int32)
    _locate(
        np.ascontiguousarray(a), np.ascontiguousarray(b), hits.depth, hits.surface, face, eye, walls.ends,
        solids.place, solids.shape, ceiling, focal, out,
    )  # fmt: skip
    return SeenPoints(
        out[U],
        out[V],
        out[WIDTH],
        out[HEIGHT],
        out[GRAIN],
        out[X],
        out[Y],
        out[Z],
        out[NORMAL_X : NORMAL_Z + 1],
    )
