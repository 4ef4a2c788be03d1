"""How much memory there is, and that what nobody holds any more goes back to the system."""

from __future__ import annotations

import ctypes
import gc
import os
from collections.abc import Iterable
from contextlib import suppress
from pathlib import Path
from threading import Lock, Timer

SOON = 2.0  # seconds; many tabs that close together are cleared away once

LIMITS = (  # of a container
    Path("/sys/fs/cgroup/memory.max"),
    Path("/sys/fs/cgroup/memory/memory.limit_in_bytes"),
)


def whole(limits: Iterable[Path] = LIMITS) -> int:
    """Bytes of memory that this machine has, or its container may have; raises where nobody tells."""
    least = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
    for path in limits:
        with suppress(OSError, ValueError):  # not there, or "max"
            least = min(least, int(path.read_text()))
    return least


def give_back() -> None:
    """Find what only holds itself, and return free memory to the system: glibc would keep it."""
    gc.collect()
    with suppress(AttributeError, OSError, TypeError):  # another C library, another system
        ctypes.CDLL(None).malloc_trim(0)


class MemoryCleanup:
    """Gives memory back a little later, once for all who ask meanwhile."""

    def __init__(self) -> None:
        self._lock, self._asked = Lock(), False

    def soon(self) -> None:
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
