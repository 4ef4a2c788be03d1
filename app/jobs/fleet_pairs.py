"""The pairs of a fleet, merged by whoever works for an executor: processes here, or a cluster."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from threading import Event

import numpy as np

from algorithms.fleets.pair_hypotheses import PairFinding, PairOrder, find_pair
from algorithms.observations.fleet import Fleet
from app.jobs.executor import Executor, LostTask, SerialExecutor, Shared, Task

FEW = 3  # pairs that are merged here: a process more takes as long to start


def run_pairs(
    executor: Executor, fleet: Fleet, orders: Sequence[PairOrder], stop: Event | None = None
) -> Iterator[PairFinding]:
    """Merge pairs; the maps travel to each worker once. A pair whose worker dies has no answer.

    stop : as of ``Executor.run``
    """
    if len(orders) <= FEW and not executor.far:
        executor = SerialExecutor()
    shared = Shared.of(fleet)
    for number, answer in executor.run(_work, (Task(order, shared) for order in orders), stop):
        if isinstance(answer, LostTask):
            answer = PairFinding(orders[number], np.zeros(2), (), answer.reason, failed=True)
        yield answer


def _work(fleet: Fleet, order: PairOrder) -> PairFinding:
    return find_pair(fleet, order)
