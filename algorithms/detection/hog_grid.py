"""Histograms of oriented gradients (HOG) of a whole image, and the windows that are cut out of them."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from algorithms.common.pose import FloatArray
from algorithms.detection.detection import Picture

ORIENTATIONS = 9  # of gradients, over half a turn
BLOCK = 2  # cells a side that are normalised together
NUMBERS = BLOCK * BLOCK * ORIENTATIONS  # of one block

Features = NDArray[np.float32]


@dataclass(frozen=True)
class WindowShape:
    """The window that is slid over an image.

    rows, cols : of cells
    cell       : side of a cell; pixels
    border     : cells around the robot on each side that belong to the window
    """

    rows: int
    cols: int
    cell: int
    border: float = 0.5

    @property
    def blocks(self) -> tuple[int, int]:
        """Rows and columns of blocks, which overlap by all but one cell."""
        return self.rows - BLOCK + 1, self.cols - BLOCK + 1

    @property
    def length(self) -> int:
        """Numbers of one window."""
        rows, cols = self.blocks
        return rows * cols * NUMBERS

    @property
    def body(self) -> tuple[float, float]:
        """Height and width of the robot in its window; pixels."""
        return (self.rows - 2 * self.border) * self.cell, (self.cols - 2 * self.border) * self.cell


def grey(picture: Picture) -> NDArray[np.float32]:
    """(H, W) brightness 0 … 1 of a picture; dark images are brought out, as gradients of roots are."""
    return np.asarray(np.sqrt(cv2.cvtColor(picture, cv2.COLOR_RGB2GRAY) / np.float32(255)), np.float32)


def hog_grid(image: NDArray[np.float32], cell: int) -> Features:
    """HOG of an image, (R, C, 36): one row of numbers per block of cells, normalised (L2-Hys)."""
    from skimage.feature import hog  # only where images are looked at: it takes a while to load

    blocks = hog(image, ORIENTATIONS, (cell, cell), (BLOCK, BLOCK), block_norm="L2-Hys", feature_vector=False)
    return np.asarray(blocks, dtype=np.float32).reshape(*blocks.shape[:2], NUMBERS)


def scores(grid: Features, shape: WindowShape, weights: Features) -> Features:
    """What a linear classifier gives every window of a grid: (R', C', classes).

    weights : (classes, shape.length)
    """
    rows, cols = shape.blocks
    down, across = grid.shape[0] - rows + 1, grid.shape[1] - cols + 1
    total = np.zeros((max(down, 0), max(across, 0), len(weights)), dtype=np.float32)
    if not total.size:
        return total
    of_block = weights.reshape(len(weights), rows, cols, NUMBERS)
    for i in range(rows):
        for j in range(cols):
            total += grid[i : i + down, j : j + across] @ of_block[:, i, j].T
    return total


def window_features(image: NDArray[np.float32], box: FloatArray, shape: WindowShape) -> Features:
    """(shape.length,) of one window: the robot's box, scaled to the window with its border and one cell of
    what lies around, so that its cells come out as they do in a whole image.

    box : (4,) left, top, right, bottom of the robot; pixels
    """
    high, wide = shape.body
    scale_y, scale_x = (box[3] - box[1]) / high, (box[2] - box[0]) / wide
    around = (shape.border + 1) * shape.cell
    top, left = box[1] - around * scale_y, box[0] - around * scale_x
    size = ((shape.cols + 2) * shape.cell, (shape.rows + 2) * shape.cell)
    matrix = np.array([[scale_x, 0.0, left], [0.0, scale_y, top]])
    if max(scale_x, scale_y) > 1:  # as the image pyramid has it: no finer detail than a pixel of the window
        sigma = 0.4 * max(scale_x, scale_y)
        blurred = cv2.GaussianBlur(image, (0, 0), sigma, borderType=cv2.BORDER_REPLICATE)
        image = np.asarray(blurred, np.float32)
    flags = cv2.INTER_LINEAR | cv2.WARP_INVERSE_MAP
    part = cv2.warpAffine(image, matrix, size, flags=flags, borderMode=cv2.BORDER_REPLICATE)
    return hog_grid(np.asarray(part, np.float32), shape.cell)[1:-1, 1:-1].reshape(-1)
