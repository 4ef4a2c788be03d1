"""Another method's transform, looked at over map 1 in place of the page's own result."""

from __future__ import annotations

from dataclasses import replace

from algorithms.common.errors import MapMergeError
from algorithms.maps.map_fusion import Fusion
from algorithms.verdict.contradictions import Contradictions, find_conflicts
from app.model.run_state import RunState
from app.page.modes import Mode
from app.page.research.other_result import NOT_YOURS, OtherResult, verdict_mood
from app.page.run_controller import RunController
from app.page.tab import Tab
from app.page.undo.page_snapshot import PageSnapshot
from app.page.undo.undo_controller import UndoController
from app.system.cancellation import Cancelled


class OtherResultController:
    """Of one tab; ``state.other`` is what is looked at."""

    def __init__(self, tab: Tab, undo: UndoController, runs: RunController) -> None:
        self._state, self._display, self._panels = tab.state, tab.display, tab.panels
        self._modes, self._notices, self._undo, self._runs = tab.modes, tab.notices, undo, runs
        self._mode = tab.modes.add(Mode(self._end, resume=self._resume))
        tab.events.on("back", self.back)

    def look(self, other: OtherResult) -> None:
        """Show what a method has found; undo goes back."""
        with self._state.locks.action:
            self._modes.leave()
        self._runs.thread.stop()
        inputs = self._state.inputs
        try:
            with self._panels.task(f"Laying it over map 1: {other.title}.") as check:
                merged = self._merged_by(other)
                check()
        except Cancelled:
            return
        except MapMergeError as error:  # it throws the maps too far apart
            self._notices.report(error)
            return
        with self._state.locks.action, self._state.locks.drawing:
            snapshot = self._undo.history.snapshot
            if self._state.inputs is not inputs or snapshot is None:  # other maps have come meanwhile
                return
            self._undo.history.note(replace(snapshot, other=other), f"look at {other.title}")
            self._show(other, *merged)

    def back(self) -> None:
        """Show one's own result again, or the maps as they were."""
        with self._state.locks.action:
            snapshot = self._undo.history.snapshot
            if snapshot is not None and snapshot.other is not None:
                self._undo.go_to(replace(snapshot, other=None), "back to one's own")

    def _resume(self, snapshot: PageSnapshot, was_on: bool) -> bool:
        if snapshot.other is None:
            return False
        self._show(snapshot.other, *self._merged_by(snapshot.other))
        return True

    def _merged_by(self, other: OtherResult) -> tuple[RunState, Contradictions]:
        """The run that found it, and where the maps then contradict each other; raises TooLargeError."""
        i = self._state.inputs
        run = other.run(i.ref, i.mov, i.observations, self._state.run)
        return run, find_conflicts(run.get(Fusion))

    def _show(self, other: OtherResult, run: RunState, contradictions: Contradictions) -> None:
        """Draw it; whoever calls is drawing."""
        state, display, views = self._state, self._display, self._display.views
        self._modes.enter(self._mode)
        state.update(run=run, other=other)
        if state.turn_to_map():
            display.show_view()
        with display.together():
            views.run.show(run, other.config, camera=self._panels.run.follow, live=False)
            views.comparison.offer(contradictions, state.palette)
            self._panels.charts.tell(other.html(state.inputs.names))
            self._panels.export.outdate(NOT_YOURS)
            mood = "refused" if other.trial.right is False else verdict_mood(other.trial)
            display.messages.hud(state=other.sentence(), mood=mood, progress=None, guest=other.title)
            display.show_legend()
            display.messages.flush()

    def _end(self) -> None:
        """Something else is shown from now on."""
        with self._state.locks.drawing:
            self._state.update(other=None)
            self._display.messages.hud(guest="")
            self._display.messages.flush()
