"""Panels with what they are given on a page, for tests that use one alone."""

from __future__ import annotations

from collections.abc import Callable
from threading import RLock
from typing import Any
from unittest.mock import Mock

import viser
from tabs import noting_tab

from algorithms.common.errors import MapMergeError
from app.drawing.browser_messages import BrowserMessages
from app.model.files.file_reader import upload_at
from app.model.merge_inputs import MergeInputs, Upload
from app.page.cancellable_task import CancellableTask
from app.page.files.files_controller import FilesController
from app.page.files.files_panel import FilesPanel
from app.page.panels.settings_panel import SettingsPanel


class Silent(BrowserMessages):
    """Messages to no browser."""

    def send(self, message: dict[str, Any]) -> None:
        """Let go of it."""


class FilesDesk:
    """The folder of maps, with what came of it: pairs and their labels, errors, files saved and sightings."""

    def __init__(self, gui: viser.GuiApi, task: CancellableTask | None = None) -> None:
        self.loaded: list[MergeInputs] = []
        self.labels: list[str] = []
        self.reports: list[MapMergeError] = []
        self.saved: dict[str, bytes] = {}
        self.seen: list[Upload] = []
        self.tab = noting_tab()
        panels = self.tab.panels
        self.panel = FilesPanel(gui, "", self.saved.__setitem__, self.tab.state.locks.action)
        panels.files = self.panel  # type: ignore[misc]
        panels.task = task or CancellableTask(Silent(), RLock(), lambda yes: None)  # type: ignore[misc]
        self.tab.notices.report = self.reports.append  # type: ignore[method-assign]
        self.fleet = Mock(shown=None)
        self.projects = Mock()
        self.controller = FilesController(self.tab, self.load, self.fleet, self.seen.append, self.projects)

    def load(self, inputs: MergeInputs, label: str) -> None:
        """As the page does it."""
        self.tab.state.update(inputs=inputs, files=self.panel.files)
        self.loaded.append(inputs)
        self.labels.append(label)

    @property
    def inputs(self) -> MergeInputs:
        return self.loaded[-1]

    def open(self, files: dict[str, bytes]) -> None:
        """Give these files at once, by their paths."""
        self.controller.open([upload_at(path, content) for path, content in files.items()])

    def press(self, what: str, n: int = 0) -> None:
        """Press a button of the list."""
        self.controller._change(what, n)


def settings_panel(
    gui: viser.GuiApi, changed: Callable[[], None], report: Callable[..., None]
) -> SettingsPanel:
    panel = SettingsPanel(gui, RLock())
    panel.connect(changed, report)
    return panel
