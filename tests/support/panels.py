"""Panels with what they are given on a page, for tests that use one alone."""

from __future__ import annotations

from collections.abc import Callable
from threading import RLock
from typing import Any

import viser

from app.drawing.browser_messages import BrowserMessages
from app.page.cancellable_task import CancellableTask
from app.page.panels.files_panel import FilesPanel
from app.page.panels.settings_panel import SettingsPanel


class Silent(BrowserMessages):
    """Messages to no browser."""

    def send(self, message: dict[str, Any]) -> None:
        """Let go of it."""


def files_panel(
    gui: viser.GuiApi,
    load: Callable[..., None],
    report: Callable[..., None],
    save: Callable[[str, bytes], None] = lambda name, content: None,
    task: CancellableTask | None = None,
) -> FilesPanel:
    task = task or CancellableTask(Silent(), RLock(), lambda yes: None)
    panel = FilesPanel(gui, "", save, RLock(), task)
    panel.connect(load, report)
    return panel


def settings_panel(
    gui: viser.GuiApi, changed: Callable[[], None], report: Callable[..., None]
) -> SettingsPanel:
    panel = SettingsPanel(gui, RLock())
    panel.connect(changed, report)
    return panel
