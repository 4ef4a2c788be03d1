"""Work off the widgets' threads of which only the newest request counts."""

from __future__ import annotations

import logging
from collections.abc import Callable
from threading import Condition, Thread
from typing import Generic, TypeVar

T = TypeVar("T")

log = logging.getLogger(__name__)


class LatestRequest(Generic[T]):
    """One thread that works on what was asked last; what was asked before it began is passed over."""

    def __init__(self, work: Callable[[T], None], name: str) -> None:
        self._work = work
        self._wake = Condition()
        self._wanted: list[T] = []
        self._closed = False
        Thread(target=self._run, name=name, daemon=True).start()

    def newer_within(self, seconds: float) -> bool:
        """Wait so long for something newer; whether it came."""
        with self._wake:
            return bool(self._wake.wait_for(lambda: self._closed or self._wanted, seconds))

    def ask(self, wanted: T) -> None:
        """Work on this next."""
        with self._wake:
            self._wanted[:] = [wanted]
            self._wake.notify_all()

    def drop(self) -> None:
        """Forget what was asked for and not begun."""
        with self._wake:
            self._wanted.clear()

    def close(self) -> None:
        """End the thread."""
        with self._wake:
            self._closed = True
            self._wake.notify_all()

    def _run(self) -> None:
        while True:
            with self._wake:
                self._wake.wait_for(lambda: self._closed or self._wanted)
                if self._closed:
                    return
                wanted = self._wanted.pop()
            try:
                self._work(wanted)
            except Exception:  # a bug is logged; the next request is worked on
                log.exception("work on the newest request ended in a bug")
