"""Walls that were seen, and how far from a wall a place is."""

from __future__ import annotations

import cv2
import numpy as np
from numpy.typing import NDArray

from algorithms.common.parallel_kernels import kernel
from algorithms.maps.grid_map import BoolArray, Float32Array, where

IntArray = NDArray[np.intp]


def surface(walls: BoolArray, free: BoolArray) -> BoolArray:
    """(H, W) the walls that were seen: those with a free cell beside them. A thick wall has two sides,
    not an inside.
    """
    beside = cv2.dilate(free.astype(np.uint8), np.ones((3, 3), dtype=np.uint8))
    return np.asarray(walls & (beside > 0))


def distance_to_walls(walls: BoolArray) -> Float32Array:
    """(H, W) distance of every cell's centre from the nearest wall's, in cells; large without walls."""
    if not walls.any():
        return np.full(walls.shape, 1e6, dtype=np.float32)
    distance = np.asarray(
        cv2.distanceTransform((~walls).astype(np.uint8), cv2.DIST_L2, cv2.DIST_MASK_PRECISE), dtype=np.float32
    )
    # its square is a whole number, but OpenCV's last digit depends on how many threads it has
    squared = np.multiply(distance, distance, out=distance)
    return np.sqrt(np.rint(squared, out=squared), out=squared)


def distances(reach: int) -> Float32Array:
    """(2 reach + 1, 2 reach + 1) distance from the middle, in cells: as ``distance_to_walls`` measures it."""
    along = np.arange(-reach, reach + 1)
    return np.sqrt((along[:, None] ** 2 + along**2).astype(np.float32))


def is_near_wall(walls: BoolArray, disc: BoolArray) -> BoolArray:
    """(H, W) whether there is a wall within the disc, (2 r + 1, 2 r + 1) with its middle, around a cell."""
    reach = len(disc) // 2
    near: BoolArray = walls.copy()
    down, right = np.nonzero(disc)
    _mark_near_walls(walls, *where(walls), down - reach, right - reach, near)
    return near


@kernel
def _mark_near_walls(
    walls: BoolArray, rows: IntArray, cols: IntArray, down: IntArray, right: IntArray, near: BoolArray
) -> None:
    height, width = walls.shape
    for n in range(len(rows)):
        row, col = rows[n], cols[n]
        if 0 < row < height - 1 and 0 < col < width - 1:
            above, below = walls[row + 1, col], walls[row - 1, col]
            if above and below and walls[row, col - 1] and walls[row, col + 1]:
                continue  # whatever is near this wall is nearer to one of these
        for k in range(len(down)):
            i, j = row + down[k], col + right[k]
            if 0 <= i < height and 0 <= j < width:
                near[i, j] = True
