"""One tab of the page: makes its parts and connects them."""

from __future__ import annotations

from functools import partial
from pathlib import Path

import viser

from app.jobs.worker_pool import COMMON
from app.model.merge_inputs import MergeInputs
from app.page.cancellable_task import DownloadTask
from app.page.editing.map_drag_controller import MapDragController
from app.page.editing.placement_controller import PlacementController
from app.page.inputs_controller import InputsController
from app.page.lesson.lesson_controller import LessonController
from app.page.lesson.lesson_texts import lesson_folder
from app.page.lesson.museum_controller import MuseumController
from app.page.modes import ModeSwitch
from app.page.notices import Notices
from app.page.page_display import PageDisplay, Views
from app.page.page_state import PageState
from app.page.panel_set import Panels
from app.page.research.comparison_controller import ComparisonController
from app.page.research.other_result_controller import OtherResultController
from app.page.research.sweep_controller import SweepController
from app.page.run_controller import RunController
from app.page.undo_controller import UndoController
from app.page.undo_history import SavedTab, UndoHistory
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

    first  : what a new tab opens with
    store  : where a tab leaves what it finds again
    lesson : folder of the lesson's texts; None for those that come along
    """

    def __init__(
        self,
        client: viser.ClientHandle,
        first: MergeInputs,
        store: SessionStore[SavedTab],
        uploads: Uploads,
        quota: CellQuota,
        lesson: Path | None = None,
    ) -> None:
        self._client, self._first, self._store, self._uploads = client, first, store, uploads
        self._key = ""  # of what it leaves in the store
        self._state = state = PageState()
        self._modes, self._history = modes, history = ModeSwitch(), UndoHistory()
        messages = TabMessages(client)
        self._events = events = BrowserEvents(client.gui, messages)
        self._panels = panels = Panels(
            client, state, messages, first.name, turned=lambda: self._display.show_buttons()
        )
        views = Views(client, messages)
        self._display = display = PageDisplay(client, state, views, panels, messages)
        display.show_theme()
        notices = Notices(client, messages, state.locks)
        stop_upload = partial(uploads.stop, client.client_id)
        common = state, display, panels
        runs = RunController(*common, modes, history, notices, COMMON.bench(), stop_upload)
        self._inputs = inputs = InputsController(*common, modes, history, runs, notices, quota)
        self._undo = undo = UndoController(*common, modes, history, runs, inputs, events)
        self._view = ViewController(client, *common, modes, events)
        zoom = ZoomController(events, messages, views.map.ground, state.locks)
        drag = MapDragController(*common, modes, undo, runs, notices, events)
        PlacementController(*common, modes, undo, runs, inputs, events)
        folder = lesson or lesson_folder()
        teaching = LessonController(*common, modes, undo, runs, notices, folder)
        museum = MuseumController(*common, modes, undo, inputs, runs, notices)
        panels.run.connect_learn(teaching.toggle, museum.toggle)
        others = OtherResultController(*common, modes, undo, runs, notices, events)
        deliver = DownloadTask(client, panels.task)
        self._comparison = ComparisonController(state, panels.comparison, events, others, deliver)
        self._sweep = SweepController(state, panels.sweep, messages, events, runs, deliver)
        self._parts = inputs, events, teaching, drag, self._comparison, self._sweep, zoom, runs.thread
        uploads.welcome(client.client_id, Recipient(partial(panels.run.stoppable, "sending"), notices.report))
        events.on("unsend", stop_upload)
        # the dock of the charts gets its width when that of the lesson, beside which it came, is gone
        events.on("left", lambda: None if teaching.open else panels.charts.visible(True))
        events.on("hello", self._greet, key=str, again=bool)
        messages.flush()  # the page says hello when it has read where to

    def _greet(self, key: str, again: bool) -> None:
        """The browser shows the page: what the tab left behind comes back; otherwise it begins."""
        state, panels = self._state, self._panels
        with state.locks.action:
            if state.closed or self._key:  # a page says so once
                return
            self._key, saved = self._store.enter(key, again, self._leave)
            self._display.messages.remember(self._key)
            if saved is None:
                self._inputs.load(self._first)
                return
            panels.run.dark, panels.run.speed = saved.dark, saved.speed
            self._display.show_buttons()
            self._history.take_over(saved.steps, saved.position)
            self._undo.restore_current()
            with state.locks.drawing:
                self._comparison.resume(saved.comparison)
                self._sweep.resume(saved.sweep)

    def close(self) -> None:
        """The tab is gone; what it leaves behind is kept for a while."""
        self._uploads.farewell(self._client.client_id)
        self._panels.task.stop()
        with self._state.locks.action:
            self._state.closed = True
            if self._key:
                self._store.leave(self._key)
            self._end()

    def _leave(self) -> SavedTab | None:
        self._end()
        if not self._history.steps:
            return None
        run, found, swept = self._panels.run, self._comparison.found, self._sweep.swept
        return SavedTab(self._history.steps, self._history.position, run.dark, run.speed, found, swept)

    def _end(self) -> None:
        for part in self._parts:
            part.close()
