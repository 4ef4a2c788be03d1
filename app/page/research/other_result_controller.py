"""The part of a page that compares methods and sweeps settings, and shows what another method has found."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import viser

from algorithms.common.errors import MapMergeError
from algorithms.maps.map_fusion import Fusion
from algorithms.methods.registry import METHODS
from algorithms.verdict.contradictions import Contradictions, find_conflicts
from app.model.run_state import RunState
from app.model.view_modes import MAP
from app.page.cancellable_task import DownloadTask
from app.page.part import Part
from app.page.research.comparison_controller import ComparisonController
from app.page.research.other_result import NOT_YOURS, OtherResult
from app.page.research.run_summary import verdict_mood
from app.page.research.sweep_controller import SweepController
from app.system.cancellation import Cancelled


class Researching(Part):
    """The part of a Page that compares and sweeps."""

    _guest: OtherResult | None = None  # who is looked at in place of one's own result

    def _research_with(self, gui: viser.GuiApi) -> None:
        """Add both tabs to the dock of the plots."""
        self._deliver = DownloadTask(self._client, self._task)
        both = self._turn, self.session.drawing
        with self._plots.add_tab("Compare", viser.Icon.SCALE):
            self._compare_tab = ComparisonController(gui, self._channel, *both, self)
        with self._plots.add_tab("Sweep", viser.Icon.CHART_DOTS):
            self._sweep_tab = SweepController(gui, self._channel, *both, self)
        self._channel.on("back", self.back)

    # --- what the tabs ask ------------------------------------------------------------------------

    @property
    def method(self) -> str:
        """The method of the panel."""
        return self._tuning.method

    def settings_for(self, method: str) -> Any:
        """As the sliders stand for the method of the panel, the defaults for others."""
        return self._tuning.config if method == self._tuning.method else METHODS[method].defaults

    def mark(self, measure: str) -> None:
        """Let the button of what the sweep is drawn by be seen to be the chosen one."""
        self._stage.hud(measure=measure)
        self._stage.flush()

    def load_settings(self, method: str, config: Any) -> None:
        """Put settings into the sliders, as if a person had moved them."""
        with self._turn:
            self._lesson.leave()
            self._tuning.restore(method, config)
            self._run.restore(method, self._run.seed)
            self._changed()

    def save(self, name: str, make: Callable[[], bytes]) -> None:
        """Send a file, once it is made."""
        self._deliver("Making the files: tables and pictures.", name, lambda _: make())

    # --- another method's transform over map 1 ----------------------------------------------------

    def look(self, guest: OtherResult) -> None:
        """Show what a method has found, in place of one's own result; undo goes back."""
        self._lesson.leave()
        self.session.stop()
        inputs = self._inputs
        try:
            with self._task(f"Laying it over map 1: {guest.title}.") as check:
                seen = self._merged_by(guest)
                check()
        except Cancelled:
            return
        except MapMergeError as error:  # it throws the maps too far apart
            self._report(error)
            return
        with self._turn, self.session.drawing:
            if self._inputs is not inputs:  # other maps have come meanwhile
                return
            self._hand.end()
            self._placing_done()
            desk = self._timeline.desk
            if desk is not None:
                self._timeline.note(replace(desk, guest=guest), f"look at {guest.title}")
                self._welcome(guest, *seen)

    def back(self) -> None:
        """Show one's own result again, or the maps as they were."""
        with self._turn:
            desk = self._timeline.desk
            if desk is not None and desk.guest is not None:
                own = replace(desk, guest=None)
                self._timeline.note(own, "back to one's own")
                self._restore(own)

    def _merged_by(self, guest: OtherResult) -> tuple[RunState, Contradictions]:
        """What it would have told, and where the maps then contradict each other; raises TooLargeError."""
        i = self._inputs
        assert i.ref is not None
        assert i.mov is not None
        story = guest.story(i.ref, i.mov, i.observations, self._story)
        fusion = story.get(Fusion)
        assert fusion is not None
        return story, find_conflicts(fusion)

    def _welcome(self, guest: OtherResult, story: RunState, found: Contradictions) -> None:
        """Draw it. Whoever calls is drawing."""
        self._story, self._guest = story, guest
        if self._run.view != MAP:
            self._run.view = MAP
            self._turn_view()
        with self._client.atomic():
            self._run_view.show(story, guest.config, camera=self._run.follow, live=False)
            self._comparison.offer(found, self._palette)
            self._plots.tell(guest.html())
            self._export.outdate(NOT_YOURS)
            mood = "refused" if guest.trial.right is False else verdict_mood(guest.trial)
            self._stage.hud(state=guest.sentence(), mood=mood, progress=None, guest=guest.title)
            self._tell_legend()
            self._stage.flush()
        self._compare_tab.shown(guest)

    def _farewell(self) -> bool:
        """Something else is shown from now on; whether a guest was. Whoever calls is drawing."""
        guest, self._guest = self._guest, None
        if guest is not None:
            self._stage.hud(guest="")
            self._compare_tab.shown(None)
        return guest is not None

    # --- what the page tells the tabs -------------------------------------------------------------

    def _research_changes(self) -> None:
        """Other inputs, settings, method or seed."""
        self._compare_tab.loaded(self._inputs)
        self._sweep_tab.loaded(self._inputs)

    def _research_recolours(self) -> None:
        """The page is dark, or light again."""
        self._compare_tab.recoloured()
        self._sweep_tab.recoloured()

    def _research_leaves(self) -> tuple[Any, Any]:
        """What both tabs have found, for this page when it comes back."""
        return self._compare_tab.found, self._sweep_tab.swept

    def _research_resumes(self, found: Any = None, swept: Any = None) -> None:
        """The page is back: so is what its tabs had found."""
        with self.session.drawing:
            self._compare_tab.resume(found)
            self._sweep_tab.resume(swept)

    def _research_closes(self) -> None:
        """The tab is gone."""
        self._compare_tab.close()
        self._sweep_tab.close()
