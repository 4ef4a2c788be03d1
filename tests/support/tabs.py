"""A tab whose state, modes and history are real, and whose display, panels and browser only note calls."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import nullcontext
from types import SimpleNamespace
from typing import Any
from unittest.mock import MagicMock, Mock

from app.drawing.scene_layout import lay_out
from app.model.merge_inputs import MergeInputs
from app.page.modes import ModeSwitch
from app.page.notices import Notices
from app.page.page_state import PageState
from app.page.tab import Tab
from app.page.undo.undo_history import UndoHistory
from app.web.browser_events import BrowserEvents


class Settings(SimpleNamespace):
    """The sliders: they show what they are given, and are moved by ``move``."""

    def connect(self, changed: Callable[[], None], report: Callable[..., None]) -> None:
        self.changed = changed

    def move(self, config: Any) -> None:
        self.config = config
        self.changed()

    def sync(self) -> None:
        """Nothing was lost."""

    def choose(self, method: str) -> None:
        """Not asked for here."""


def noting_tab(inputs: MergeInputs | None = None) -> Tab:
    """A tab with these inputs, as if they had just been loaded."""
    state = PageState(inputs or MergeInputs())
    panels = MagicMock()
    panels.settings = Settings(method=state.method, config=state.config)
    panels.run = MagicMock(seed=0, pace=1.0)

    def show_method(method: str, config: Any, seed: int) -> None:
        panels.settings.method, panels.settings.config, panels.run.seed = method, config, seed

    panels.show_method = show_method
    panels.files.files = state.files
    display = MagicMock()
    display.together = nullcontext
    i = state.inputs
    display.views.map.layout = lay_out(i.ref, i.mov, i.at)
    history = UndoHistory()
    if i.grids:
        history.note(state.snapshot())
    return Tab(state, display, panels, ModeSwitch(), history, Mock(Notices), Mock(BrowserEvents))


def event(tab: Tab, name: str) -> Callable[..., None]:
    """What is called back when the browser tells of this."""
    return next(call.args[1] for call in tab.events.on.call_args_list if call.args[0] == name)
