"""Where one has been on the page: go back, go on again, go anywhere. Bounded in number and in bytes."""

from __future__ import annotations

from collections.abc import Hashable
from dataclasses import dataclass, replace
from time import monotonic
from typing import Any

from app.page.page_snapshot import PageSnapshot, weight

MOST = 80  # entries; the oldest are forgotten
MOST_BYTES = 300_000_000  # that all of them hold on to, what they share counted once
PAUSE = 1.2  # seconds; a slider that is moved on within them makes one entry, not many


@dataclass(frozen=True, eq=False)
class UndoStep:
    """A desk and what was done to come to it.

    kind : what doing more of the same is called; None for a deed that stands alone
    at   : seconds; when it was done last
    """

    label: str
    desk: PageSnapshot
    kind: Hashable = None
    at: float = 0.0


class UndoHistory:
    """Entries in their order and the one at hand. A new one forgets those that were undone."""

    def __init__(self, first: UndoStep, most: int = MOST, most_bytes: int = MOST_BYTES) -> None:
        self._entries = [first]
        self._most, self._most_bytes = most, most_bytes
        self._moving = False  # whether the entry at hand may still take in more of the same
        self.position = 0

    @property
    def entries(self) -> tuple[UndoStep, ...]:
        """All of them, oldest first."""
        return tuple(self._entries)

    @property
    def desk(self) -> PageSnapshot:
        """The desk at hand."""
        return self._entries[self.position].desk

    def record(self, label: str, desk: PageSnapshot, kind: Hashable = None, now: float | None = None) -> None:
        """A person did something: this is the desk since then."""
        now = monotonic() if now is None else now
        del self._entries[self.position + 1 :]
        last = self._entries[-1]
        if self._moving and kind is not None and kind == last.kind and now - last.at <= PAUSE:
            label = _joined(last.label, label)
            self._entries[-1] = UndoStep(label, desk, kind, now)
        else:
            self._entries.append(UndoStep(label, desk, kind, now))
        self.position, self._moving = len(self._entries) - 1, True
        self._trim()

    def amend(self, desk: PageSnapshot) -> None:
        """What was asked for at the entry at hand has come out."""
        self._entries[self.position] = replace(self._entries[self.position], desk=desk)
        self._trim()

    def go(self, position: int) -> PageSnapshot | None:
        """Go to an entry; None where there is none, or it is the one at hand."""
        if position == self.position or not 0 <= position < len(self._entries):
            return None
        self.position, self._moving = position, False
        return self.desk

    def _trim(self) -> None:
        """Let go of the oldest; before that, of what can be worked out again, the farthest first."""
        while len(self._entries) > self._most:
            self._drop_oldest()
        far = sorted(range(len(self._entries)), key=lambda k: -abs(k - self.position))
        for k in far[:-1]:
            if self._bytes() <= self._most_bytes:
                return
            self._entries[k] = replace(self._entries[k], desk=self._entries[k].desk.without_outcome())
        while self.position > 0 and self._bytes() > self._most_bytes:
            self._drop_oldest()

    def _drop_oldest(self) -> None:
        if self.position == 0:
            del self._entries[-1]
        else:
            del self._entries[0]
            self.position -= 1

    def _bytes(self) -> int:
        held: dict[int, int] = {}
        for entry in self._entries:
            held |= weight(entry.desk)
        return sum(held.values())


@dataclass(frozen=True, eq=False)
class SavedTab:
    """What a tab leaves behind: where it has been, how it was looked at, and how fast."""

    history: UndoHistory
    dark: bool = False
    speed: str = ""
    research: tuple[Any, ...] = ()  # what each of its tabs had found


def _joined(first: str, then: str) -> str:
    """ "spread 4 → 5 m" and "spread 5 → 6 m" are "spread 4 → 6 m"."""
    start, arrow, _ = first.partition(" → ")
    _, _, end = then.partition(" → ")
    return f"{start} → {end}" if arrow and end else then
