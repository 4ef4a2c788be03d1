"""The merge of a fleet, pair by pair, beside its page."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from threading import Event

from algorithms.common.errors import MapMergeError
from algorithms.fleets.fleet_merge import FleetResult, FleetStep, PairStep
from algorithms.fleets.pair_hypotheses import PairFinding, PairOrder, pair_orders
from algorithms.observations.fleet import Fleet
from app.jobs.background_job import BackgroundJob, beside_the_page
from app.jobs.executor import Executor
from app.jobs.fleet_pairs import run_pairs
from app.model.fleet_state import FleetState
from app.page.fleet.fleet_display import FleetDisplay
from app.page.tab import Tab

STOPPED = "Stopped. Merge goes on where it was."
JOBS = 2


class StoppedError(MapMergeError):
    """Nobody waits for the pairs any more."""


class FleetRunController:
    """Of one tab; ``executor``: makes what pairs are merged on."""

    def __init__(
        self, tab: Tab, display: FleetDisplay, executor: Callable[[int], Executor] = beside_the_page
    ) -> None:
        self._state, self._history, self._run = tab.state, tab.history, tab.panels.run
        self._display, self._executor = display, executor
        say = display.say
        self._work = BackgroundJob(
            self, tab.state.locks.drawing, "fleet", lambda words, share: say(words, "running", share)
        )

    @property
    def busy(self) -> bool:
        return self._work.busy

    def begin(self, state: FleetState) -> None:
        """Merge all pairs that are not merged yet, and put the answers of all together."""
        self._run.stoppable("fleet", True)
        self._work.start(lambda stop: self._steps(state, stop))

    def stop(self) -> bool:
        """Leave it; whether there was anything to leave."""
        self._run.stoppable("fleet", False)
        return self._work.stop()

    def _steps(self, state: FleetState, stop: Event) -> Iterator[FleetStep]:
        executor = self._executor(JOBS)

        def pairs(fleet: Fleet, orders: Sequence[PairOrder]) -> Iterator[PairFinding]:
            yield from run_pairs(executor, fleet, orders, stop)
            if stop.is_set():
                raise StoppedError(STOPPED)

        yield from state.merged(pairs)

    def part_done(self, step: FleetStep) -> None:
        """More is known of the fleet."""
        state = self._state.fleet
        if state is None:
            return
        if isinstance(step, FleetResult):
            self._take(replace(state, result=step, again=False))
            return
        self._display.say(_progress(step), "running", step.done / (step.total + 1))
        if state.finding(step.finding.order) is None and step.finding.order in pair_orders(state.fleet):
            self._take(state.with_finding(step.finding))

    def ended(self, why: str) -> None:
        self._run.stoppable("fleet", False)
        if why:
            self._display.say(why, "failed", None)
        else:
            self._display.show(look=True)
            self._display.say_outcome()

    def _take(self, state: FleetState) -> None:
        self._state.update(fleet=state)
        self._history.amend_fleet(state)
        self._display.show(look=self._run.follow, follow=False)  # robots move while others are merged


def _progress(step: PairStep) -> str:
    order = step.finding.order
    return f"Merging pairs: {step.done} of {step.total}. {order.ref} and {order.mov}: {step.finding.said}"
