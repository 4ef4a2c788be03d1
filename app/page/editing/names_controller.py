"""The names of the two robots, as a person types them: the page goes by them once the hands rest."""

from __future__ import annotations

from dataclasses import replace
from threading import Timer

from algorithms.common.errors import SettingError
from algorithms.common.robot_names import RobotNames
from app.page.tab import Tab
from app.page.undo.undo_controller import UndoController

REST = 0.5  # seconds without a letter, after which a name is taken


class NamesController:
    """Of one tab."""

    def __init__(self, tab: Tab, undo: UndoController) -> None:
        self._state, self._modes, self._panel, self._undo = tab.state, tab.modes, tab.panels.names, undo
        self._waiting: Timer | None = None
        self._panel.connect(self._typed)
        for topic in ("setup", "fleet"):
            tab.state.subscribe(topic, self._show)

    def close(self) -> None:
        if self._waiting is not None:
            self._waiting.cancel()

    def _show(self) -> None:
        self._panel.show(self._state.inputs.names, visible=self._state.fleet is None)

    def _typed(self) -> None:
        """A letter was typed: wait for the next."""
        self.close()
        self._waiting = Timer(REST, self.take)
        self._waiting.daemon = True
        self._waiting.start()

    def take(self) -> None:
        """Call the robots as it stands in the fields, as a step of its own."""
        state = self._state
        with state.locks.action:
            before = self._undo.history.snapshot
            if state.closed or state.fleet is not None or before is None:
                return
            try:
                names = RobotNames.of(*self._panel.typed)
            except SettingError as error:
                self._panel.tell(str(error))
                return
            self._panel.tell("")
            if names == before.inputs.names:
                return
            mode = self._modes.current
            self._undo.go_to(replace(before, inputs=replace(before.inputs, names=names)))
            if mode is not None and mode.reopen is not None:
                mode.reopen()
