"""Work that a person asks for and may leave: files are read, maps made of them.

It is left by an exception that no handler of errors catches, at the next place where it looks up; until
then it has touched nothing of the page.
"""

from __future__ import annotations

import io
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from threading import Event, RLock
from typing import Any

from app.stage import Stage

Check = Callable[[], None]


class Left(BaseException):
    """Stop was pressed. No Exception: who takes any of those for a damaged file lets this one pass."""


def unwatched() -> None:
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
    """One at a time, of one tab: says what is done, and puts the words back where nothing comes of it."""

    def __init__(self, stage: Stage, drawing: RLock, stoppable: Callable[[bool], None]) -> None:
        """stoppable : is told whether there is anything to stop"""
        self._stage, self._drawing, self._stoppable = stage, drawing, stoppable
        self._pressed: Event | None = None

    @contextmanager
    def __call__(self, doing: str) -> Iterator[Check]:
        """Gives what the work calls to look up: it raises Left once Stop was pressed."""
        pressed = self._pressed = Event()
        said = {"state": doing, "mood": "running", "progress": 0.3}
        before = self._say(said)

        def check() -> None:
            if pressed.is_set():
                raise Left

        try:
            self._stoppable(True)
            yield check
            check()  # pressed at the last moment is pressed
        except BaseException:  # left, or failed: what is to be said of that is said by others
            if self._stage.said(*said) == said:  # a run may have had its say meanwhile
                self._say(before)
            raise
        finally:
            self._pressed = None
            self._stoppable(False)

    def stop(self) -> bool:
        """Have it leave what it is at; whether it is at anything."""
        pressed = self._pressed
        if pressed is not None:
            pressed.set()
        return pressed is not None

    def _say(self, words: dict[str, Any]) -> dict[str, Any]:
        """Say this instead of what was said, and return that."""
        with self._drawing:
            before = self._stage.said(*words)
            self._stage.hud(**words)
            self._stage.flush()
        return before
