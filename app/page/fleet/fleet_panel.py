"""Folder "Fleet": robots, who saw whom, and what can be done with them."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import viser

from app.drawing.palette import LIGHT, QUIET
from app.model.fleet_state import FleetState
from app.page.fleet.fleet_html import pairs_html, robots_html
from app.page.fleet.sample_robots import sample_robots
from app.page.panels.html_widgets import Action, box, on_press, put, small

LEAST = 2  # robots of a fleet
NO_SAMPLE = "(choose)"


class FleetPanel:
    """Widgets; there is nothing of them on a page of two maps."""

    def __init__(self, gui: viser.GuiApi) -> None:
        quiet: Any = {"color": QUIET}
        with gui.add_folder("Fleet", order=9.0, visible=False) as self._folder:
            self._opened = gui.add_html("")
            icon = viser.Icon.ARROW_LEFT
            self._back = gui.add_button("Back to the fleet", icon=icon, color=LIGHT.ref, visible=False)
            self._robots = gui.add_html("")
            self._pairs = gui.add_html("")
            with gui.add_folder("The chosen robot", expand_by_default=False) as self._one:
                self._name = gui.add_text("Name", "", hint="It goes into every file.")
                self._rename = gui.add_button("Rename it", **quiet)  # the field tells every letter
                hint = "The result is in its frame."
                self._anchor = gui.add_button("Make it the anchor", hint=hint, **quiet)
                self._remove = gui.add_button("Remove it", icon=viser.Icon.TRASH, **quiet)
            with gui.add_folder("Add a sighting", expand_by_default=False) as self._sighting:
                self._observer = gui.add_dropdown("Who saw", ("r1", "r2"))
                self._observed = gui.add_dropdown("Whom", ("r1", "r2"), initial_value="r2")
                hint = "Opens the two maps, to say where it was."
                self._place = gui.add_button("Place it on the maps", hint=hint, **quiet)
            with gui.add_folder("Add a robot", expand_by_default=False) as self._adding:
                gui.add_html(small("Open its map's files, under Maps, or drop them anywhere on the page."))
                hint = "A map that ships with mapmeld."
                self.sample = gui.add_dropdown("Or a sample", (NO_SAMPLE, *sample_robots()), hint=hint)
            icon = viser.Icon.DOWNLOAD
            hint = "The merged maps, transforms, graph and report, as a zip."
            self._download = gui.add_button("Download the result", icon=icon, hint=hint, **quiet)
            hint = "The robots' maps and sightings as a zip, to be opened again."
            self._save = gui.add_button("Save the fleet", icon=icon, hint=hint, **quiet)
        self._whole = (self._robots, self._pairs, self._one, self._sighting, self._adding, self._save)
        self._chosen = ""

    def connect(
        self,
        rename: Callable[[str, str], None],
        anchor: Callable[[str], None],
        remove: Callable[[str], None],
        sighting: Callable[[str, str], None],
    ) -> None:
        """What is done with the chosen robot, and where one is to have seen another."""
        on_press(
            (self._rename, lambda: rename(self._chosen, self._name.value.strip())),
            (self._anchor, lambda: anchor(self._chosen)),
            (self._remove, lambda: remove(self._chosen)),
            (self._place, lambda: sighting(self._observer.value, self._observed.value)),
        )

    def connect_files(self, back: Action, download: Action, save: Action) -> None:
        on_press((self._back, back), (self._download, download), (self._save, save))

    def show(self, state: FleetState | None, opened: str = "") -> None:
        """Show a fleet, or of one whose pair is open the way back, and what that is; None: nothing."""
        put(self._folder, visible=state is not None)
        if state is None:
            return
        whole = state.opened is None
        put(self._opened, content=box(opened, "plain") if opened else "")
        put(self._back, visible=not whole)
        for part in self._whole:
            put(part, visible=whole)
        if self._chosen not in state.robots:
            self._chosen = state.robots[-1]
        put(self._robots, content=robots_html(state, self._chosen))
        put(self._name, value=self._chosen)
        put(self._anchor, disabled=self._chosen == state.fleet.anchor)
        put(self._remove, disabled=len(state.robots) <= LEAST)
        put(self._pairs, content=pairs_html(state, state.orders))
        put(self._download, visible=whole and state.result is not None)
        for handle, default in ((self._observer, 0), (self._observed, 1)):
            value = handle.value if handle.value in state.robots else state.robots[default]
            put(handle, options=state.robots, value=value)

    def choose(self, name: str) -> None:
        """That robot is the chosen one from now on."""
        self._chosen = name
