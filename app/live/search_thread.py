"""A search of pairs beside the loop that listens to robots."""

from __future__ import annotations

from collections.abc import Sequence
from concurrent.futures import Future, ThreadPoolExecutor

from algorithms.fleets.pair_hypotheses import PairFinding, PairOrder, find_pair
from algorithms.observations.fleet import Fleet
from app.jobs.warm_up import small_merge


class SearchThread:
    """One set of pairs at a time, in a thread: the kernels that take the time let others run."""

    def __init__(self) -> None:
        self._thread = ThreadPoolExecutor(1, "pair search")
        self._found: Future[list[PairFinding]] | None = None

    def warm_up(self) -> None:
        """Load and compile what the first search needs before there is one to do."""
        self._thread.submit(lambda: list(small_merge().run({})))

    def start(self, fleet: Fleet, orders: Sequence[PairOrder]) -> None:
        self._found = self._thread.submit(lambda: [find_pair(fleet, order) for order in orders])

    def finished(self) -> list[PairFinding] | None:
        if self._found is None or not self._found.done():
            return None
        found, self._found = self._found, None
        return found.result()

    def close(self) -> None:
        """Wait for no search that has not begun."""
        self._thread.shutdown(wait=False, cancel_futures=True)
