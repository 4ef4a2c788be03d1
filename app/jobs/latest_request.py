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

    def __init__(
        self, work: Callable[[T], None], name: str, ended: Callable[[], None] = lambda: None
    ) -> None:
        """``ended`` is called in the thread once it was closed."""
        self._work, self._ended = work, ended
        self._wake = Condition()
        self._waiting: list[T] = []  # one, or none
        self._current: list[T] = []
        self._closed = False
        self.thread = Thread(target=self._run, name=name, daemon=True)
        self.thread.start()

    @property
    def newest(self) -> T | None:
        """What was asked for last, as long as it waits or is worked on."""
        with self._wake:
            return next(iter(self._waiting + self._current), None)

    def wants(self, request: T) -> bool:
        """Whether what is worked on is still wanted: nothing newer was asked for, and it was not dropped."""
        with self._wake:
            return not self._waiting and any(each is request for each in self._current)

    def newer_within(self, seconds: float) -> bool:
        """Wait so long for something newer; whether it came."""
        with self._wake:
            return bool(self._wake.wait_for(lambda: self._closed or self._waiting, seconds))

    def ask(self, request: T) -> None:
        """Work on this next."""
        with self._wake:
            if not self._closed:
                self._waiting = [request]
                self._wake.notify_all()

    def drop(self) -> T | None:
        """Forget what was asked for and not begun. Give what is worked on, which nobody wants any more."""
        with self._wake:
            current, self._waiting, self._current = self._current, [], []
            return next(iter(current), None)

    def close(self) -> None:
        """End the thread; what it works on is no longer wanted."""
        self.drop()
        with self._wake:
            self._closed = True
            self._wake.notify_all()

    def _run(self) -> None:
        try:
            while True:
                with self._wake:
                    self._wake.wait_for(lambda: self._closed or self._waiting)
                    if self._closed:
                        return
                    self._current, self._waiting = self._waiting, []
                    (request,) = self._current
                try:
                    self._work(request)
                except Exception:  # a bug is logged; the next request is worked on
                    log.exception("work on the newest request ended in a bug")
                with self._wake:
                    self._current = []
        finally:
            self._ended()
