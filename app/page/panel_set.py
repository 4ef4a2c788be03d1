"""All panels of a tab."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

import viser

from app.drawing.browser_messages import BrowserMessages
from app.page.cancellable_task import CancellableTask
from app.page.editing.correction_panel import CorrectionPanel
from app.page.editing.knowledge_panel import KnowledgePanel
from app.page.editing.names_panel import NamesPanel
from app.page.editing.transform_panel import TransformPanel
from app.page.export.export_panel import ExportPanel
from app.page.files.files_panel import FilesPanel
from app.page.fleet.fleet_panel import FleetPanel
from app.page.lesson.lesson_panel import LessonPanel
from app.page.lesson.museum.museum_panel import MuseumPanel
from app.page.live.live_panel import LivePanel
from app.page.live.network_panel import NetworkPanel
from app.page.page_state import PageState
from app.page.panels.charts_panel import ChartsPanel
from app.page.panels.run_panel import RunPanel
from app.page.panels.settings_panel import SettingsPanel
from app.page.panels.what_if_panel import WhatIfPanel
from app.page.research.comparison_panel import ComparePanel
from app.page.research.sweep_panel import SweepPanel
from app.page.sighting.sensors_panel import SensorsPanel
from app.page.sighting.sighting_dock import SightingDock
from app.page.undo.history_panel import HistoryPanel
from app.web.download import DOWNLOADS


class Panels:
    """Widgets; controllers connect them.

    turned  : a person turned to another page of the charts
    network : robots that run are looked for
    """

    def __init__(
        self,
        client: viser.ClientHandle,
        state: PageState,
        messages: BrowserMessages,
        sample: str,
        turned: Callable[[], None],
        network: bool = False,
    ) -> None:
        gui = client.gui
        gui.set_panel_label("mapmeld")
        gui.main_panel.dock_right()
        self.run = RunPanel(gui)
        self.task = CancellableTask(messages, state.locks.drawing, partial(self.run.stoppable, "task"))
        self.send = partial(DOWNLOADS.send, client)
        self.files = FilesPanel(gui, sample, self.send, state.locks.action)
        self.live = LivePanel(gui)
        self.network = NetworkPanel(gui, network)
        self.fleet = FleetPanel(gui)
        self.names = NamesPanel(gui)
        self.knowledge = KnowledgePanel(gui)
        self.sensors = SensorsPanel(gui)
        self.settings = SettingsPanel(gui, state.locks.action)
        self.export = ExportPanel(client, self.task)
        self.what_if = WhatIfPanel(gui, lambda: state.config.verdict)
        self.transform = TransformPanel(gui)
        self.correction = CorrectionPanel(gui)
        self.history = HistoryPanel(gui)
        self.charts = ChartsPanel(client, turned)
        with self.charts.add_tab("Compare", viser.Icon.SCALE):
            self.comparison = ComparePanel(gui)
        with self.charts.add_tab("Sweep", viser.Icon.CHART_DOTS):
            self.sweep = SweepPanel(gui)
        self.lesson = LessonPanel(gui)
        self.museum = MuseumPanel(gui)
        self.sighting = SightingDock(client)

    def show_method(self, method: str, config: Any, seed: int) -> None:
        """Show these settings, and load nothing."""
        self.settings.restore(method, config)
        self.run.restore(method, seed)
