"""How the map of robots that run came to be: what stood at moments of the past, in little memory."""

from __future__ import annotations

import pickle
import zlib
from bisect import bisect_right
from typing import Any

MOST_MOMENTS = 120
MOST_BYTES = 24_000_000
CLOSEST = 1.0  # seconds between two moments at first; twice as many each time that there are too many


class LiveHistory:
    """Whole answers by time, pressed. The longer it goes on, the farther apart they are."""

    def __init__(self, most: int = MOST_MOMENTS, most_bytes: int = MOST_BYTES) -> None:
        self._most, self._most_bytes, self._apart = most, most_bytes, CLOSEST
        self._times: list[float] = []
        self._kept: list[bytes] = []

    @property
    def times(self) -> tuple[float, ...]:
        """Of the moments that are kept, seconds."""
        return tuple(self._times)

    @property
    def bytes(self) -> int:
        return sum(map(len, self._kept))

    def add(self, time: float, answer: Any) -> None:
        """Keep what stands at a time, which is later than those before."""
        if self._times and time - self._times[-1] < self._apart:
            return
        self._times.append(time)
        self._kept.append(zlib.compress(pickle.dumps(answer, pickle.HIGHEST_PROTOCOL), 1))
        while len(self._times) > 1 and (len(self._times) > self._most or self.bytes > self._most_bytes):
            # the newest stays, and every other one before it
            self._times, self._kept = self._times[::-2][::-1], self._kept[::-2][::-1]
            self._apart *= 2

    def at(self, time: float) -> tuple[float, Any] | None:
        """The last moment that is not later, else the first, and what stood then; None before any."""
        if not self._times:
            return None
        k = max(0, bisect_right(self._times, time) - 1)
        return self._times[k], pickle.loads(zlib.decompress(self._kept[k]))
