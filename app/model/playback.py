"""How long a step stays on the screen, and the wait that a newer request cuts short."""

from __future__ import annotations

from math import exp
from threading import Condition

from algorithms.methods.steps import ProofDetail, RefineDetail, Step
from app.model.step_table import row_of

FRAME = 1 / 15  # seconds between two pictures; a browser without a graphics card follows just so

# name of the speed -> how many times as long a step stays; 0: as fast as it is computed
PACES = {"Slow": 2.5, "Normal": 1.0, "Fast": 0.35, "Instant": 0.0}

FIRST_SWARM = 0.03  # per iteration of the best candidate's swarm
FIRST_MOVES = 0.17  # more than that on its first iterations, where most of it happens
CALM_AFTER = 5.0  # iterations in which that extra time falls to a third
LATER_SWARMS = 0.006  # the rest look alike: a glimpse of each is enough
PROOF = 0.2  # per look at the proof, at its beginning; all of them together take about a second
PROOF_CALM = 4000  # blocks after which that time has fallen to half


def dwell(step: Step, pace: float, again: bool) -> float:
    """Seconds that a step stays on the screen, 0 at pace 0; ``again``: also one of an earlier run."""
    if pace <= 0 or (step.reused and not again):
        return 0.0
    if isinstance(step.detail, RefineDetail):
        if step.detail.index > 0:
            return pace * LATER_SWARMS
        return pace * (FIRST_SWARM + FIRST_MOVES * exp(-step.detail.state.iteration / CALM_AFTER))
    if isinstance(step.detail, ProofDetail):
        return pace * PROOF / (1 + step.detail.state.nodes / PROOF_CALM)
    return pace * row_of(step.detail).stay


class InterruptibleWait:
    """A wait that ends at once when ``cut`` is called from elsewhere."""

    def __init__(self) -> None:
        self._condition = Condition()
        self._cuts = 0

    @property
    def mark(self) -> int:
        """Taken before the work that the wait belongs to: a cut since then is not missed."""
        return self._cuts

    def wait(self, seconds: float, mark: int) -> None:
        """Sleep so long, or until a cut after ``mark``."""
        if seconds > 0:
            with self._condition:
                self._condition.wait_for(lambda: self._cuts != mark, seconds)

    def cut(self) -> None:
        with self._condition:
            self._cuts += 1
            self._condition.notify_all()
