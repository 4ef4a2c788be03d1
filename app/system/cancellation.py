"""Work that a person may leave: it looks up now and then, and an exception that is no error ends it."""

from __future__ import annotations

import io
from typing import Protocol


class Check(Protocol):
    """What work calls now and then to look up; it may raise Cancelled."""

    def __call__(self, done: float | None = None, /) -> None:
        """done : share of the work that is done, 0 … 1; None where nobody knows."""


class Cancelled(BaseException):
    """Stop was pressed. No Exception: who takes any of those for a damaged file lets this one pass."""


def wanted(check: Check) -> bool:
    """Whether the work is still asked for."""
    try:
        check()
    except Cancelled:
        return False
    return True


def never_cancelled(done: float | None = None, /) -> None:
    """The check of work that cannot be left."""


class CancellableReader(io.BytesIO):
    """A file in memory whose reader looks up at every part of it."""

    def __init__(self, content: bytes, check: Check) -> None:
        super().__init__(content)
        self._check = check

    def read(self, size: int | None = -1, /) -> bytes:
        """The next part, or all that is left; raises Cancelled."""
        self._check()
        return super().read(size)
