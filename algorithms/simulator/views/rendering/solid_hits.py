"""Where a ray enters a box, a drum or an egg, in the solid's own frame.

Of each: ox, oy, h is where the ray starts, dx, dy, dz its way per metre of depth.
"""

from __future__ import annotations

import numpy as np

from algorithms.common.parallel_kernels import kernel


@kernel
def box_hit(ox: float, oy: float, dx: float, dy: float, dz: float, h: float, half_x: float, half_y: float,
         bottom: float, top: float) -> tuple[float, int]:  # fmt: skip
    """Depth at which a ray enters a box in the box's own frame, and by which face; −1 where it does not."""
    enter, leave, face = -1e30, 1e30, 0
    for axis in range(3):
        origin, way = (ox, dx) if axis == 0 else ((oy, dy) if axis == 1 else (h, dz))
        low, high = (-half_x, half_x) if axis == 0 else ((-half_y, half_y) if axis == 1 else (bottom, top))
        if way == 0.0:
            if origin < low or origin > high:
                return -1.0, 0
            continue
        near, far = (low - origin) / way, (high - origin) / way
        towards_high = near > far
        if towards_high:
            near, far = far, near
        if near > enter:
            enter = near
            face = 2 * axis + (0 if towards_high else 1)
        leave = min(leave, far)
    return (enter, face) if enter <= leave else (-1.0, 0)


@kernel
def drum_hit(ox: float, oy: float, dx: float, dy: float, dz: float, h: float, half_x: float, half_y: float,
          bottom: float, top: float) -> tuple[float, int]:  # fmt: skip
    """The same of a drum; its mantle counts as front."""
    px, py, qx, qy = ox / half_x, oy / half_y, dx / half_x, dy / half_y
    a, b, c = qx * qx + qy * qy, px * qx + py * qy, px * px + py * py - 1.0
    inside = b * b - a * c
    if inside <= 0.0:
        return -1.0, 0
    root = np.sqrt(inside)
    enter, leave, face = (-b - root) / a, (-b + root) / a, 0
    if dz != 0.0:
        near, far = (bottom - h) / dz, (top - h) / dz
        cap = 5
        if near > far:
            near, far, cap = far, near, 4
        if near > enter:
            enter, face = near, cap
        leave = min(leave, far)
    elif h < bottom or h > top:
        return -1.0, 0
    return (enter, face) if enter <= leave else (-1.0, 0)


@kernel
def egg_hit(ox: float, oy: float, dx: float, dy: float, dz: float, h: float, half_x: float, half_y: float,
         bottom: float, top: float) -> tuple[float, int]:  # fmt: skip
    """The same of an egg, which is front all over."""
    half_z = (top - bottom) / 2
    px, py, pz = ox / half_x, oy / half_y, (h - (bottom + top) / 2) / half_z
    qx, qy, qz = dx / half_x, dy / half_y, dz / half_z
    a, b, c = qx * qx + qy * qy + qz * qz, px * qx + py * qy + pz * qz, px * px + py * py + pz * pz - 1.0
    inside = b * b - a * c
    return ((-b - np.sqrt(inside)) / a, 0) if inside > 0.0 else (-1.0, 0)
