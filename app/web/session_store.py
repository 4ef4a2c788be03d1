"""A tab that is reloaded, or loses its connection for a while, finds everything as it was.

The key to it is kept by the tab itself (sessionStorage, which a reload does not clear and no other tab
shares), is made anew at every connection, and cannot be guessed. A copy of a tab comes with the key of a
tab that is still there, and gets nothing for it.
"""

from __future__ import annotations

import secrets
from collections import OrderedDict
from collections.abc import Callable
from threading import Lock, Timer
from time import monotonic
from typing import Generic, Protocol, TypeVar

GRACE = 15 * 60.0  # seconds that a tab may be away
MOST_KEPT = 8  # tabs that are away; the one that is away longest is forgotten first


Saved = TypeVar("Saved")  # what a tab leaves behind


class Shelf(Protocol[Saved]):
    """What outlives the server."""

    def keep(self, key: str, saved: Saved) -> None:
        """Have it there before this returns; raises MapMergeError."""

    def take(self, key: str, fresh: str) -> Saved | None:
        """What a tab left that is not there any more, and is known by a fresh key from now on."""

    def move(self, key: str, fresh: str) -> None:
        """A tab is known by a fresh key from now on."""

    def leave(self, key: str) -> None:
        """A tab is gone."""


class SessionStore(Generic[Saved]):
    """Of all tabs of a server; ``shelf``: what outlives it, if anything does."""

    def __init__(
        self,
        grace: float = GRACE,
        most: int = MOST_KEPT,
        clock: Callable[[], float] = monotonic,
        shelf: Shelf[Saved] | None = None,
    ) -> None:
        self._grace, self._most, self._clock, self._shelf = grace, most, clock, shelf
        self._here: dict[str, Callable[[], Saved | None]] = {}
        self._away: OrderedDict[str, tuple[float, Saved]] = OrderedDict()
        self._sweeping = False  # whether a timer is set
        self._lock = Lock()

    def enter(self, key: str, again: bool, leave: Callable[[], Saved | None]) -> tuple[str, Saved | None]:
        """A tab is here: its new key, and what it left behind under its old one.

        again : it is the same page, which has connected anew: its former connection is dead, even if
                the server has not noticed yet
        leave : closes the tab and tells what it leaves behind
        """
        with self._lock:
            self._forget()
            _, kept = self._away.pop(key, (0.0, None))
            dead = self._here.pop(key, None) if again else None
            a_copy = key in self._here
        if dead is not None:
            kept = dead()
        fresh = secrets.token_urlsafe(24)
        if self._shelf is not None and not a_copy:
            if kept is None:
                kept = self._shelf.take(key, fresh)
            else:
                self._shelf.move(key, fresh)
        with self._lock:
            self._here[fresh] = leave
        return fresh, kept

    def keep(self, key: str, saved: Saved) -> None:
        """What a tab would leave behind, should the server end now; raises MapMergeError."""
        if self._shelf is not None:
            self._shelf.keep(key, saved)

    def leave(self, key: str) -> None:
        """A tab is gone: what it leaves behind is kept for a while."""
        with self._lock:
            leave = self._here.pop(key, None)
        if leave is None:
            return  # it has come back already
        kept = leave()
        if self._shelf is not None:
            self._shelf.leave(key)
        if kept is None:
            return
        with self._lock:
            self._away[key] = self._clock(), kept
            self._forget()
            self._sweep_later()

    def forget_all(self) -> None:
        """Let go of everything that tabs left behind: the room is needed by tabs that are there."""
        with self._lock:
            self._away.clear()

    def sweep(self) -> None:
        """Let go of what nobody came back for."""
        with self._lock:
            self._sweeping = False
            self._forget()
            self._sweep_later()

    def _sweep_later(self) -> None:
        """One timer for all: it is set for the tab that is away longest."""
        if self._sweeping or not self._away:
            return
        self._sweeping = True
        since, _ = next(iter(self._away.values()))
        timer = Timer(max(1.0, since + self._grace - self._clock()), self.sweep)
        timer.name, timer.daemon = "mapmeld-keep", True
        timer.start()

    def _forget(self) -> None:
        old = self._clock() - self._grace
        while self._away and (len(self._away) > self._most or next(iter(self._away.values()))[0] <= old):
            self._away.popitem(last=False)
