"""Who computes when many tabs want to: so many at a time, the others in their order.

For merges a turn is one step of a run: none has to wait for another's end.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager
from threading import Condition
from time import monotonic

PATIENCE = 1.0  # seconds of waiting that need no words, unless another limit is given
LOOK_S = 0.25  # how often one that waits looks whether it is still wanted


class FairSemaphore:
    """So many at a time, first come, first served."""

    def __init__(self, places: int, patience: float | None = None) -> None:
        """patience : seconds of waiting that need no words; None: PATIENCE"""
        self._free, self._patience = places, patience
        self._queue: deque[object] = deque()
        self._wake = Condition()

    @contextmanager
    def take(self, wanted: Callable[[], bool], tell: Callable[[int], None]) -> Iterator[bool]:
        """A turn, which ends with the block; gives whether there is one: while it waits it asks ``wanted``
        now and then, and calls ``tell`` once with how many are before it.
        """
        me, began, said = object(), monotonic(), False
        patience = PATIENCE if self._patience is None else self._patience
        with self._wake:
            self._queue.append(me)
        try:
            while True:
                with self._wake:
                    ready = self._wake.wait_for(lambda: self._free > 0 and self._queue[0] is me, LOOK_S)
                    if ready:
                        self._free -= 1
                        break
                    before = self._queue.index(me)
                if not wanted():
                    break
                if not said and monotonic() - began > patience:
                    said = True
                    tell(before)
        finally:
            with self._wake:
                self._queue.remove(me)
                self._wake.notify_all()  # there may be a place for the next one, too
        try:
            yield ready
        finally:
            if ready:
                with self._wake:
                    self._free += 1
                    self._wake.notify_all()

    def get(self) -> AbstractContextManager[bool]:
        """A turn, however long it takes."""
        return self.take(lambda: True, lambda before: None)
