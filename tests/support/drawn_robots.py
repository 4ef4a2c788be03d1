"""Small pictures with a board on it that a detector can learn in a second: no robot, but as square."""

from __future__ import annotations

import cv2
import numpy as np

from algorithms.detection.detection import Picture
from algorithms.detection.svm_training import Background, RobotExample

Lines = tuple[tuple[tuple[float, float], tuple[float, float]], ...]

SIDE = 48  # pixels of a board, as it is drawn
CROSS = (((0.2, 0.2), (0.8, 0.8)), ((0.8, 0.2), (0.2, 0.8)))  # lines on it; shares of its side
BARS = (((0.3, 0.2), (0.3, 0.8)), ((0.7, 0.2), (0.7, 0.8)))


def room(rng: np.random.Generator, width: int = 200, height: int = 150) -> Picture:
    """Soft blobs and a few straight edges."""
    noise = cv2.GaussianBlur(rng.integers(0, 256, (height, width, 3)).astype(np.uint8), (0, 0), 6)
    picture = cv2.convertScaleAbs(noise, alpha=2.0, beta=-128)
    for _ in range(4):
        a, b = rng.integers(0, (width, height), (2, 2)).tolist()
        cv2.rectangle(picture, a, b, rng.integers(0, 256, 3).tolist(), int(rng.integers(1, 6)))
    return np.ascontiguousarray(picture)


def with_board(
    rng: np.random.Generator, size: int = SIDE, lines: Lines = CROSS
) -> tuple[Picture, np.ndarray]:
    """A room with a white board that has dark lines; and the board's box."""
    picture = room(rng)
    height, width = picture.shape[:2]
    left, top = int(rng.integers(2, width - size - 2)), int(rng.integers(2, height - size - 2))
    board = np.full((size, size, 3), 235, np.uint8)
    for a, b in lines:
        ends = [tuple(int(size * part) for part in point) for point in (a, b)]
        cv2.line(board, *ends, (20, 20, 20), max(2, size // 8))
    picture[top : top + size, left : left + size] = board
    return picture, np.array([left - 0.5, top - 0.5, left + size - 0.5, top + size - 0.5])


def examples(count: int, seed: int = 0) -> tuple[list[RobotExample], list[Background]]:
    """Pictures to train with."""
    rng = np.random.default_rng(seed)
    robots = [RobotExample(*with_board(rng, int(rng.integers(40, 90))), "robot") for _ in range(count)]
    return robots, [Background(room(rng)) for _ in range(count)]
