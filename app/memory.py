"""What nobody holds any more goes back to the system: left alone, the C library keeps most of it."""

from __future__ import annotations

import ctypes
import gc
from contextlib import suppress
from threading import Lock, Timer

SOON = 2.0  # seconds; many tabs that close together are cleared away once


def give_back() -> None:
    """Find what only holds itself, and return free memory to the system where it takes any (glibc)."""
    gc.collect()
    with suppress(AttributeError, OSError, TypeError):  # another C library, another system
        ctypes.CDLL(None).malloc_trim(0)


class Housekeeping:
    """Gives memory back a little later, once for all who ask meanwhile."""

    def __init__(self) -> None:
        self._lock, self._asked = Lock(), False

    def soon(self) -> None:
        """Do it in a while."""
        with self._lock:
            if self._asked:
                return
            self._asked = True
        timer = Timer(SOON, self._now)
        timer.name, timer.daemon = "mapmeld-housekeeping", True
        timer.start()

    def _now(self) -> None:
        with self._lock:
            self._asked = False
        give_back()
