"""What the parts of a page have in common: its attributes, and what each part may ask of the others."""

from __future__ import annotations

from abc import ABC, abstractmethod
from threading import RLock
from typing import Any, Literal

import viser

from algorithms.common.errors import MapMergeError
from algorithms.common.pose import Pose2
from algorithms.methods.manual_merge import ManualMerge
from algorithms.methods.merge_result import MergeResult
from algorithms.verdict.contradictions import Contradictions
from app.drawing.browser_messages import BrowserMessages
from app.drawing.palette import Palette
from app.drawing.scene.height_view import HeightsView
from app.drawing.scene.map_comparison import MapComparison
from app.drawing.scene.map_view import MapView
from app.drawing.scene.run_view import RunView
from app.drawing.scene.swarm_view import SwarmView
from app.jobs.job_thread import JobThread
from app.model.merge_inputs import MergeInputs
from app.model.merge_job import MergeJob
from app.model.run_state import RunState
from app.page.cancellable_task import CancellableTask
from app.page.editing.map_drag_controller import MapDragController
from app.page.editing.observation_panel import ObservationPanel
from app.page.editing.placement_controller import PlacementController
from app.page.lesson.lesson_controller import LessonController
from app.page.lesson.museum_controller import MuseumController
from app.page.page_snapshot import PageSnapshot
from app.page.panels.charts_panel import ChartsPanel
from app.page.panels.export_panel import ExportPanel
from app.page.panels.files_panel import FilesPanel
from app.page.panels.run_panel import RunPanel
from app.page.panels.settings_panel import SettingsPanel
from app.page.panels.what_if_panel import WhatIfPanel
from app.page.undo_controller import UndoController
from app.web.browser_events import BrowserEvents


class Part(ABC):
    """One concern of a Page, which is made of several: each is the others' only through these names."""

    session: JobThread
    _client: viser.ClientHandle
    _stage: BrowserMessages
    _maps: MapView
    _run_view: RunView
    _heights: HeightsView
    _swarm: SwarmView
    _plots: ChartsPanel
    _comparison: MapComparison
    _run: RunPanel
    _tuning: SettingsPanel
    _export: ExportPanel
    _what_if: WhatIfPanel
    _timeline: UndoController
    _museum: MuseumController
    _palette: Palette
    _inputs: MergeInputs
    _story: RunState
    _result: MergeResult | None
    _config: Any
    _conflicts: Contradictions | None
    _method: RunState | None
    _hand: MapDragController
    _placing: PlacementController
    _channel: BrowserEvents
    _observation: ObservationPanel
    _lesson: LessonController
    _merged: bool
    _asked: bool
    _turn: RLock
    _files: FilesPanel
    _task: CancellableTask
    _refining: tuple[ManualMerge, Pose2] | None

    @property
    def inputs(self) -> MergeInputs:
        """What is loaded."""
        return self._inputs

    @property
    def palette(self) -> Palette:
        """The colours of the page."""
        return self._palette

    @property
    def seed(self) -> int:
        """Random seed of a run; the same seed gives the same answer."""
        return self._run.seed

    @abstractmethod
    def _report(self, error: MapMergeError) -> None:
        """Tell the person what is wrong."""

    @abstractmethod
    def _notify(self, title: str, text: str, colour: Literal["orange", "red"]) -> None:
        """Show a notice."""

    @abstractmethod
    def _hush(self) -> None:
        """Take it away again."""

    @abstractmethod
    def _turn_view(self) -> None:
        """Show the chosen view."""

    @abstractmethod
    def _tell_legend(self) -> None:
        """Say what the colours of the picture mean."""

    @abstractmethod
    def _show_inputs(self, inputs: MergeInputs) -> bool:
        """Show these inputs in place of everything there was."""

    @abstractmethod
    def _desk(self) -> PageSnapshot:
        """What is on the page."""

    @abstractmethod
    def _restore(self, desk: PageSnapshot) -> None:
        """Put a desk back."""

    @abstractmethod
    def _job(self, **how: Any) -> MergeJob | None:
        """What a run would do now."""

    @abstractmethod
    def _answered(self, story: RunState, result: MergeResult, config: Any, live: bool) -> None:
        """Show an answer."""

    @abstractmethod
    def _save(self, name: str, content: bytes) -> None:
        """Send a file."""

    @abstractmethod
    def _placing_done(self) -> None:
        """The robots are no longer being placed."""

    @abstractmethod
    def _press(self) -> None:
        """Show which buttons are the chosen ones."""

    @abstractmethod
    def _forget_place(self) -> None:
        """What was read out at a click goes."""

    @abstractmethod
    def _merge(self) -> None:
        """Merge what is loaded as it is set."""

    @abstractmethod
    def _draw(self, story: RunState, live: bool, look: bool = False) -> None:
        """Draw a story in the chosen view."""

    @abstractmethod
    def _changed(self) -> None:
        """A setting was moved."""

    @abstractmethod
    def _farewell(self) -> bool:
        """Whoever else was looked at is not any more; whether there was anyone."""

    @abstractmethod
    def _refined(self, story: RunState, result: MergeResult) -> None:
        """What the hand had refined has come out."""

    @abstractmethod
    def _research_changes(self) -> None:
        """A setting, the method or the seed is another."""

    @abstractmethod
    def _say(self, story: RunState, result: MergeResult) -> None:
        """Say in a sentence what has come out."""

    @abstractmethod
    def _research_recolours(self) -> None:
        """Light has become dark, or the other way round."""
