"""What the walls say of map 2 while a person moves it: colours at once, the verdict when it rests."""

from __future__ import annotations

from time import perf_counter

from algorithms.common.errors import MapMergeError
from algorithms.common.pose import Pose2
from algorithms.methods.manual_merge import ManualMerge
from algorithms.verdict.cell_agreement import WallLookup
from app.jobs.latest_request import LatestRequest
from app.model import verdict_text
from app.model.view_modes import MAP
from app.page.editing.transform_panel import TransformPanel, weighed_html
from app.page.page_display import PageDisplay
from app.page.page_state import PageState
from app.page.panels.html_widgets import box

PATIENCE = 0.1  # seconds; weighing that takes longer waits until the hand rests
REST = 0.15  # seconds in which a hand that rests does not move


class LiveVerdict:
    """A thread that weighs the newest place of map 2."""

    def __init__(self, state: PageState, display: PageDisplay, panel: TransformPanel) -> None:
        self._state, self._panel = state, panel
        self._messages, self._maps = display.messages, display.views.map
        self._manual: ManualMerge | None = None
        self._walls: tuple[WallLookup, WallLookup] | None = None
        self._slow = 0.0  # seconds that weighing took last
        self._work = LatestRequest(self._weigh, "mapmeld-hand")

    def close(self) -> None:
        self._work.close()

    def weigh_on(self, manual: ManualMerge) -> None:
        """What transforms are weighed on from now on."""
        self._manual = manual
        problem = manual.problem
        if self._walls is None or (self._walls[0].grid, self._walls[1].grid) != (problem.ref, problem.mov):
            self._walls = WallLookup(problem.ref), WallLookup(problem.mov)

    def ask(self, at: Pose2, rests: bool) -> None:
        """Weigh map 2 with its anchor there, in the scene; rests: whether the hand lies still."""
        self._work.ask((at, rests))

    def drop(self) -> None:
        self._work.drop()

    def _weigh(self, wanted: tuple[Pose2, bool]) -> None:
        """The colours at once; the verdict with them where it is quick, and always where the hand rests."""
        at, rests = wanted
        state, manual, walls = self._state, self._manual, self._walls
        if manual is None or walls is None:
            return
        T = self._maps.layout.transform(at)
        ref, mov = walls
        agreement = ref.agreement_with(mov, T.inverse()), mov.agreement_with(ref, T)
        with state.locks.drawing:
            if state.hand is None or state.view != MAP:
                return
            self._maps.ground.touch(walls, agreement)
        if not rests and self._work.newer_within(REST if self._slow > PATIENCE else 0.0):
            return
        manual.value(T)  # what is made once for a pair of maps is not counted
        began = perf_counter()
        try:
            result = manual.weigh(T)
        except MapMergeError as error:
            self._show(box(state.inputs.names.told(str(error)), "refused"), str(error), "refused")
            return
        self._slow = perf_counter() - began
        found = state.search.answer if state.search is not None else None
        mood = verdict_text.mood(result.verdict)
        self._show(
            weighed_html(result, manual.config, found, state.inputs.names), verdict_text.of_hand(result), mood
        )

    def _show(self, html: str, words: str, mood: str) -> None:
        with self._state.locks.drawing:
            if self._state.hand is not None:
                self._panel.tell(html)
                self._messages.hud(state=words, mood=mood, progress=None)
                self._messages.flush()
