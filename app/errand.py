"""Work that a person asks for and may leave: files are read, maps made of them, results written down.

It is left by an exception that no handler of errors catches, at the next place where it looks up; until
then it has touched nothing of the page.
"""

from __future__ import annotations

import io
from collections.abc import Iterator
from contextlib import contextmanager
from threading import Event, Lock, RLock
from time import perf_counter
from typing import TYPE_CHECKING, Any, Protocol

if TYPE_CHECKING:
    from collections.abc import Callable

    from app.stage import Stage

OFTEN = 0.1  # seconds between two words of how far it is


class Check(Protocol):
    """What work calls now and then to look up; it may raise Left."""

    def __call__(self, done: float | None = None, /) -> None:
        """done : share of the work that is done, 0 … 1; None where nobody knows."""


class Left(BaseException):
    """Stop was pressed. No Exception: who takes any of those for a damaged file lets this one pass."""


def unwatched(done: float | None = None, /) -> None:
    """The check of work that cannot be left."""


class Watched(io.BytesIO):
    """A file in memory whose reader looks up at every part of it."""

    def __init__(self, content: bytes, check: Check) -> None:
        super().__init__(content)
        self._check = check

    def read(self, size: int | None = -1, /) -> bytes:
        """The next part, or all that is left; raises Left."""
        self._check()
        return super().read(size)


class Errand:
    """Of one tab: says what is done, and puts the words back where nothing is to be said of it."""

    def __init__(self, stage: Stage, drawing: RLock, stoppable: Callable[[bool], None]) -> None:
        """stoppable : is told whether there is anything to stop"""
        self._stage, self._drawing, self._stoppable = stage, drawing, stoppable
        self._lock = Lock()
        self._under_way: list[Event] = []  # each is set when it is to be left

    @contextmanager
    def __call__(self, doing: str, aside: bool = False) -> Iterator[Check]:
        """Gives what the work calls to look up: it raises Left once Stop was pressed.

        aside : it changes nothing on the page, so that the words from before are right afterwards, too
        """
        pressed = Event()
        said: dict[str, Any] = {"state": doing, "mood": "running", "progress": 0.05 if aside else 0.3}
        before, told = self._say(said), perf_counter()

        def check(done: float | None = None, /) -> None:
            nonlocal told
            if pressed.is_set():
                raise Left
            if done is not None and perf_counter() - told >= OFTEN and self._still(said):
                told = perf_counter()
                said["progress"] = done
                self._say(said)

        back = True
        try:
            self._count(pressed, 1)
            yield check
            check()  # pressed at the last moment is pressed
            back = aside
        finally:
            if back and self._still(said):
                self._say(before)
            self._count(pressed, -1)

    def stop(self) -> bool:
        """Have it leave what it is at; whether it is at anything."""
        with self._lock:
            for pressed in self._under_way:
                pressed.set()
            return bool(self._under_way)

    def _count(self, pressed: Event, by: int) -> None:
        with self._lock:
            (self._under_way.append if by > 0 else self._under_way.remove)(pressed)
            any_left = bool(self._under_way)
        self._stoppable(any_left)

    def _still(self, said: dict[str, Any]) -> bool:
        """Whether nobody else has had their say since."""
        return self._stage.said(*said) == said

    def _say(self, words: dict[str, Any]) -> dict[str, Any]:
        """Say this instead of what was said, and return that."""
        with self._drawing:
            before = self._stage.said(*words)
            self._stage.hud(**words)
            self._stage.flush()
        return before
