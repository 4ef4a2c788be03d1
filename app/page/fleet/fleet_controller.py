"""A fleet as a mode of the page: robots come and go, pairs are opened as two maps and put back."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from algorithms.common.errors import MapMergeError, SettingError
from algorithms.common.pose import FloatArray
from algorithms.files.fleet_archive import fleet_to_files
from algorithms.fleets.pair_hypotheses import PairFinding, PairOrder, finding_of
from algorithms.maps.grid_map import GridMap
from algorithms.observations.fleet import Fleet
from algorithms.observations.pair_problem import PairProblem
from app.model.fleet_state import FleetState
from app.model.merge_inputs import MergeInputs
from app.page.cancellable_task import DownloadTask
from app.page.fleet.fleet_display import FleetDisplay
from app.page.fleet.fleet_run_controller import STOPPED, FleetRunController
from app.page.inputs_controller import InputsController
from app.page.modes import Mode
from app.page.run_controller import RunController
from app.page.tab import Tab
from app.page.undo.page_snapshot import PageSnapshot
from app.report.fleet_files import fleet_files
from app.report.result_files import zip_bytes
from app.web.cell_quota import CellQuota

MAKING = "Making the fleet's files."


class FleetController:
    """Of one tab.

    quota        : is shared by all tabs
    deliver      : sends a file, once it is made
    place_robots : begins to place the robots of two maps by hand
    """

    def __init__(
        self,
        tab: Tab,
        runs: RunController,
        inputs: InputsController,
        quota: CellQuota,
        deliver: DownloadTask,
        place_robots: Callable[[], None],
    ) -> None:
        self._state, self._panel, self._locks = tab.state, tab.panels.fleet, tab.state.locks
        self._modes, self._history, self._notices = tab.modes, tab.history, tab.notices
        self._runs, self._inputs, self._quota = runs, inputs, quota
        self._deliver, self._place_robots = deliver, place_robots
        self.display = FleetDisplay(tab)
        self._run = FleetRunController(tab, self.display)
        self._mode = tab.modes.add(
            Mode(
                self._end,
                redraw=self.display.show,
                resume=self._resume,
                merge=self._merge,
                stop=self._stop,
                click=self._click,
                extent=lambda: self.display.extent,
            )
        )
        self._panel.connect(self._rename, self._anchor, self._remove, self._add_sighting)
        self._panel.connect_files(self._back, self._download, self._save)
        tab.panels.files.connect_fleet(self._begin)
        tab.events.on("fleet", self._pressed, what=("robot", "eye", "pair"), n=int)
        tab.state.subscribe("fleet", self._fleet_changed)

    def close(self) -> None:
        self._run.stop()
        self._quota.release(self)

    @property
    def shown(self) -> FleetState | None:
        """The fleet, where the page shows it."""
        return self._state.fleet if self._modes.current is self._mode else None

    # --- a fleet comes and goes -----------------------------------------------------------------------

    def load(self, fleet: Fleet, name: str) -> None:
        """Show a fleet in place of what is on the page, as an action of the person."""
        self.show(FleetState(fleet, name), f"load {name}")

    def merge_fleet(self, fleet: Fleet, name: str) -> None:
        """Show a fleet, and merge it."""
        with self._locks.action:
            self.load(fleet, name)
            self._merge()

    def _begin(self) -> None:
        """The two maps of the page become a fleet, with what was found of them; robots can be added."""
        with self._locks.action:
            i = self._state.inputs
            if i.ref is None or i.mov is None:
                return
            fleet = Fleet({i.names.ref: i.ref, i.names.mov: i.mov})
            opened = FleetState(fleet, i.name).open(PairOrder(i.names.ref, i.names.mov, ()))
            self._modes.leave()
            self.show(opened.closed(i.known, self._found_there(opened)), "make it a fleet")

    def show(self, state: FleetState, label: str) -> None:
        """Show that fleet in place of whatever there is, as a new step."""
        with self._locks.action, self._locks.drawing:
            if not self.claim(state):
                return
            self._runs.thread.stop()
            if self._inputs.show(MergeInputs(name=state.name)):
                self._modes.enter(self._mode)
                self._take(state, label)

    def _take(self, state: FleetState, label: str) -> None:
        """That is the fleet from now on; whoever calls is drawing."""
        if not self.claim(state):
            return
        self._state.update(fleet=state)
        self.display.show(look=True)
        self.display.say_outcome()
        self._history.note(self._state.snapshot(), label)

    def claim(self, state: FleetState) -> bool:
        """Whether there is room for its maps; where there is none, that is told."""
        try:
            self._quota.claim(self, sum(grid.cells.size for grid in state.fleet.maps.values()))
        except MapMergeError as error:
            self._notices.report(error)
            return False
        return True

    def _end(self) -> None:
        self._run.stop()
        with self._locks.drawing:
            self.display.hide()
            self._show_panel()

    def _resume(self, snapshot: PageSnapshot, was_on: bool) -> bool:
        """A step that showed a fleet shows it again."""
        state = snapshot.fleet
        if state is None or state.opened is not None or snapshot.inputs.grids:
            return False
        self._modes.enter(self._mode)
        self._show_panel()
        self.display.show(look=True)
        self.display.say_outcome()
        if state.again:
            self._run.begin(state)
        return True

    def _fleet_changed(self) -> None:
        if self._state.fleet is None:
            self._quota.release(self)
        self._show_panel()

    def _show_panel(self) -> None:
        self.display.show_panel(self.shown is not None)

    # --- what a person does with it ---------------------------------------------------------------------

    def _change(self, make: Callable[[FleetState], FleetState], label: str) -> bool:
        """Another fleet, and whether it can be: what cannot is told."""
        with self._locks.action, self._locks.drawing:
            state = self.shown
            if state is None:
                return False
            try:
                changed = make(state)
            except MapMergeError as error:
                self._notices.report(error)
                return False
            self._run.stop()
            self._take(changed, label)
            return True

    def add_robots(self, robots: Sequence[tuple[str, GridMap]]) -> None:
        """Robots more, by the names that they are to have as far as they can."""

        def with_all(state: FleetState) -> FleetState:
            for name, grid in robots:
                state = state.with_robot(name, grid)
            return state

        self._change(with_all, f"add {', '.join(name for name, _ in robots)}")

    def _rename(self, old: str, new: str) -> None:
        if new != old:
            self._panel.choose(new)
            if not self._change(lambda state: state.renamed(old, new), f"{old} → {new}"):
                self._panel.choose(old)
                self._show_panel()

    def _anchor(self, name: str) -> None:
        self._change(lambda state: state.anchored(name), f"anchor: {name}")

    def _remove(self, name: str) -> None:
        self._change(lambda state: state.without_robot(name), f"remove {name}")

    def _pressed(self, what: str, n: int) -> None:
        """A row of the lists was pressed."""
        with self._locks.action, self._locks.drawing:
            state = self.shown
            rows = () if state is None else state.orders if what == "pair" else state.robots
            if state is None or not 0 <= n < len(rows):
                return
            if what == "pair":
                self._open(state.orders[n])
            elif what == "robot":
                self._panel.choose(state.robots[n])
                self._show_panel()
            else:
                looked = state.toggled(state.robots[n])
                self._state.update(fleet=looked)
                self._history.amend_fleet(looked)
                self.display.show()

    def _click(self, place: FloatArray) -> None:
        """A click on a sighting's line opens its pair."""
        with self._locks.action:
            state, edge = self.shown, self.display.edge_at(place)
            if state is not None and edge is not None:
                self._open(next(each for each in state.orders if edge.number in each.sightings))

    # --- a pair in the page of two maps -----------------------------------------------------------------

    def _add_sighting(self, observer: str, observed: str) -> None:
        if observer == observed:
            self._notices.report(SettingError(f"{observer} cannot have seen itself; choose another robot"))
            return
        with self._locks.action:
            self._open(PairOrder(observer, observed, ()))
            self._place_robots()

    def _open(self, order: PairOrder) -> None:
        with self._locks.action, self._locks.drawing:
            state = self.shown
            if state is None:
                return
            self._modes.close()
            before, pair = self._state.inputs, state.pair(order)
            self._state.update(fleet=state.open(order))
            if self._inputs.show(pair):
                self._inputs.follow(before, pair)
            self._history.note(self._state.snapshot(), f"open {pair.name}")
            if state.finding(order) is not None and pair.complete:
                self._runs.merge()

    def _back(self) -> None:
        """From a pair back to the fleet, with what is known and was found of it there."""
        with self._locks.action:
            state, name = self._state.fleet, self._state.inputs.name
            if state is None or state.opened is None:
                return
            self._modes.leave()
            try:
                changed = state.closed(self._state.inputs.known, self._found_there(state))
            except MapMergeError as error:
                self._notices.report(error)
                return
            self.show(changed, f"back from {name}")
            if changed.result is None and changed.found:
                self._merge()

    def _found_there(self, state: FleetState) -> PairFinding | None:
        """What the result on the page says of the pair that is open; None where there is no result."""
        i, result, config = self._state.inputs, self._state.result, self._state.result_config
        if state.opened is None or result is None or i.ref is None or i.mov is None:
            return None
        return finding_of(state.opened, PairProblem.of(i.ref, i.mov, i.known), config, result)

    # --- the run, and files -------------------------------------------------------------------------------

    def _merge(self) -> None:
        with self._locks.action, self._locks.drawing:
            if (state := self.shown) is not None:
                self._run.begin(state)

    def _stop(self) -> bool:
        with self._locks.drawing:
            stopped = self._run.stop()
            if stopped:
                self.display.say(STOPPED, "stopped", None)
        return stopped

    def _download(self) -> None:
        state = self.shown
        if state is not None and state.result is not None:
            fleet, result, name = state.fleet, state.result, state.name
            make = lambda check: zip_bytes(fleet_files(fleet, result, name))  # noqa: E731
            self._deliver(MAKING, "fleet_result.zip", make)

    def _save(self) -> None:
        state = self.shown
        if state is not None:
            fleet = state.fleet
            self._deliver(MAKING, "fleet.zip", lambda check: zip_bytes(fleet_to_files(fleet)))
