"""Looks at what robot 1's camera and laser saw, shows what is found, and uses what a person takes of it."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from contextlib import closing
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from threading import Event

import numpy as np

from algorithms.common.errors import MapMergeError
from algorithms.detection.robot_sighting import observation_of
from algorithms.observations.observation import Observation
from app.drawing.svg.scan_plot import scan_svg
from app.jobs.background_job import BackgroundJob
from app.jobs.executor import Executor, LostTask, Task
from app.jobs.process_executor import ProcessExecutor
from app.model.knowledge import Choice
from app.model.sighting.sighting_text import outcome_text
from app.page.inputs_controller import InputsController
from app.page.modes import Mode
from app.page.run_controller import RunController
from app.page.sighting.sensors_controller import LoadedSensors, SensorsController
from app.page.sighting.sighting_dock import SightingPage
from app.page.sighting.sighting_html import boxes_html, gradients_html, picture_html, scan_html
from app.page.sighting.sighting_look import Look, LookOrder, look
from app.page.tab import Tab
from app.system import data_paths as paths

LABEL = "sighting from camera and scan"  # in the history
STALE = "Files or settings have changed since: press “Look again”."
LOOKING = "Looking for robots in {}."
STOPPED = "Stopped: nothing was looked at."


@dataclass(frozen=True, eq=False)
class LeftSighting:
    """What a tab leaves behind.

    order, look : what was looked at, and what came of it; None where nothing was
    shown       : the box that is looked at closer
    """

    loaded: LoadedSensors
    order: LookOrder | None = None
    look: Look | None = None
    shown: int | None = None


class SightingController:
    """Of one tab; ``executor`` makes what it is looked on with, ``samples`` as of SensorsController."""

    def __init__(
        self,
        tab: Tab,
        runs: RunController,
        inputs: InputsController,
        executor: Callable[[int], Executor] = ProcessExecutor,  # no gentle one: a person waits for it
        samples: Callable[[], Mapping[str, Path]] = paths.samples,
    ) -> None:
        self._state, self._panels, self._locks = tab.state, tab.panels, tab.state.locks
        self._modes, self._history, self._notices = tab.modes, tab.history, tab.notices
        self._panel, self._dock = tab.panels.sensors, tab.panels.sighting
        self._runs, self._inputs, self._executor = runs, inputs, executor
        self._order: LookOrder | None = None  # that is looked at, or was
        self._look: Look | None = None  # what came of it
        self._shown: int | None = None  # the box that is looked at closer
        self._mode = tab.modes.add(Mode(self._end))
        self._work = BackgroundJob(self, self._locks.drawing, "sighting", self._dock.say)
        self._pair = tab.state.inputs
        self.sensors = SensorsController(tab, samples)
        typed = partial(tab.events.then, self.sensors.typed)  # in order with what is typed elsewhere
        self._panel.connect_look(typed, self.sensors.settings_changed, self.look, self._stop, self.open)
        self._dock.connect(self.look, self._close, self.use)
        tab.events.on("box", self._choose, n=int)
        tab.state.subscribe("setup", self._setup_changed)
        tab.state.subscribe("palette", self._show)
        self.sensors.changed = self._sensors_changed
        self._sensors_changed()

    def close(self) -> None:
        self._work.stop()

    @property
    def left(self) -> LeftSighting:
        """What was loaded and what came of it: for a tab that is reloaded."""
        return LeftSighting(self.sensors.loaded, self._order, self._look, self._shown)

    def resume(self, left: LeftSighting | None) -> None:
        """Take up what an earlier tab had looked at."""
        if left is None or not self.sensors.resume(left.loaded) or left.look is None:
            return
        self._order, self._look, self._shown = left.order, left.look, left.shown
        self._possible()

    @property
    def active(self) -> bool:
        """Whether the dock is open."""
        return self._modes.current is self._mode

    # --- the dock comes and goes ------------------------------------------------------------------

    def open(self) -> None:
        """Show what was seen in place of the charts."""
        with self._locks.action:
            self._runs.thread.stop()
            self._modes.enter(self._mode)
            with self._locks.drawing:
                self._panels.charts.visible(False)
                self._dock.visible(True)
                self._show()
                self._possible()

    def _close(self) -> None:
        with self._locks.action:
            if self.active:
                self._modes.leave()

    def _end(self) -> None:
        with self._locks.drawing:
            self._dock.visible(False)
            self._panels.charts.visible(True)
            self._possible()

    # --- what a person asks for -------------------------------------------------------------------

    def look(self) -> None:
        """Find robots in the image, in another process."""
        with self._locks.action:
            order = self.sensors.order()
            if order is None:
                return
            if not self.active:
                self.open()
            with self._locks.drawing:
                self._order, name = order, order.picture.name

                def work(stop: Event) -> Iterator[str | Look]:
                    yield LOOKING.format(name)
                    with closing(self._executor(1).run(look, [Task(order)], stop)) as answers:
                        for _, found in answers:  # one
                            if isinstance(found, LostTask):
                                raise MapMergeError(f"Nothing was looked at: {found.reason}")
                            yield found

                self._forget()
                self._work.start(work)
                self._possible()

    def _stop(self) -> None:
        with self._locks.action, self._locks.drawing:
            if self._work.stop():
                self._dock.say(STOPPED)
            self._possible()

    def _choose(self, n: int) -> None:
        """A box was pressed: it is the one that counts."""
        with self._locks.action, self._locks.drawing:
            if self._look is None or not 0 <= n < len(self._look.seen.sighted):
                return
            self._look, self._shown = self._look.choosing(n), n
            self._show()

    def use(self, place: int | None) -> None:
        """Take the sighting as if its numbers were typed.

        place : the observation that it takes the place of, from 0; None: it is one more
        """
        with self._locks.action:
            made = self._made()
            if made is None:
                return
            before = self._state.inputs
            seen = list(before.observations)
            if place is not None and place < len(seen):
                seen[place] = made
            else:
                seen.append(made)
            others = [one for one in before.pool if not isinstance(one, Observation)]
            choice: Choice = "all" if before.choice == "all" else "sighting"
            inputs = before.knowing((*seen, *others), choice)
            with self._locks.drawing:
                if not self._inputs.show(inputs):
                    return
                self._inputs.follow(before, inputs)
                job = self._state.job(goal="candidates")
                self._state.update(goal=None if job is None else "candidates")
                self._history.note(self._state.snapshot(), LABEL)
            if job is not None:  # what it leaves of the window is seen at once
                self._runs.thread.request(job)

    def _made(self) -> Observation | None:
        """The observation that a person is looking at; None where there is none that can be used."""
        position = self._look.seen.position if self._look is not None else None
        at = self.sensors.place
        if position is None or at.observer is None or at.observed is None or self._cannot():
            return None
        try:
            return observation_of(position, at.observer, np.array(at.observed), at.heading)
        except MapMergeError as error:
            self._notices.report(error)
            return None

    # --- what the work tells ----------------------------------------------------------------------

    def part_done(self, part: str | Look) -> None:
        if isinstance(part, str):
            self._dock.say(part, 0.1)
            return
        self._look, seen = part, part.seen
        self._shown = seen.chosen if seen.chosen is not None else 0 if seen.sighted else None
        self._dock.say("")
        self._show()
        self._possible()

    def ended(self, why: str) -> None:
        if why:
            self._dock.fail(why)
        self._possible()

    def _setup_changed(self) -> None:
        """What was seen has nothing to do with other maps."""
        old, self._pair = self._pair, self._state.inputs
        if old.grids != self._pair.grids:
            with self._locks.drawing:
                self._work.stop()
                self._forget()
                self._possible()
        elif old is not self._pair:
            self._show()

    def _forget(self) -> None:
        self._look = self._shown = None
        self._dock.clear()

    def _sensors_changed(self) -> None:
        with self._locks.drawing:
            self._possible()
            self._show()

    # --- drawing ----------------------------------------------------------------------------------

    def _possible(self) -> None:
        seen = self._look is not None and not self.active
        busy = self._work.busy and self._look is None  # its process may take a while to end
        self._panel.possible(self.sensors.order() is not None, busy, seen)

    def _cannot(self) -> str:
        """Why the sighting cannot be used as all of it stands."""
        order = self.sensors.order()
        if order is None or self._order is None or not order.same_as(self._order):
            return STALE
        return self.sensors.unplaced

    def _show(self) -> None:
        with self._locks.drawing:
            found, palette = self._look, self._state.palette
            if found is None or not self.active:
                return
            seen, shown = found.seen, self._shown
            one = None if shown is None else seen.sighted[shown]
            scan = "" if found.view is None else scan_html(scan_svg(found.view, one, found.camera, palette))
            drawn = shown is not None and shown < len(found.gradients)
            there, cannot = seen.position is not None, self._cannot()
            self._dock.show(
                SightingPage(
                    outcome_text(seen),
                    "accepted" if there else "refused",
                    there and not cannot,
                    cannot,
                    cannot == STALE,
                    len(self._state.inputs.observations),
                    picture_html(found, shown, palette),
                    boxes_html(seen, shown, found.more),
                    scan,
                    gradients_html(found.gradients[shown]) if drawn and shown is not None else "",
                )
            )
