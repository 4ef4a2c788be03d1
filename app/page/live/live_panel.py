"""Folder "Live": what has happened, a still picture, the past, how fast simulated robots drive."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import viser

from app.drawing.palette import LIGHT, QUIET
from app.model.live.robot_state import clock
from app.page.panels.html_widgets import Action, box, on_choice, on_press, put, small

SPEED, FASTEST = 5.0, 20.0


class LivePanel:
    """Widgets; there is nothing of them where no robots are followed."""

    def __init__(self, gui: viser.GuiApi) -> None:
        quiet: Any = {"color": QUIET}
        with gui.add_folder("Live", order=8.8, visible=False) as self._folder:
            self._said = gui.add_html("")
            hint = "Holds the picture: everything works on it as on files. The robots go on."
            self._freeze = gui.add_button("Freeze", icon=viser.Icon.SNOWFLAKE, hint=hint, **quiet)
            icon, hint = viser.Icon.PLAYER_PLAY, "The picture follows the robots again."
            self._resume = gui.add_button("Go on live", icon=icon, color=LIGHT.ref, hint=hint, visible=False)
            hint = "Seconds since they were first listened to: shows what stood then, as a still picture."
            self._history = gui.add_slider("History (s)", 0, 1, 1, 1, hint=hint, disabled=True)
            hint = "How many times as fast as robots drive; 0 holds them."
            self._speed = gui.add_slider("Speed of the robots (×)", 0.0, FASTEST, 0.5, SPEED, hint=hint)
            self._events = gui.add_html("")
            self._end = gui.add_button("End it", icon=viser.Icon.PLAYER_STOP, **quiet)

    def connect(
        self, freeze: Action, resume: Action, look_back: Callable[[float], None], end: Action
    ) -> None:
        """What is done where a person wants a still picture, to go on, the past, or the end."""
        on_press((self._freeze, freeze), (self._resume, resume), (self._end, end))
        on_choice(self._history, lambda: look_back(float(self._history.value)))

    @property
    def speed(self) -> float:
        return float(self._speed.value)

    def open(self, simulated: bool) -> None:
        """Robots are followed from now on."""
        put(self._folder, visible=True)
        put(self._speed, visible=simulated)
        put(self._history, disabled=True)
        self.say("", ())
        self.frozen(False)

    def close(self) -> None:
        put(self._folder, visible=False)

    def frozen(self, yes: bool) -> None:
        """Whether the picture stands still."""
        put(self._freeze, visible=not yes)
        put(self._resume, visible=yes)

    def say(self, words: str, events: Sequence[str]) -> None:
        """A sentence, and what has happened, the newest first."""
        put(self._said, content=box(words, "plain") if words else "")
        put(self._events, content="".join(map(small, events)))

    def past(self, times: Sequence[float], at: float) -> None:
        """Of which moments there is a picture, and of which it shows one; seconds."""
        if times and times[-1] >= 1:
            put(self._history, disabled=False, max=int(times[-1]), value=min(int(at), int(times[-1])))


def event_line(seconds: float, robot: str, said: str) -> str:
    return f"{clock(seconds)}  {robot}: {said}"
