"""Folder "Running robots": the maps that are published, each of which can be followed."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import viser

from app.drawing.palette import QUIET
from app.page.panels.html_widgets import Action, on_press, put, small

NO_NETWORK = (
    "This page opens no network. Start it with mapmeld serve --live to follow robots with ROS 2, or with "
    "--live --rosbridge ws://HOST:9090. Live demo shows what that is like, with simulated robots."
)
READY = "Nothing is published, and nothing is listened to before a robot is added."
NONE = "(look for maps)"


class NetworkPanel:
    """Widgets. Without a network it says how to start the page with one."""

    def __init__(self, gui: viser.GuiApi, network: bool) -> None:
        quiet: Any = {"color": QUIET}
        with gui.add_folder("Running robots", order=10.5, expand_by_default=network):
            self._said = gui.add_html(small(READY if network else NO_NETWORK))
            icon, hint = viser.Icon.RADAR_2, "Lists the maps that robots publish now."
            self._look = gui.add_button("Look for maps", icon=icon, hint=hint, visible=network, **quiet)
            self._topic = gui.add_dropdown("Published map", (NONE,), visible=False)
            self._name = gui.add_text("Robot", "", hint="Its name; empty: by its topic.", visible=False)
            self._add = gui.add_button("Add this robot", icon=viser.Icon.PLUS, visible=False, **quiet)

    def connect(self, look: Action, add: Callable[[str, str], None]) -> None:
        """What is done where a person looks for maps, or adds the robot of one: topic, name or ""."""
        on_press(
            (self._look, look), (self._add, lambda: add(str(self._topic.value), self._name.value.strip()))
        )

    def looking(self, yes: bool) -> None:
        put(self._look, disabled=yes)
        if yes:
            self.say("Looking for maps …")

    def say(self, words: str) -> None:
        put(self._said, content=small(words))

    def offer(self, topics: Sequence[str]) -> None:
        """Offer these maps."""
        put(self._topic, visible=bool(topics))
        put(self._name, visible=bool(topics), value="")
        put(self._add, visible=bool(topics))
        if topics:
            value = self._topic.value if self._topic.value in topics else topics[0]
            put(self._topic, options=tuple(topics), value=value)
