"""One tab of the page: its inputs, panels and pictures around its session."""

from __future__ import annotations

import logging
from pathlib import Path
from threading import RLock
from typing import Any, Literal

import viser

from algorithms.common.errors import InputFileError, MapMergeError, TooLargeError
from algorithms.files.case_folder import Case
from algorithms.methods.merge_result import MergeResult
from algorithms.verdict.contradictions import Contradictions
from app.drawing.browser_messages import BrowserMessages
from app.drawing.legend import legend
from app.drawing.palette import LIGHT, Palette
from app.drawing.scene.height_view import HeightsView
from app.drawing.scene.map_comparison import MODES, MapComparison
from app.drawing.scene.map_view import MapView
from app.drawing.scene.run_view import RunView
from app.drawing.scene.swarm_view import SwarmView
from app.drawing.scene_layout import lay_out
from app.jobs import worker_pool as workers
from app.jobs.job_thread import JobThread
from app.model import status_text as words
from app.model.merge_inputs import MergeInputs
from app.model.merge_job import MergeJob
from app.model.run_state import RunState
from app.model.view_modes import MAP
from app.page.cancellable_task import CancellableTask
from app.page.editing.observation_panel import ObservationPanel
from app.page.handling import Handling
from app.page.learning import Learning
from app.page.page_snapshot import PageSnapshot
from app.page.panels.charts_panel import ChartsPanel
from app.page.panels.export_panel import ExportPanel
from app.page.panels.files_panel import FilesPanel
from app.page.panels.result_panel import result_html
from app.page.panels.run_panel import RunPanel, Wishes
from app.page.panels.settings_panel import SettingsPanel
from app.page.panels.what_if_panel import WhatIfPanel
from app.page.research.other_result_controller import Researching
from app.page.run_controller import Telling
from app.page.undo_controller import UndoController
from app.page.undo_history import SavedTab
from app.page.view_controller import Looking
from app.page.zoom_controller import ZoomController
from app.web.browser_events import BrowserEvents
from app.web.cell_quota import CellQuota
from app.web.download import DOWNLOADS
from app.web.session_store import SessionStore
from app.web.tab_messages import TabMessages
from app.web.upload import Recipient, Uploads

log = logging.getLogger(__name__)

LARGE = 2_000_000  # cells of a map that takes a while to draw


