"""Randomness that belongs to a place: the same point of a wall has the same spots in every picture."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from algorithms.common.parallel_kernels import kernel
from algorithms.simulator.portable_random import stream, uniforms

Tones = NDArray[np.floating[Any]]
Whole = NDArray[np.int64]

SIDE = 256  # the table repeats after so many lattice points each way


@cache
def _table() -> Tones:
    """(SIDE, SIDE) numbers in [0, 1)."""
    drawn = uniforms(stream(0, "views", "noise"), SIDE * SIDE)
    return np.asarray(drawn.reshape(SIDE, SIDE), dtype=np.float32)


def whole_part(x: Tones) -> Whole:
    """The greatest integers that are not above x."""
    return np.asarray(np.floor(x), dtype=np.int64)


def lattice(i: Whole, j: Whole | int, seed: int = 0) -> Tones:
    """Numbers in [0, 1) of lattice points, any shape; neighbours have nothing to do with each other."""
    return np.asarray(_table()[(j + 31 * seed) % SIDE, (i + 57 * seed) % SIDE])


@kernel
def _smooth(table: Tones, x: Tones, y: Tones, seed: int, out: Tones) -> None:
    for n in range(len(x)):
        i, j = int(np.floor(x[n])), int(np.floor(y[n]))
        s, t = x[n] - i, y[n] - j
        s, t = s * s * (3 - 2 * s), t * t * (3 - 2 * t)
        left, low = i + 57 * seed, j + 31 * seed
        below = table[low % 256, left % 256] * (1 - s) + table[low % 256, (left + 1) % 256] * s
        above = table[(low + 1) % 256, left % 256] * (1 - s) + table[(low + 1) % 256, (left + 1) % 256] * s
        out[n] = below * (1 - t) + above * t


def smooth(x: Tones, y: Tones, seed: int = 0) -> Tones:
    """Numbers in [0, 1] that change smoothly from lattice point to lattice point; any shape."""
    out = np.empty(x.shape, dtype=np.float32)
    flat_x, flat_y = (np.ascontiguousarray(at, dtype=np.float64).ravel() for at in (x, y))
    _smooth(_table(), flat_x, flat_y, seed, out.ravel())
    return out


def rough(x: Tones, y: Tones, seed: int = 0) -> Tones:
    """``smooth`` of three sizes on one another, in [0, 1]: blotches with smaller blotches."""
    first, second = smooth(x, y, seed), smooth(x * 2.3, y * 2.3, seed + 1)
    return np.asarray(0.55 * first + 0.28 * second + 0.17 * smooth(x * 5.1, y * 5.1, seed + 2))
