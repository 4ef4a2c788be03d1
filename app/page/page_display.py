"""Draws the state of a tab: its pictures, the words above them, and its panels."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import AbstractContextManager
from typing import Any

import viser

from algorithms.common.errors import NoAnswerError
from algorithms.common.robot_names import UNNAMED
from algorithms.methods.merge_result import MergeResult
from algorithms.methods.steps import AugmentDetail, PlaneDetail
from algorithms.verdict.contradictions import Contradictions
from app.drawing.browser_messages import BrowserMessages
from app.drawing.legend import fleet_legend, in_hand, legend
from app.drawing.palette import LIGHT
from app.drawing.scene import frame_symbols
from app.drawing.scene.tab_views import Views
from app.drawing.scene_layout import Rect, SceneLayout
from app.model import status_text, verdict_text
from app.model.view_modes import HEIGHTS, MAP, SWARM
from app.page.page_state import PageState
from app.page.panel_set import Panels
from app.page.panels.html_widgets import box
from app.page.panels.result_panel import result_html
from app.page.panels.suggestions_html import SuggestionPictures
from app.report.ros_transform import parent_of

LARGE = 2_000_000  # cells of a map that takes a while to draw


class PageDisplay:
    """Of one tab; whoever calls holds the drawing lock."""

    def __init__(
        self,
        client: viser.ClientHandle,
        state: PageState,
        views: Views,
        panels: Panels,
        messages: BrowserMessages,
    ) -> None:
        self._client, self._state, self._panels = client, state, panels
        self.views, self.messages = views, messages
        self._suggestions = SuggestionPictures()

    def together(self) -> AbstractContextManager[None]:
        """What is drawn in this context is seen at once."""
        return self._client.atomic()

    # --- inputs -----------------------------------------------------------------------------------

    def show_inputs(self, layout: SceneLayout) -> None:
        """Both maps side by side, as they were loaded."""
        state, panels, inputs = self._state, self._panels, self._state.inputs
        names = self.messages.names = inputs.names
        self.messages.hud(names=None if names == UNNAMED else [names.ref, names.mov])
        panels.charts.name(names)
        panels.transform.offer(inputs.complete, names)
        panels.files.extendable(len(inputs.grids) == len(inputs.maps) and state.fleet is None)
        panels.knowledge.show(inputs, inputs.chosen_prior)
        panels.charts.clear()
        self.views.heights.hide()
        self.views.comparison.clear()
        if any(grid.cells.size >= LARGE for grid in inputs.grids):
            self.messages.hud(state="Drawing the maps.", mood="running", progress=0.6)
            self.messages.flush()
        self.views.map.load(inputs, layout, state.palette)
        self.show_view()
        self.views.map.apart()
        self.clear_read_out()
        panels.settings.resolutions(*(grid.resolution for grid in inputs.grids))
        panels.run.merge.disabled = not inputs.complete
        panels.export.offer(None)
        panels.what_if.offer(None)
        doubt = inputs.doubt()
        ready = status_text.READY if inputs.known else status_text.READY_FOR_ALL
        self.messages.hud(
            case=inputs.title,
            state=" ".join(filter(None, (inputs.missing(), doubt))) or ready,
            mood="refused" if doubt else "idle",
            progress=None,
            frames=layout.frames(),
            measure=bool(inputs.grids),
            legend=legend(state.palette, MAP, state.run),
        )

    # --- a run ------------------------------------------------------------------------------------

    def show_step(self, live: bool, follow: bool) -> None:
        """The newest step of a run.

        live   : the run is shown step by step, not only its end
        follow : turn to the charts of the stage at hand
        """
        run = self._state.run
        with self.together():
            if live or self._state.view == SWARM:
                self.draw(live=live)
            self._panels.charts.show(run, follow=follow)
            self.messages.hud(
                pressed=self._pressed(),
                state=status_text.sentence(run),
                mood="running",
                progress=status_text.progress(run),
            )
            self.messages.flush()

    def show_candidates(self) -> None:
        """What a changed setting does, up to the candidates; the maps stay where they lie."""
        state = self._state
        self._panels.charts.show(state.run, follow=False)
        if state.view == MAP:
            self.views.run.preview(state.run, state.run.config)
            self.messages.hud(legend=legend(state.palette, MAP, state.run, preview=True))
        elif state.view == HEIGHTS:
            self.draw(live=False)
        self.messages.hud(state=status_text.UP_TO_DATE, mood="idle", progress=None)

    def show_answer(self, result: MergeResult, html: str, live: bool) -> None:
        """An answer and everything that led to it."""
        state, panels = self._state, self._panels
        panels.charts.show(state.run, follow=True)
        panels.charts.tell(html)
        panels.export.offer(state.files_of(result))
        panels.what_if.offer(result, state.inputs.names)
        self.draw(live=live)
        self.views.comparison.offer(state.contradictions, state.palette)
        self.messages.hud(mood=verdict_text.mood(result.verdict), progress=None)
        self._say_verdict(result)

    def show_no_answer(self, error: NoAnswerError) -> None:
        """The method found no transform: the maps go back to where they were, with the reason."""
        with self.together():
            self.views.comparison.clear()
            self._panels.export.offer(None)
            self._panels.what_if.offer(None)
            self._panels.charts.show(self._state.run, follow=True)
            self._panels.charts.tell(box(self.messages.names.told(str(error)), "refused"))
            self.views.map.apart()
            self.draw(live=False)
            self.messages.hud(state=str(error), mood="refused", progress=None)
            self.messages.flush()

    def show_result_text(self, result: MergeResult | None, faded: bool = False) -> None:
        """The numbers of a result; faded where it is out of date."""
        state = self._state
        if result is not None:
            html = self.result_html(result, state.result_config, state.contradictions, faded)
            self._panels.charts.tell(html)

    def result_html(
        self, result: MergeResult, config: Any, found: Contradictions | None, faded: bool = False
    ) -> str:
        """The page of a result; arguments as in result_panel."""
        inputs = self._state.inputs
        suggestions = self._suggestions.html(result, inputs, self._state.palette)
        return result_html(result, inputs, config, found, faded, suggestions, self._state.corrections)

    def mark_outdated(self) -> None:
        """A setting was changed after the result was found."""
        if self._state.result is not None:
            self.show_result_text(self._state.result, faded=True)
            self.views.comparison.outdate()
            self._panels.export.outdate()

    def withdraw_result(self) -> None:
        """The maps no longer lie as they were found: nothing of the result can be taken."""
        self.show_result_text(self._state.result, faded=True)
        self.messages.layer("frame", None)
        self._panels.export.offer(None)
        self._panels.what_if.offer(None)

    def _say_verdict(self, result: MergeResult) -> None:
        """The verdict; over the swarm whether it found the proven optimum, and the verdict's first word."""
        found, reason = status_text.found_it(self._state.run), result.verdict.reason
        if result.by_person:
            reason = verdict_text.of_hand(result, taken=True)
        if found and self._state.view == SWARM:
            reason = f"{found} {reason.split(':')[0]}."
        self.messages.hud(state=status_text.typeset(reason))

    # --- views ------------------------------------------------------------------------------------

    def draw(self, live: bool, look: bool = False) -> None:
        """The run in the chosen view; ``look``: the camera goes there, too."""
        state, view = self._state, self._state.view
        if view == MAP:
            self.views.run.show(state.run, state.config, self._panels.run.follow or look, live)
        elif view == HEIGHTS:
            self.views.heights.show(state.run.get(AugmentDetail), state.palette, look)
        else:
            self.views.swarm.show(state.run, state.palette, look)
        self.show_frame()
        self.messages.hud(pressed=self._pressed())
        self.show_legend()

    def show_frame(self) -> None:
        """The axes of the frame that the merged map is given away in, where it is not map 1's."""
        state, result = self._state, self._state.run.get(MergeResult)
        items = None
        if state.view == MAP and result is not None and state.export.frame != "ref":
            T, name = state.export.in_ref(result.T_ref_mov), parent_of(state.export, state.inputs.names)
            items = frame_symbols.axes(T, self.views.map.layout, state.palette, name)
        self.messages.layer("frame", items)

    def show_view(self, draw_map: Callable[[], None] | None = None, extent: Rect | None = None) -> None:
        """The chosen view of the newest state.

        draw_map : draws the map where a mode does
        extent   : of what it draws; None: of both maps
        """
        state, view = self._state, self._state.view
        self._panels.run.view = view
        self.views.map.visible(view == MAP)
        if view != HEIGHTS:
            self.views.heights.hide()
        if view != SWARM:
            self.views.swarm.hide()
        if view == MAP and draw_map is not None:
            self.messages.look_down(extent or self.views.map.extent())
            draw_map()
            self.messages.hud(pressed=self._pressed())
            self.show_legend()
        else:
            self.draw(live=False, look=True)
        result = state.run.get(MergeResult)
        if result is not None and self.messages.mood in verdict_text.MOODS.values():
            self._say_verdict(result)
        self.messages.flush()

    def show_legend(self) -> None:
        """What the colours of the picture mean."""
        state, mode = self._state, self.views.comparison.mode
        if self.views.fleet.drawn and state.fleet is not None:
            self.messages.hud(legend=fleet_legend(state.palette, state.fleet.robots))
        elif state.hand is not None and state.view == MAP and mode == "overlay":
            self.messages.hud(legend=in_hand(state.palette))
        else:
            self.messages.hud(legend=legend(state.palette, state.view, state.run, mode=mode))

    def show_lesson_step(self, look: bool, turn: float | None) -> None:
        """A run on the map, as far as a step of the lesson goes; ``turn``: of map 2 beside map 1."""
        state, maps, run = self._state, self.views.map, self._state.run
        if state.view != MAP:
            self.draw(live=False)
        elif run.reached(AugmentDetail) or run.reached(PlaneDetail):
            self.views.run.show(run, state.config, camera=look, live=True)
        else:
            maps.apart()
        if turn is not None and state.view == MAP:
            maps.turned(turn)

    def clear_read_out(self) -> None:
        """What was read out at a click goes: the picture is another."""
        self.messages.hud(readout="")
        self.messages.layer("readout", None)

    def show_buttons(self) -> None:
        """Which button of each group is the chosen one."""
        self.messages.hud(pressed=self._pressed())
        self.messages.flush()

    def _pressed(self) -> list[str]:
        return [*self._panels.run.pressed, self._panels.charts.page]

    def show_research(self, yes: bool) -> None:
        """Show all settings, the stages and the comparisons, or only what operators need."""
        panels = self._panels
        for panel in (panels.run, panels.settings, panels.what_if, panels.charts):
            panel.research(yes)
        self.messages.hud(research=yes)
        self.show_buttons()

    # --- colours ----------------------------------------------------------------------------------

    def show_theme(self) -> None:
        palette = self._state.palette
        self._client.gui.configure_theme(
            show_logo=False,
            show_share_button=False,
            control_width="medium",
            dark_mode=palette.dark,
            brand_color=LIGHT.ref,
        )
        self.messages.theme(palette)

    def recolour(self) -> None:
        state = self._state
        self.show_theme()
        self.views.map.recolour(state.palette, state.run)
        self.views.comparison.recolour(state.palette)