class Page(Looking, Telling, Handling, Learning, Researching):
    """Listens to its session and draws; the callbacks of its widgets only ask."""

    def __init__(
        self,
        client: viser.ClientHandle,
        initial: Case | None,
        keep: SessionStore,
        uploads: Uploads,
        lesson: Path | None = None,
        quota: CellQuota | None = None,
    ) -> None:
        self._client = client
        self._palette: Palette = LIGHT
        self._stage: BrowserMessages = TabMessages(client)
        self._channel = BrowserEvents(client.gui, self._stage)
        self._maps = MapView(client, self._stage)
        self._run_view = RunView(self._maps, self._stage)
        self._heights = HeightsView(client, self._stage)
        self._swarm = SwarmView(self._stage)
        self._comparison = MapComparison(self._stage, self._maps)
        self._inputs = MergeInputs()
        self._story = RunState()
        self._notice: viser.NotificationHandle | None = None
        self._result: MergeResult | None = None  # of the last run that came to its end
        self._conflicts: Contradictions | None = None  # of this result
        self._config: Any = None  # it ran with
        self._merged = False  # from the first Merge on, a moved slider runs the whole method again
        self._asked = False  # whether anything was asked for at all
        self._keep, self._key, self._gone = keep, "", False
        self._quota = quota or CellQuota()
        self._turn = RLock()  # wishes come one after the other; taken before session.drawing
        self.session = JobThread(self, workers.COMMON.bench())
        self._channel.on("compare", self._compare, mode=MODES)
        self._closer = ZoomController(self._channel, self._stage, self._maps.ground, self.session.drawing)
        self._task = CancellableTask(
            self._stage, self.session.drawing, lambda yes: self._run.stoppable("task", yes)
        )
        inputs = MergeInputs.of(initial) if initial else MergeInputs()
        self._build(inputs.name)
        self._uploads = uploads
        uploads.welcome(
            client.client_id, Recipient(lambda yes: self._run.stoppable("sending", yes), self._report)
        )
        self._channel.on("unsend", lambda: uploads.stop(client.client_id))
        self._learn_with(client.gui, lesson)
        self._channel.on("hello", lambda **who: self._greet(inputs, **who), key=str, again=bool)
        self._stage.flush()  # the page says hello when it has read where to

    def _greet(self, initial: MergeInputs, key: str, again: bool) -> None:
        """The page is there: what it left behind comes back; otherwise it begins."""
        with self._turn:
            if self._gone or self._key:  # a page says so once
                return
            self._key, kept = self._keep.enter(key, again, self._leave)
            self._stage.remember(self._key)
            if kept is None:
                self._load(initial)
            else:
                self._run.dark, self._run.speed = kept.dark, kept.speed
                self._press()
                self._timeline.resume(kept.history)
                self._research_resumes(*kept.research)

    def close(self) -> None:
        """The tab is gone; what it leaves behind is kept for a while."""
        self._uploads.farewell(self._client.client_id)
        self._task.stop()
        with self._turn:
            self._gone = True
            if self._key:
                self._keep.leave(self._key)
            self._end()

    def _leave(self) -> SavedTab | None:
        self._end()
        history = self._timeline.history
        if history is None:
            return None
        return SavedTab(history, self._run.dark, self._run.speed, self._research_leaves())

    def _end(self) -> None:
        self._quota.release(self)
        self._channel.close()
        self._lesson.close()
        self._hand.close()
        self._research_closes()
        self._closer.close()
        self.session.close()

    # --- widgets ----------------------------------------------------------------------------------

    def _build(self, chosen: str) -> None:
        client, gui = self._client, self._client.gui
        self._theme()
        gui.set_panel_label("mapmeld")
        gui.main_panel.dock_right()
        self._run = RunPanel(
            gui,
            Wishes(
                merge=self._merge,
                stop=self._stop,
                speed=self._set_speed,
                view=self._turn_view,
                method=lambda name: self._tuning.choose(name),
                changed=self._changed,
                fit=self._fit,
                dark=self._switch,
                learn=self._learn,
            ),
        )
        self._files = FilesPanel(gui, self._load, self._report, chosen, self._save, self._turn, self._task)
        self._observation = ObservationPanel(gui)
        self._tuning = SettingsPanel(gui, self._changed, self._report, self._turn)
        self._export = ExportPanel(client, self._task)
        self._what_if = WhatIfPanel(gui, lambda: self._tuning.config.verdict)
        self._handle_with(gui)
        self._timeline = UndoController(gui, self._channel, self._turn, self._restore)
        self._plots = ChartsPanel(client, self._press)
        self._research_with(gui)
        client.scene.on_click()(self._read_out)
        self._channel.on("resized", self._forget_place)

    # --- what a person asks for -------------------------------------------------------------------

    def _load(self, inputs: MergeInputs) -> None:
        """Show these inputs in place of everything there was."""
        self.session.stop()
        with self._turn:
            learning = self._lesson.open
            self._lesson.shut()
            with self.session.drawing:
                if self._show_inputs(inputs):
                    self._timeline.note(self._desk())
            if learning:
                self._lesson.enter()

    def _desk(self) -> PageSnapshot:
        """What is on the page, before anything has come of it."""
        tuning, goal = self._tuning, "merge" if self._merged else "candidates" if self._asked else None
        inputs, files, hand = self._inputs, self._files.files, self._hand.pose
        return PageSnapshot(inputs, files, tuning.method, tuning.config, self._run.seed, goal, hand)

    def _stop(self) -> None:
        """Leave what is read, or else what is run, or else what is on its way."""
        if self._task.stop():
            return
        if not self.session.busy:
            self._uploads.stop(self._client.client_id)
            return
        self.session.stop()  # at once, whatever else is being carried out
        with self._turn:
            self._timeline.leave()

    def _save(self, name: str, content: bytes) -> None:
        DOWNLOADS.send(self._client, name, content)

    def _restore(self, desk: PageSnapshot) -> None:
        """Put a desk back: as it was, or worked out again where that has been let go of."""
        self.session.stop()
        self._lesson.shut()
        self._hand.end()
        placing = self._placing.active and desk.outcome is None
        self._placing.end()
        self._tuning.restore(desk.method, desk.config)
        self._run.restore(desk.method, desk.seed)
        self._research_changes()
        self._files.restore(desk.files)
        with self.session.drawing:
            bare = desk.goal is None or (desk.goal == "candidates" and self._result is not None)
            if desk.inputs is not self._inputs or bare:
                self._show_inputs(desk.inputs)
            if desk.result is None:
                self._comparison.clear()
            self._merged, self._asked = desk.goal == "merge", desk.goal is not None
            if desk.outcome is not None and desk.result is not None:
                self._answered(desk.outcome, desk.result, desk.config, live=False)
                self._stage.flush()
            if desk.guest is not None:
                self._welcome(desk.guest, *self._merged_by(desk.guest))
            elif desk.held:
                self._hand.begin(desk.hand)
            elif desk.goal is not None and desk.result is None:
                job = self._job(goal=desk.goal)
                if job is not None:
                    self.session.request(job)
        if placing and desk.goal is None:  # who takes a step back while placing goes on placing
            self._placing.begin()

    def _show_inputs(self, inputs: MergeInputs) -> bool:
        if self._gone:
            return False
        self.session.stop()  # a run of others may have been asked for while this waited for its turn
        try:
            grids = [grid for grid in (inputs.ref, inputs.mov) if grid is not None]
            self._quota.claim(self, sum(grid.cells.size for grid in grids))
            layout = lay_out(inputs.ref, inputs.mov, inputs.at)
        except MapMergeError as error:
            self._report(error)
            return False
        self._hush()
        self._hand.end()
        self._placing.end()
        self._farewell()
        self._hand.panel.offer(inputs.complete)
        self._inputs, self._result, self._story, self._method = inputs, None, RunState(), None
        self._weighed = None
        self._merged = self._asked = False
        self._observation.show(inputs)
        self._plots.clear()
        self._heights.hide()
        self._comparison.clear()
        if any(grid is not None and grid.cells.size >= LARGE for grid in (inputs.ref, inputs.mov)):
            self._stage.hud(state="Drawing the maps.", mood="running", progress=0.6)
            self._stage.flush()
        self._maps.load(inputs, layout, self._palette)
        self._run.view = MAP
        self._turn_view()
        self._maps.apart()
        self._stage.layer("readout", None)
        self._tuning.resolutions(*(grid.resolution for grid in grids))
        self._run.merge.disabled = not inputs.complete
        self._export.offer(None)
        self._what_if.offer(None)
        self._files.placed(bool(inputs.observations))
        doubt = inputs.doubt()
        self._stage.hud(
            case=inputs.name,
            state=" ".join(filter(None, (inputs.missing(), doubt))) or words.READY,
            mood="refused" if doubt else "idle",
            progress=None,
            readout="",
            frames=layout.frames(),
            measure=bool(grids),
            legend=legend(self._palette, MAP, self._story),
        )
        self._research_changes()
        self._stage.flush()
        return True

    def _job(self, **how: Any) -> MergeJob | None:
        i = self._inputs
        if i.ref is None or i.mov is None or not i.observations:
            return None
        return MergeJob(
            i.ref,
            i.mov,
            i.observations,
            self._tuning.config,
            self._tuning.method,
            self._run.seed,
            **how,
        )

    def _merge(self) -> None:
        with self._turn, self.session.drawing:
            self._lesson.leave()
            self._tuning.sync()
            job = self._job(pace=self._run.pace, again=True)
            if job is None:
                return
            self._hand.end()
            self._placing_done()
            self._merged = self._asked = True
            desk, before = self._desk(), self._timeline.desk
            if before is None or before.outcome is None or not before.same_wish(desk):
                self._timeline.note(desk, "merge")
            self._plots.follow()
            self._stage.look_down(self._maps.layout.view(), follow=True)
            if self._run.view != MAP:
                self._turn_view()
            self.session.request(job)

    def _changed(self) -> None:
        """A setting was moved: what is on the screen is out of date."""
        self._research_changes()
        if self._lesson.open:
            self._lesson.changed()
            return
        with self._turn, self.session.drawing:
            live = self.session.telling and self._merged
            goal = "merge" if self._merged else "candidates"
            job = self._job(goal=goal, pace=self._run.pace if live else 0.0)
            self._asked = self._asked or job is not None
            if not self._timeline.note(self._desk()) or job is None:
                return
            if self._hand.active:
                self._hand.begin(self._hand.pose)
                return
            if self._placing.active:
                return
            if self._result is not None:
                told = result_html(self._result, self._inputs, self._config, self._conflicts, faded=True)
                self._plots.tell(told)
                self._comparison.outdate()
                self._export.outdate()
            self.session.request(job)

    def _set_speed(self) -> None:
        self.session.set_pace(self._run.pace or 0.01)  # a run that is told at a pace comes to its end so
        self._press()

    def _report(self, error: MapMergeError) -> None:
        """Tell the person what is wrong with an input, in this tab."""
        title = "Too large" if isinstance(error, TooLargeError) else "This cannot be used"
        said = str(error)
        if not isinstance(error, InputFileError):  # that begins with a file's name
            said = said[:1].upper() + said[1:]
        with self.session.drawing:
            self._notify(title, said, "orange")
            self._stage.hud(state=said, mood="failed", progress=None)
            self._stage.flush()

    def _notify(self, title: str, text: str, colour: Literal["orange", "red"]) -> None:
        """Show a notice in place of the last one."""
        self._hush()
        self._notice = self._client.add_notification(title, text, auto_close_seconds=12.0, color=colour)

    def _hush(self) -> None:
        """What the last notice said has been mended or overtaken."""
        if self._notice is not None:
            self._notice.remove()
            self._notice = None
