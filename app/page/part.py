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
from app.drawing.browser_messages import Stage
from app.drawing.palette import Palette
from app.drawing.scene.height_view import HeightsView
from app.drawing.scene.map_comparison import Comparison
from app.drawing.scene.map_view import MapView
from app.drawing.scene.swarm_view import SwarmSpaceView
from app.jobs.job_thread import Session
from app.model.merge_inputs import Inputs
from app.model.merge_job import Job
from app.model.run_state import Story
from app.page.cancellable_task import Errand
from app.page.editing.map_drag_controller import ByHand
from app.page.editing.observation_panel import ObservationPanel
from app.page.editing.placement_controller import Placing
from app.page.lesson.lesson_controller import Lesson
from app.page.lesson.museum_controller import Museum
from app.page.page_snapshot import Desk
from app.page.panels.charts_panel import PlotDock
from app.page.panels.export_panel import ExportPanel
from app.page.panels.files_panel import FilesPanel
from app.page.panels.run_panel import RunPanel
from app.page.panels.settings_panel import TuningPanel
from app.page.panels.what_if_panel import WhatIfPanel
from app.page.undo_controller import Timeline
from app.web.browser_events import Channel


class Part(ABC):
    """One concern of a Page, which is made of several: each is the others' only through these names."""

    session: Session
    _client: viser.ClientHandle
    _stage: Stage
    _maps: MapView
    _heights: HeightsView
    _swarm: SwarmSpaceView
    _plots: PlotDock
    _comparison: Comparison
    _run: RunPanel
    _tuning: TuningPanel
    _export: ExportPanel
    _what_if: WhatIfPanel
    _timeline: Timeline
    _museum: Museum
    _palette: Palette
    _inputs: Inputs
    _story: Story
    _result: MergeResult | None
    _config: Any
    _conflicts: Contradictions | None
    _method: Story | None
    _hand: ByHand
    _placing: Placing
    _channel: Channel
    _observation: ObservationPanel
    _lesson: Lesson
    _merged: bool
    _asked: bool
    _turn: RLock
    _files: FilesPanel
    _errand: Errand
    _refining: tuple[ManualMerge, Pose2] | None

    @property
    def inputs(self) -> Inputs:
        """What is loaded."""
        return self._inputs

    @property
    def palette(self) -> Palette:
        """The colours of the page."""
        return self._palette

    @property
    def seed(self) -> int:
        """Where the luck of a run comes from."""
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
    def _show_inputs(self, inputs: Inputs) -> bool:
        """Show these inputs in place of everything there was."""

    @abstractmethod
    def _desk(self) -> Desk:
        """What is on the page."""

    @abstractmethod
    def _restore(self, desk: Desk) -> None:
        """Put a desk back."""

    @abstractmethod
    def _job(self, **how: Any) -> Job | None:
        """What a run would do now."""

    @abstractmethod
    def _answered(self, story: Story, result: MergeResult, config: Any, live: bool) -> None:
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
    def _draw(self, story: Story, live: bool, look: bool = False) -> None:
        """Draw a story in the chosen view."""

    @abstractmethod
    def _changed(self) -> None:
        """A setting was moved."""

    @abstractmethod
    def _farewell(self) -> bool:
        """Whoever else was looked at is not any more; whether there was anyone."""

    @abstractmethod
    def _refined(self, story: Story, result: MergeResult) -> None:
        """What the hand had refined has come out."""

    @abstractmethod
    def _research_changes(self) -> None:
        """A setting, the method or the seed is another."""

    @abstractmethod
    def _say(self, story: Story, result: MergeResult) -> None:
        """Say in a sentence what has come out."""

    @abstractmethod
    def _research_recolours(self) -> None:
        """Light has become dark, or the other way round."""
