"""What a person did on the page, step by step: undo, redo, go anywhere. Bounded in number and bytes."""

from __future__ import annotations

from collections.abc import Callable, Hashable
from dataclasses import dataclass, replace
from time import monotonic
from typing import Any

from app.model.fleet_state import FleetState
from app.model.run_state import RunState
from app.page.undo.page_snapshot import PageSnapshot, change

MOST = 80  # entries; the oldest are forgotten
MOST_BYTES = 300_000_000  # that all of them hold on to, what they share counted once
PAUSE = 1.2  # seconds; a slider that is moved on within them makes one entry, not many


@dataclass(frozen=True, eq=False)
class UndoStep:
    """A snapshot of the page and what was done to come to it.

    kind : what doing more of the same is called; None for an action that stands alone
    at   : seconds; when it was done last
    """

    label: str
    snapshot: PageSnapshot
    kind: Hashable = None
    at: float = 0.0


class UndoHistory:
    """Steps in their order; a new one forgets those undone. ``changed`` is called after every change."""

    def __init__(self, most: int = MOST, most_bytes: int = MOST_BYTES) -> None:
        self._most, self._most_bytes = most, most_bytes
        self.changed: Callable[[], None] = lambda: None
        self._steps: list[UndoStep] = []
        self._moving = False  # whether the step at hand may still take in more of the same
        self.position = -1

    @property
    def steps(self) -> tuple[UndoStep, ...]:
        """All of them, oldest first."""
        return tuple(self._steps)

    @property
    def snapshot(self) -> PageSnapshot | None:
        """The snapshot at hand; None before the first."""
        return self._steps[self.position].snapshot if self._steps else None

    def note(self, snapshot: PageSnapshot, label: str = "") -> bool:
        """Record what was done (else named after what has changed); whether there is anything new."""
        before = self.snapshot
        if before is None:
            name = snapshot.inputs.name
            self.record(label or (f"load {name}" if name else "an empty page"), snapshot)
            return True
        found, kind = change(before, snapshot)
        if found or label:
            self.record(label or found, snapshot, None if label else kind)
        return bool(found or label)

    def record(
        self, label: str, snapshot: PageSnapshot, kind: Hashable = None, now: float | None = None
    ) -> None:
        """A person did something: this is the page since then."""
        now = monotonic() if now is None else now
        del self._steps[self.position + 1 :]
        last = self._steps[-1] if self._steps else None
        if self._moving and kind is not None and last and kind == last.kind and now - last.at <= PAUSE:
            label = _joined(last.label, label)
            self._steps.pop()
        self._steps.append(UndoStep(label, snapshot, kind, now))
        self.position, self._moving = len(self._steps) - 1, True
        self._trim()
        self.changed()

    def amend(self, outcome: RunState) -> None:
        """What was asked for at the step at hand has come out."""
        self._replace(outcome=outcome)

    def amend_fleet(self, fleet: FleetState) -> None:
        """More is known of the fleet at the step at hand, or it is looked at otherwise."""
        self._replace(fleet=fleet)

    def forget_goal(self) -> None:
        """What was asked for is not wanted any more: who comes back to it finds what it began with."""
        if self.snapshot is not None and self.snapshot.outcome is None and not self.snapshot.held:
            self._replace(goal=None)

    def _replace(self, **changes: Any) -> None:
        if self._steps:
            step = self._steps[self.position]
            self._steps[self.position] = replace(step, snapshot=replace(step.snapshot, **changes))
            self._trim()
            self.changed()

    def go(self, position: int) -> PageSnapshot | None:
        """Go to a step; None where there is none, or it is the one at hand."""
        if position == self.position or not 0 <= position < len(self._steps):
            return None
        self.position, self._moving = position, False
        self.changed()
        return self.snapshot

    def take_over(self, steps: tuple[UndoStep, ...], position: int) -> None:
        """Go on where an earlier tab was."""
        self._steps, self.position, self._moving = list(steps), position, False
        self.changed()

    def append(self, steps: tuple[UndoStep, ...], position: int) -> None:
        """Go on with steps of a project, at one of them; what was done here before comes before them."""
        before = self._steps[: self.position + 1] if self.position > 0 else []
        self._steps, self.position, self._moving = [*before, *steps], len(before) + position, False
        self._trim()
        self.changed()

    def _trim(self) -> None:
        """Let go of the oldest; before that, of what can be worked out again, the farthest first."""
        while len(self._steps) > self._most:
            self._drop_oldest()
        far = sorted(range(len(self._steps)), key=lambda k: -abs(k - self.position))
        for k in far[:-1]:
            if self._bytes() <= self._most_bytes:
                return
            self._steps[k] = replace(self._steps[k], snapshot=self._steps[k].snapshot.without_outcome())
        while self.position > 0 and self._bytes() > self._most_bytes:
            self._drop_oldest()

    def _drop_oldest(self) -> None:
        if self.position == 0:
            del self._steps[-1]
        else:
            del self._steps[0]
            self.position -= 1

    def _bytes(self) -> int:
        held: dict[int, int] = {}
        for step in self._steps:
            held |= step.snapshot.held_bytes()
        return sum(held.values())


@dataclass(frozen=True, eq=False)
class SavedTab:
    """What a tab leaves behind: its history, how it was looked at, how fast, what research found, and
    what camera and laser saw.
    """

    steps: tuple[UndoStep, ...]
    position: int = 0
    dark: bool = False
    speed: str = ""
    comparison: Any = None
    sweep: Any = None
    sighting: Any = None


def _joined(first: str, then: str) -> str:
    """ "spread 4 → 5 m" and "spread 5 → 6 m" are "spread 4 → 6 m"."""
    start, arrow, _ = first.partition(" → ")
    _, _, end = then.partition(" → ")
    return f"{start} → {end}" if arrow and end else then
