"""Undo and redo: puts the page back as it was."""

from __future__ import annotations

from collections.abc import Callable

from app.page.inputs_controller import InputsController
from app.page.run_controller import RunController
from app.page.tab import Tab
from app.page.undo.page_snapshot import PageSnapshot


class UndoController:
    """Of one tab."""

    def __init__(self, tab: Tab, runs: RunController, inputs: InputsController) -> None:
        self._state, self._display, self._panels = tab.state, tab.display, tab.panels
        self._modes, self.history, self._runs, self._inputs = tab.modes, tab.history, runs, inputs
        self.keep: Callable[[], None] = lambda: None  # is called after every change of the history
        tab.history.changed = self._changed
        tab.events.on("step", self.step, by=int)
        tab.events.on("go", self.go, to=int)

    def _changed(self) -> None:
        self._panels.history.show(self.history)
        self.keep()

    def step(self, by: int) -> None:
        """Undo (−1) or redo (1)."""
        with self._state.locks.action:
            self.go(self.history.position + by)

    def go(self, to: int) -> None:
        """Go to a step by its number; nowhere where there is none."""
        with self._state.locks.action:
            snapshot = self.history.go(to)
            if snapshot is not None:
                self.restore(snapshot)

    def go_to(self, snapshot: PageSnapshot, label: str = "") -> None:
        """Put a snapshot on the page as a new step."""
        self.history.note(snapshot, label)
        self.restore(snapshot)

    def restore_current(self) -> None:
        """Put the page back as it is recorded."""
        if self.history.snapshot is not None:
            self.restore(self.history.snapshot)

    def restore(self, snapshot: PageSnapshot) -> None:
        """Put the page back: as it was, or worked out again where the outcome has been let go of."""
        state, s = self._state, snapshot
        self._runs.thread.stop()
        mode = self._modes.close()
        self._runs.set_method(s.method, s.config, s.seed)
        self._panels.files.show(s.files)
        with state.locks.drawing:
            bare = s.goal is None or (s.goal == "candidates" and state.result is not None)
            if s.inputs is not state.inputs or bare:
                self._inputs.show(s.inputs)
            if s.result is None:
                self._display.views.comparison.clear()
            state.update(
                goal=s.goal, files=s.files, fleet=s.fleet, export=s.export, corrections=s.corrections
            )
            if s.outcome is not None and s.result is not None:
                self._runs.show_answer(s.outcome, s.result, s.config, live=False)
                self._display.messages.flush()
            if not self._modes.resume(s, mode) and s.goal is not None and s.result is None:
                job = state.job(goal=s.goal)
                if job is not None:
                    self._runs.thread.request(job)
