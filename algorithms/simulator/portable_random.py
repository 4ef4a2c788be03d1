"""Random draws and angles that come out the same, bit for bit, on every machine.

Only the raw stream of a numpy bit generator is promised never to change (NEP 19); what a Generator
makes of it may. And sine, cosine or a normal draw may differ in the last bit between two
mathematical libraries, which is enough to move a beam into the next cell. So draws here are integer
arithmetic on the raw stream, and angles are whole ticks, looked up in one table of sines that is
rounded to multiples of 2^-30, far coarser than any library's error.
"""

from __future__ import annotations

import zlib
from collections.abc import Sequence
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from algorithms.common.pose import FloatArray

Ticks = NDArray[np.int64]
T = TypeVar("T")

TURN = 65536  # ticks of a full turn; one tick is 0.0055°, 0.8 mm at 8 m
TRIG_GRID = 2.0**30
METRE_GRID = 2.0**20  # positions are whole multiples of 2^-20 m, about a micrometre


def _cosines() -> FloatArray:
    """Cosine of every tick, (TURN,); one quadrant computed, the others mirrored."""
    quarter = TURN // 4
    quadrant = np.rint(np.cos(np.arange(quarter + 1) * (2 * np.pi / TURN)) * TRIG_GRID) / TRIG_GRID
    quadrant[quarter] = 0.0
    half = np.concatenate([quadrant, -quadrant[-2::-1]])  # 0 … π
    return np.concatenate([half, half[-2:0:-1]])


COSINES = _cosines()
SINES = np.roll(COSINES, TURN // 4)
DIRECTIONS = np.stack([COSINES, SINES])
"""(2, TURN) cosine and sine of every tick."""


def cosine(ticks: Ticks | int) -> FloatArray:
    """Cosine of whole ticks, any shape."""
    return np.asarray(COSINES[np.asarray(ticks) % TURN])


def sine(ticks: Ticks | int) -> FloatArray:
    """Sine of whole ticks, any shape."""
    return np.asarray(SINES[np.asarray(ticks) % TURN])


def ticks_of_degrees(degrees: float) -> int:
    return round(degrees * TURN / 360)


def radians(ticks: int) -> float:
    """A tick count as an angle in (−π, π]."""
    wrapped = (ticks + TURN // 2 - 1) % TURN - TURN // 2 + 1
    return float(wrapped * (2 * np.pi / TURN))


def snap(metres: FloatArray) -> FloatArray:
    """Round positions to multiples of 2^-20 m."""
    return np.asarray(np.rint(metres * METRE_GRID) / METRE_GRID)


def stream(seed: int, *purpose: str) -> np.random.Generator:
    """A generator for one purpose; streams of different purposes don't disturb each other."""
    words = [seed, *(zlib.crc32(word.encode()) for word in purpose)]
    return np.random.Generator(np.random.PCG64(np.random.SeedSequence(words)))


def raw(rng: np.random.Generator, n: int) -> NDArray[np.uint64]:
    """(n,) words of the raw stream."""
    return np.asarray(rng.bit_generator.random_raw(n), dtype=np.uint64)


def uniform(rng: np.random.Generator, low: float, high: float) -> float:
    """A number in [low, high), a multiple of 2^-20 above low, so metres stay short."""
    return low + (high - low) * (int(raw(rng, 1)[0]) >> 44) / 2**20


def whole(rng: np.random.Generator, low: int, high: int) -> int:
    """An integer in [low, high], both included."""
    return low + ((int(raw(rng, 1)[0]) * (high - low + 1)) >> 64)


def chance(rng: np.random.Generator, probability: float) -> bool:
    return (int(raw(rng, 1)[0]) >> 11) / 2**53 < probability


def pick(rng: np.random.Generator, options: Sequence[T]) -> T:
    return options[whole(rng, 0, len(options) - 1)]


def uniforms(rng: np.random.Generator, n: int) -> FloatArray:
    """(n,) numbers in [0, 1)."""
    return np.asarray((raw(rng, n) >> np.uint64(11)).astype(np.float64) / 2**53)


def normals(rng: np.random.Generator, n: int) -> FloatArray:
    """(n,) draws of mean 0 and standard deviation 1: twelve 16-bit uniforms added up.

    A sum of twelve is normal to the eye, ends at ±6 and, being a sum of integers, is exact.
    """
    words = raw(rng, 3 * n).reshape(3, n)
    total = np.zeros(n, dtype=np.int64)
    for shift in (0, 16, 32, 48):
        total += ((words >> np.uint64(shift)) & np.uint64(0xFFFF)).astype(np.int64).sum(axis=0)
    return np.asarray((2 * total - 12 * 65535).astype(np.float64) / 131072)
