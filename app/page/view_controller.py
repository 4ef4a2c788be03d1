"""How the page is looked at: the view, the colours, the ways to compare, and what a click reads out."""

from __future__ import annotations

import numpy as np
import viser

from algorithms.methods.steps import RefineDetail
from app.drawing.draw_items import mark
from app.drawing.palette import DARK, LIGHT
from app.drawing.scene.map_comparison import MODES
from app.drawing.scene.map_layers import Mode
from app.model.view_modes import MAP, OPERATOR, RESEARCH
from app.page.tab import Tab

OF_TWO_MAPS = "This view is of two maps. Press a pair of the fleet first."
FAR = 1e6  # metres from the scene's origin; no map reaches there


class ViewController:
    """Of one tab."""

    def __init__(self, tab: Tab, client: viser.ClientHandle) -> None:
        self._state, self._display, self._modes = tab.state, tab.display, tab.modes
        self._notices, self._panels = tab.notices, tab.panels
        self._messages, self._views = tab.display.messages, tab.display.views
        tab.panels.run.connect_view(self.choose, self.fit, self.darken, self.choose_research)
        tab.events.on("compare", self.compare, mode=MODES)
        tab.events.on("resized", self._resized)
        client.scene.on_click()(self._read_out)

    def choose(self, view: str) -> None:
        with self._state.locks.drawing:
            mode = self._modes.current
            if view != MAP and mode is not None and mode.extent is not None:
                self._notices.show(view, OF_TWO_MAPS, "orange")
                view = MAP
            self._state.update(view=view)
            self._show()

    def darken(self, dark: bool) -> None:
        with self._state.locks.drawing:
            self._state.palette = DARK if dark else LIGHT  # who subscribed to it draws over the page: later
            self._display.recolour()
            self._show()
            self._state.update(palette=self._state.palette)

    def choose_research(self, yes: bool) -> None:
        """All settings and stages are wanted, or no more than operators need; the browser remembers it."""
        with self._state.locks.action:
            self.research(yes)
            self._messages.remember_mode(self._panels.run.mode)
            self._messages.flush()

    def research(self, yes: bool) -> None:
        self._panels.run.mode = RESEARCH if yes else OPERATOR
        if not yes and self._state.view != MAP:
            self.choose(MAP)
        with self._state.locks.drawing:
            self._state.update(research=yes)
            self._display.show_research(yes)

    def _show(self) -> None:
        mode = self._modes.current
        if mode is None or mode.extent is None:
            self._display.show_view(mode.redraw if mode is not None else None)
        else:
            self._display.show_view(mode.redraw, mode.extent())

    def fit(self) -> None:
        with self._state.locks.drawing:
            state, maps = self._state, self._views.map
            if state.view != MAP:
                self._show()
                return
            mode = self._modes.current
            if mode is not None and mode.extent is not None:
                self._messages.look_down(mode.extent(), follow=True)
                self._messages.flush()
                return
            laid_over = state.result is not None or state.hand is not None or state.run.reached(RefineDetail)
            self._messages.look_down(maps.extent() if laid_over else maps.layout.view(), follow=True)
            self._messages.flush()

    def compare(self, mode: Mode) -> None:
        """Look at both maps in another way."""
        with self._state.locks.drawing:
            state = self._state
            if state.view == MAP and self._views.comparison.choose(mode):
                if state.hand is None:
                    self._views.run.show(state.run, state.config, camera=False, live=False)
                self._display.show_legend()
                self._messages.flush()

    def _read_out(self, event: viser.SceneClickEvent) -> None:
        """What is known of the place under a click."""
        if self._state.view != MAP:
            return
        (x, y, z), (right, up, along) = event.ray_origin, event.ray_direction
        if along == 0:  # never meets the floor
            return
        # viser's own frame is turned half round the y axis: see map_layers.py
        place = np.array([right * z / along - x, y - up * z / along])
        if not np.all(np.abs(place) < FAR):
            return
        mode = self._modes.current
        if mode is not None and mode.click is not None:
            mode.click(place)
            return
        self._messages.hud(readout=self._views.map.read_out(place, self._state.run))
        self._messages.layer("readout", [mark("cross", place, self._state.palette.text, r=6)])
        self._messages.flush()

    def _resized(self) -> None:
        self._display.clear_read_out()
        self._messages.flush()
