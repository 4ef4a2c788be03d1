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
MOST_OF_BLOCK = 0.2  # that one number may be of a block, so that a single strong edge is not all
EPS = 1e-5  # keeps what is even from being divided by 0
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
    """HOG of an image, (R, C, 36): one row of numbers per block of cells, normalised (L2-Hys).

    The numbers of scikit-image's ``hog``, which normalises block by block: it would take most of the time.
    """
    cells = _histograms(image, cell)
    around = (cells[:-1, :-1], cells[:-1, 1:], cells[1:, :-1], cells[1:, 1:])
    blocks = _of_length_1(np.concatenate(around, axis=2))
    return _of_length_1(np.minimum(blocks, MOST_OF_BLOCK))


def _histograms(image: NDArray[np.float32], cell: int) -> Features:
    """(R, C, 9) how much gradient each cell has in each direction, on average of its pixels."""
    right, down = np.zeros_like(image), np.zeros_like(image)
    right[:, 1:-1], down[1:-1] = image[:, 2:] - image[:, :-2], image[2:] - image[:-2]
    rows, cols = image.shape[0] // cell, image.shape[1] // cell
    right, down = (part[: rows * cell, : cols * cell] for part in (right, down))
    direction = np.rad2deg(np.arctan2(down, right)) % 180
    which = np.minimum((direction * (ORIENTATIONS / 180)).astype(np.intp), ORIENTATIONS - 1)
    which += ORIENTATIONS * (np.arange(cols * cell) // cell)
    which += ORIENTATIONS * cols * (np.arange(rows * cell) // cell)[:, None]
    sizes = np.hypot(right, down)
    total = np.bincount(which.ravel(), sizes.ravel(), minlength=rows * cols * ORIENTATIONS)
    return (total / cell**2).astype(np.float32).reshape(rows, cols, ORIENTATIONS)


def _of_length_1(blocks: Features) -> Features:
    """The same where the numbers of each block are a vector of length 1, or 0 where all of them are."""
    length = np.sqrt(np.einsum("rcn,rcn->rc", blocks, blocks) + EPS**2)
    return np.asarray(blocks / length[..., None], dtype=np.float32)


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
