"""Follows robots that run: what stands is on the page, held still where a person works on it."""

from __future__ import annotations

import logging
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from threading import Event
from typing import TYPE_CHECKING

from algorithms.common.errors import MapMergeError
from algorithms.fleets.live_answer import WITHDRAWN, LiveEvent
from algorithms.observations.fleet import FleetSighting
from app.model.fleet_state import FleetState
from app.model.live.robot_state import clock
from app.model.view_modes import LIVE_DEMO
from app.page.fleet.fleet_controller import FleetController
from app.page.live.live_panel import event_line
from app.page.live.live_thread import LiveThread
from app.page.tab import Tab
from app.report.fleet_report import summary

if TYPE_CHECKING:  # as in live_thread
    from app.live.watch.live_watch import LivePicture
    from app.live.watch.running_robots import RunningRobots
    from app.model.live.live_history import LiveHistory

log = logging.getLogger(__name__)

MOST_EVENTS = 5  # that are shown
BEGINS = "The robots set out. What is shown here stays until they send their maps."
ROBOTS = "Simulated robots"
SIGHTING = "sighting"  # kind of an event, as live_run has it
LOUD_FOR = 8.0  # seconds for which it is told what was taken back, even if it stands again


class LiveController:
    """Of one tab; ``fleet`` shows what stands, as any fleet."""

    def __init__(self, tab: Tab, fleet: FleetController) -> None:
        self._state, self._run, self._panel = tab.state, tab.panels.run, tab.panels.live
        self._locks, self._modes, self._history = tab.state.locks, tab.modes, tab.history
        self._display, self._notices, self._fleet = tab.display, tab.notices, fleet
        self._thread: LiveThread | None = None
        self._simulated = False
        self._past: LiveHistory | None = None
        self._newest: LivePicture | None = None
        self._shown: FleetState | None = None  # by us; None before, and of a picture that stands still
        self._name = ""
        self._following = False
        self._begun_at = self._place  # before there is anything to show
        self._events: deque[str] = deque(maxlen=MOST_EVENTS)
        self._loud: tuple[float, str] | None = None  # since when, and what was taken back
        self._panel.connect(self._freeze, self._resume, self._look_back, self.end)

    def close(self) -> None:
        """The tab is gone; a picture that followed the robots stays as it is."""
        with self._locks.action:
            if self._following and self._ours:
                self._history.amend_fleet(self._still(self._state.fleet))
            self._stop()

    # --- it begins and ends ---------------------------------------------------------------------------

    def demo(self) -> None:
        """Simulated robots set out, or are sent home."""
        from app.live.watch.running_robots import SimulatedRobots

        with self._locks.action:
            if self._thread is not None and self._simulated:
                self.end()
            else:
                self.begin(lambda: SimulatedRobots(lambda: self._panel.speed), ROBOTS, simulated=True)

    def begin(self, make: Callable[[], RunningRobots], name: str, simulated: bool = False) -> bool:
        """Follow robots in place of those that were followed before; whether there is room to."""
        from app.live.watch.live_watch import pictures
        from app.model.live.live_history import LiveHistory

        def follow(stop: Event) -> Iterator[LivePicture]:
            yield from pictures(make(), name, stop)

        with self._locks.action:
            self._stop()
            try:
                self._thread = LiveThread(self._locks, follow, self._take, self._failed)
            except MapMergeError as error:
                self._notices.report(error)
                return False
            self._modes.leave()
            self._past, self._newest, self._shown, self._name = LiveHistory(), None, None, name
            self._simulated, self._following, self._loud = simulated, True, None
            self._events.clear()
            self._begun_at = self._place
            with self._locks.drawing:
                self._panel.open(simulated)
                self._run.open(LIVE_DEMO, simulated)
                self._display.messages.hud(state=BEGINS, mood="running", progress=None)
                self._display.show_buttons()
            return True

    def follows(self, name: str) -> bool:
        """Whether robots are followed that are called so together."""
        return self._thread is not None and self._name == name

    @property
    def sightings(self) -> Sequence[FleetSighting]:
        """What the robots that are followed have seen of one another, in their maps as they are now."""
        state = None if self._newest is None else self._newest.state
        return () if state is None else state.fleet.sightings

    def end(self) -> None:
        """Follow nobody any more; what is on the page stays."""
        with self._locks.action, self._locks.drawing:
            if self._thread is None:
                return
            if self._following:
                self._freeze()
            self._stop()
            self._panel.close()
            self._run.open(LIVE_DEMO, False)
            self._display.show_buttons()

    def _stop(self) -> None:
        if self._thread is not None:
            self._thread.stop()
        self._thread, self._past, self._newest, self._following = None, None, None, False

    def _failed(self, why: str) -> None:
        self.end()
        self._notices.report(MapMergeError(why))

    # --- pictures come ----------------------------------------------------------------------------------

    def _take(self, picture: LivePicture) -> None:
        """The next picture; whoever calls holds both locks."""
        past, state = self._past, picture.state
        if past is None:
            return
        self._newest = picture
        if picture.anew and state is not None:
            past.add(picture.seconds, (state.fleet, state.result))
        for event in picture.events:
            if event.kind == SIGHTING:
                continue  # it is drawn
            self._events.appendleft(event_line(picture.seconds, event.robot, event.said))
            log.info("%s: %s: %s", event.robot, event.kind, event.said)
        taken_back = [event for event in picture.events if event.kind == WITHDRAWN]
        if taken_back:
            self._alarm(picture, taken_back)
        at_home = self._ours if self._shown is not None else self._place == self._begun_at
        if self._following and not at_home:
            self._following = False  # a person has gone elsewhere
            self._panel.frozen(True)
        if self._following and state is not None:
            self._follow(picture, state)
        self._tell(picture)

    def _follow(self, picture: LivePicture, state: FleetState) -> None:
        live = replace(state, live=picture.robots)
        if self._shown is None:
            self._fleet.show(state, self._name.lower())
        else:
            live = replace(live, hidden=self._state.fleet.hidden if self._state.fleet else frozenset())
        if not self._fleet.claim(live):
            self._following = False
            self._panel.frozen(True)
            return
        self._shown = live
        self._state.update(fleet=live)
        self._fleet.display.show(look=self._run.follow, follow=False)
        words, mood = self._outcome(picture, live)
        self._fleet.display.say(words, mood, None)

    def _outcome(self, picture: LivePicture, state: FleetState) -> tuple[str, str]:
        """What stands, above the maps."""
        assert state.result is not None
        said = f"Live, {clock(picture.seconds)}: {summary(state.result, len(state.robots))}"
        if self._loud is not None and (picture.lost or picture.seconds - self._loud[0] < LOUD_FOR):
            return f"Taken back: {self._loud[1]} {said}", "refused"
        return said, "accepted" if state.result.whole else "running"

    def _alarm(self, picture: LivePicture, events: list[LiveEvent]) -> None:
        """Say loudly that something does not hold any more, also where the picture stands still."""
        said = " ".join(f"{event.robot} has no place any more: {event.said}." for event in events)
        self._loud = picture.seconds, said
        self._notices.show("Taken back", said, "red")

    def _tell(self, picture: LivePicture) -> None:
        count = sum(each.state == "live" for each in picture.robots.values())
        said = f"{clock(picture.seconds)}: {count} of {len(picture.robots)} robots are live."
        if picture.state is None:
            said = f"{clock(picture.seconds)}: the merge begins with the second map. " + " ".join(
                f"{name}: {each.told}." for name, each in picture.robots.items()
            )
        elif not self._following:
            said += " The picture stands still."
        self._panel.say(said, tuple(self._events))
        if self._following and self._past is not None:
            self._panel.past(self._past.times, picture.seconds)

    # --- a still picture ----------------------------------------------------------------------------------

    @property
    def _place(self) -> tuple[object, object]:
        """Where a person is."""
        return self._history.snapshot, self._modes.current

    @property
    def _ours(self) -> bool:
        """Whether the page shows what it was given last."""
        fleet = self._fleet.shown
        return fleet is not None and self._shown is not None and fleet.fleet is self._shown.fleet

    def _still(self, state: FleetState | None) -> FleetState:
        assert state is not None
        return replace(state, live={})

    def _freeze(self) -> None:
        """Hold the picture."""
        with self._locks.action, self._locks.drawing:
            if not self._following:
                return
            self._following = False
            self._panel.frozen(True)
            if self._ours and self._newest is not None:
                self._hold(self._still(self._state.fleet), "Frozen at", self._newest.seconds)

    def _resume(self) -> None:
        """Follow the robots again."""
        with self._locks.action, self._locks.drawing:
            if self._thread is not None and not self._following:
                self._following, self._shown, self._begun_at = True, None, self._place
                self._panel.frozen(False)
                if self._newest is not None:
                    self._take(replace(self._newest, anew=False, events=()))

    def _look_back(self, seconds: float) -> None:
        """Show what stood at a moment of the past, as a still picture."""
        from app.live.watch.live_watch import state_from

        with self._locks.action, self._locks.drawing:
            found = None if self._past is None else self._past.at(seconds)
            if found is None:
                return
            time, (fleet, result) = found
            self._following = False
            self._panel.frozen(True)
            self._hold(state_from(fleet, result, self._name), "Looking back at", time, look=True)
            if self._newest is not None:
                self._tell(self._newest)

    def _hold(self, state: FleetState, what: str, seconds: float, look: bool = False) -> None:
        """Show a still picture, as a step that undo goes back from; of more of the same one."""
        label = f"{what.lower()} {clock(seconds)}"
        if self._fleet.shown is None:
            self._fleet.show(state, label)
        elif self._fleet.claim(state):
            self._state.update(fleet=state)
            self._fleet.display.show(look=look)
            self._history.record(label, self._state.snapshot(), what)
        self._shown = None
        if state.result is not None and self._state.fleet is state:
            said = f"{what} {clock(seconds)}: {summary(state.result, len(state.robots))}"
            self._fleet.display.say(said, "accepted" if state.result.whole else "idle", None)
