"""The part of a page that is about how it is looked at: the view, the colours, what a click reads out."""

from __future__ import annotations

import numpy as np
import viser

from algorithms.methods.merge_result import MergeResult
from algorithms.methods.steps import RefineDetail
from app.drawing.draw_items import mark
from app.drawing.palette import DARK, LIGHT
from app.drawing.scene.map_layers import Mode
from app.model import verdict_text as words
from app.model.view_modes import HEIGHTS, MAP, SWARM
from app.page.part import Part

FAR = 1e6  # metres from the scene's origin; no map reaches there


class Looking(Part):
    """The part of a Page that shows what there is in one way or another."""

    def _press(self) -> None:
        """Let the page show which button of each group is the chosen one."""
        self._stage.hud(pressed=[*self._run.pressed, self._plots.page])
        self._stage.flush()

    def _read_out(self, event: viser.SceneClickEvent) -> None:
        """What is known of the place under a click."""
        if self._run.view != MAP:
            return
        (x, y, z), (right, up, along) = event.ray_origin, event.ray_direction
        if along == 0:  # never meets the floor
            return
        # viser's own frame is turned half round the y axis: see views/maps.py
        place = np.array([right * z / along - x, y - up * z / along])
        if not np.all(np.abs(place) < FAR):
            return
        self._stage.hud(readout=self._maps.read_out(place, self._story))
        self._stage.layer("readout", [mark("cross", place, self._palette.text, r=6)])
        self._stage.flush()

    def _forget_place(self) -> None:
        """What was read out at a click goes: the view is another."""
        self._stage.hud(readout="")
        self._stage.layer("readout", None)
        self._stage.flush()

    def _fit(self) -> None:
        if self._run.view != MAP:
            self._turn_view()
        else:
            placed = self._result is not None or self._hand.active or self._story.reached(RefineDetail)
            self._stage.look_down(self._maps.extent() if placed else self._maps.layout.view(), follow=True)
        self._stage.flush()

    def _compare(self, mode: Mode) -> None:
        """Look at both maps in another way."""
        with self.session.drawing:
            if self._run.view == MAP and self._comparison.choose(mode):
                if not self._hand.active:
                    self._run_view.show(self._story, self._tuning.config, camera=False, live=False)
                self._tell_legend()
                self._stage.flush()

    def _switch(self, dark: bool) -> None:
        with self.session.drawing:
            self._palette = DARK if dark else LIGHT
            self._theme()
            self._maps.recolour(self._palette, self._story)
            self._comparison.recolour(self._palette)
            self._turn_view()
            self._lesson.recolour()
            self._research_recolours()

    def _turn_view(self) -> None:
        """Show the chosen view of the newest state."""
        with self.session.drawing:
            view = self._run.view
            self._maps.visible(view == MAP)
            if view != HEIGHTS:
                self._heights.hide()
            if view != SWARM:
                self._swarm.hide()
            self._draw(self._story, live=False, look=True)
            result = self._story.get(MergeResult)
            if result is not None and self._stage.mood in words.MOODS.values():
                self._say(self._story, result)
            self._stage.flush()

    def _theme(self) -> None:
        self._client.gui.configure_theme(
            show_logo=False,
            show_share_button=False,
            control_width="medium",
            dark_mode=self._palette.dark,
            brand_color=LIGHT.ref,
        )
        self._stage.theme(self._palette)
