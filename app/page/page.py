"""One tab of the page: makes its parts and connects them."""

from __future__ import annotations

from functools import partial
from pathlib import Path

import viser

from algorithms.common.errors import MapMergeError
from app.drawing.scene.tab_views import Views
from app.jobs.worker_pool import COMMON
from app.live.watch.robot_network import RobotNetwork
from app.model.merge_inputs import MergeInputs
from app.model.view_modes import OPERATOR, RESEARCH
from app.page.cancellable_task import DownloadTask
from app.page.editing.correction_controller import CorrectionController
from app.page.editing.knowledge_controller import KnowledgeController
from app.page.editing.map_drag_controller import MapDragController
from app.page.editing.names_controller import NamesController
from app.page.editing.placement_controller import PlacementController
from app.page.editing.suggestion_controller import SuggestionController
from app.page.export.export_controller import ExportController
from app.page.files.files_controller import FilesController
from app.page.fleet.fleet_controller import FleetController
from app.page.inputs_controller import InputsController
from app.page.lesson.lesson_controller import LessonController
from app.page.lesson.lesson_texts import lesson_folder
from app.page.lesson.link_controller import LinkController
from app.page.lesson.museum.museum_controller import MuseumController
from app.page.live.live_controller import LiveController
from app.page.live.network_controller import NetworkController
from app.page.modes import ModeSwitch
from app.page.notices import Notices
from app.page.page_display import PageDisplay
from app.page.page_state import PageState
from app.page.panel_set import Panels
from app.page.project.project_controller import ProjectController
from app.page.research.comparison_controller import ComparisonController
from app.page.research.other_result_controller import OtherResultController
from app.page.research.sweep_controller import SweepController
from app.page.run_controller import RunController
from app.page.sighting.sighting_controller import SightingController
from app.page.tab import Tab
from app.page.undo.undo_controller import UndoController
from app.page.undo.undo_history import SavedTab, UndoHistory
from app.page.view_controller import ViewController
from app.page.zoom_controller import ZoomController
from app.web.browser_events import BrowserEvents
from app.web.cell_quota import CellQuota
from app.web.session_store import SessionStore
from app.web.tab_messages import TabMessages
from app.web.upload import Recipient, Uploads


