"""Undo and redo of one tab: what is written down, what is shown of it, and what asks to go back."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from threading import RLock

import viser

from app.model.run_state import RunState
from app.page.page_snapshot import PageSnapshot, change, first_label
from app.page.panels.history_panel import HistoryPanel
from app.page.undo_history import UndoHistory, UndoStep
from app.web.browser_events import BrowserEvents


class UndoController:
    """Keeps the history and its folder.

    turn    : held while a person's wish is carried out, so that wishes come one after the other
    restore : puts a desk back on the page
    """

    def __init__(
        self, gui: viser.GuiApi, channel: BrowserEvents, turn: RLock, restore: Callable[[PageSnapshot], None]
    ) -> None:
        self._turn, self._restore = turn, restore
        self._panel = HistoryPanel(gui)
        self.history: UndoHistory | None = None  # before anything was on the page
        channel.on("step", self.step, by=int)
        channel.on("go", self.go, to=int)

    def resume(self, history: UndoHistory) -> None:
        """Go on where an earlier tab was."""
        with self._turn:
            self.history = history
            self._restore(history.desk)
            self._panel.show(history)

    def note(self, desk: PageSnapshot, label: str = "") -> bool:
        """Write down the desk after a wish; whether there is anything new about it.

        label : what was done; otherwise it is told by what has changed
        """
        if self.history is None:
            self.history = UndoHistory(UndoStep(label or first_label(desk), desk))
        else:
            found, kind = change(self.history.desk, desk)
            if not (found or label):
                return False
            self.history.record(label or found, desk, None if label else kind)
        self._panel.show(self.history)
        return True

    def amend(self, outcome: RunState) -> None:
        """What was asked for has come out."""
        if self.history is not None:
            self.history.amend(replace(self.history.desk, outcome=outcome))
            self._panel.show(self.history)

    def leave(self) -> None:
        """What was asked for is not wanted any more: whoever comes back to it finds what it began with."""
        desk = self.desk
        if self.history is not None and desk is not None and desk.outcome is None and not desk.held:
            self.history.amend(replace(desk, goal=None))

    @property
    def desk(self) -> PageSnapshot | None:
        """The desk at hand."""
        return None if self.history is None else self.history.desk

    def step(self, by: int) -> None:
        """Undo (−1) or redo (1)."""
        with self._turn:
            if self.history is not None:
                self.go(self.history.position + by)

    def go(self, to: int) -> None:
        """Go to an entry by its number; nowhere where there is none."""
        with self._turn:
            desk = self.history.go(to) if self.history is not None else None
            if self.history is not None and desk is not None:
                self._restore(desk)
                self._panel.show(self.history)
