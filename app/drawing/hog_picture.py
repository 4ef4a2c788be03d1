"""The histogram of oriented gradients of an image, as the detector sees it."""

from __future__ import annotations

import cv2
import numpy as np

from algorithms.detection.detection import Detection, Picture
from algorithms.detection.hog_grid import BLOCK, ORIENTATIONS, WindowShape, grey

CELL_PIXELS = 24  # of the picture, for one cell
MARGIN_CELLS = 3  # around the box


def hog_picture(picture: Picture, one: Detection, shape: WindowShape) -> tuple[Picture, Picture]:
    """Two (H, W, 3) pictures of equal size around a box: the image in the detector's own size, and its HOG.

    Every cell shows the directions of its edges, the stronger the brighter.
    """
    from skimage.feature import hog  # only where images are looked at: it takes a while to load

    high, wide = shape.body
    scale = max((one.bottom - one.top) / high, (one.right - one.left) / wide)
    cols, rows = (cells + 2 * MARGIN_CELLS for cells in (shape.cols, shape.rows))
    column, row = one.middle
    left, top = column - cols * shape.cell * scale / 2, row - rows * shape.cell * scale / 2
    matrix = np.array([[scale, 0.0, left], [0.0, scale, top]])
    size = (cols * shape.cell, rows * shape.cell)
    flags = cv2.INTER_AREA | cv2.WARP_INVERSE_MAP
    part = cv2.warpAffine(picture, matrix, size, flags=flags, borderMode=cv2.BORDER_REPLICATE)
    factor = CELL_PIXELS / shape.cell
    fine = cv2.resize(grey(part), None, fx=factor, fy=factor, interpolation=cv2.INTER_LINEAR)
    _, edges = hog(
        fine, ORIENTATIONS, (CELL_PIXELS, CELL_PIXELS), (BLOCK, BLOCK), visualize=True, feature_vector=False
    )
    bright = np.clip(edges / max(1e-9, float(np.percentile(edges, 99))), 0, 1)
    drawn = np.repeat((255 * bright[..., None]).astype(np.uint8), 3, axis=2)
    shown = cv2.resize(part, (drawn.shape[1], drawn.shape[0]), interpolation=cv2.INTER_NEAREST)
    return np.asarray(shown, np.uint8), drawn