class Page:
    """No event passes through it: they go from a widget or the browser to a controller, to the state, to the
    display.

    first  : what a new tab opens with: a pair, or a project at the place where it was left
    store  : where a tab leaves what it finds again
    lesson : folder of the lesson's texts; None for those that come along
    research : whether a browser that remembers no mode gets that of researchers
    network : in which robots that run are looked for; None: none is opened
    """

    def __init__(
        self,
        client: viser.ClientHandle,
        first: MergeInputs | SavedTab,
        store: SessionStore[SavedTab],
        uploads: Uploads,
        quota: CellQuota,
        lesson: Path | None = None,
        research: bool = False,
        network: RobotNetwork | None = None,
    ) -> None:
        self._research = research
        self._client, self._first, self._store, self._uploads = client, first, store, uploads
        self._key = ""  # of what it leaves in the store
        state, history, messages = PageState(), UndoHistory(), TabMessages(client)
        events, notices = BrowserEvents(client.gui, messages), Notices(client, messages, state.locks)
        sample = first.name if isinstance(first, MergeInputs) else ""
        turned = lambda: display.show_buttons()  # noqa: E731
        panels = Panels(client, state, messages, sample, turned, network is not None)
        views = Views(client, messages)
        display = PageDisplay(client, state, views, panels, messages)
        display.show_theme()
        self._tab = tab = Tab(state, display, panels, ModeSwitch(), history, notices, events)
        stop_upload = partial(uploads.stop, client.client_id)
        runs = RunController(tab, COMMON.runner(), stop_upload)
        self._inputs = inputs = InputsController(tab, runs, quota)
        self._undo = undo = UndoController(tab, runs, inputs)
        self._view = ViewController(tab, client)
        zoom = ZoomController(events, messages, views.map.ground, state.locks)
        drag = MapDragController(tab, undo, runs)
        SuggestionController(tab, drag)
        names = NamesController(tab, undo)
        ExportController(tab)
        CorrectionController(tab, self._view.compare)
        robots = PlacementController(tab, undo, runs, inputs)
        KnowledgeController(tab, undo, runs, inputs, robots.begin)
        seeing = SightingController(tab, runs, inputs)
        others = OtherResultController(tab, undo, runs)
        deliver = DownloadTask(client, panels.task)
        fleet = FleetController(tab, runs, inputs, quota, deliver, robots.begin)
        projects = ProjectController(tab, undo, deliver)
        files = FilesController(tab, inputs.load, fleet, seeing.sensors.take, projects)
        teaching = LessonController(tab, undo, runs, lesson or lesson_folder(), files.take_sample)
        LinkController(tab, teaching, files.take_sample)
        museum = MuseumController(tab, undo, runs, inputs, fleet.merge_fleet)
        live = LiveController(tab, fleet)
        NetworkController(tab, live, fleet, network)
        panels.run.connect_learn(teaching.toggle, museum.toggle, live.demo)
        self._seeing = seeing
        self._comparison = ComparisonController(state, panels.comparison, events, others, deliver)
        self._sweep = SweepController(state, panels.sweep, messages, events, runs, deliver)
        research = self._comparison, self._sweep
        self._parts = (
            live,
            inputs,
            events,
            teaching,
            museum,
            drag,
            names,
            *research,
            seeing,
            zoom,
            fleet,
            runs.thread,
        )
        uploads.connect(client.client_id, Recipient(partial(panels.run.stoppable, "sending"), notices.report))
        events.on("unsend", stop_upload)
        # the dock of the charts gets its width when another, beside which it came, is gone
        events.on("left", lambda: teaching.open or seeing.active or panels.charts.visible(True))
        events.on("hello", self._greet, key=str, again=bool, mode=("", OPERATOR, RESEARCH))
        messages.flush()  # the page says hello when it has read where to

    def _greet(self, key: str, again: bool, mode: str) -> None:
        """The browser shows the page: what the tab left behind comes back; otherwise it begins.

        mode : that the browser remembers; empty where it remembers none
        """
        state, panels, history = self._tab.state, self._tab.panels, self._tab.history
        with state.locks.action:
            if state.closed or self._key:  # a page says so once
                return
            self._key, saved = self._store.enter(key, again, self._leave)
            self._tab.display.messages.remember(self._key)
            self._undo.keep = self._keep
            self._view.research(mode == RESEARCH if mode else self._research)
            if saved is None and isinstance(self._first, MergeInputs):
                self._inputs.load(self._first)
                return
            saved = saved or self._first
            panels.run.dark, panels.run.speed = saved.dark, saved.speed
            self._tab.display.show_buttons()
            history.take_over(saved.steps, saved.position)
            self._undo.restore_current()
            with state.locks.drawing:
                self._comparison.resume(saved.comparison)
                self._sweep.resume(saved.sweep)
                self._seeing.resume(saved.sighting)

    def close(self) -> None:
        """The tab is gone; what it leaves behind is kept for a while."""
        self._uploads.disconnect(self._client.client_id)
        self._tab.panels.task.stop()
        with self._tab.state.locks.action:
            self._tab.state.closed = True
            if self._key:
                self._store.leave(self._key)
            self._end()

    def _leave(self) -> SavedTab | None:
        self._undo.keep = lambda: None  # from here on it is for the tab that comes back to say what is kept
        self._end()
        return self._saved() if self._tab.history.steps else None

    def _saved(self) -> SavedTab:
        history, run = self._tab.history, self._tab.panels.run
        found, swept = self._comparison.found, self._sweep.swept
        left = self._seeing.left
        return SavedTab(history.steps, history.position, run.dark, run.speed, found, swept, left)

    def _keep(self) -> None:
        """What was done is to outlive the server, if it keeps anything."""
        try:
            self._store.keep(self._key, self._saved())
        except MapMergeError as error:
            self._tab.notices.report(error)

    def _end(self) -> None:
        for part in self._parts:
            part.close()
