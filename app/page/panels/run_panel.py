"""The buttons on top, and folder "Run": what runs, how fast, how it is looked at."""

from __future__ import annotations

from collections.abc import Callable
from threading import Lock

import viser

from algorithms.methods.registry import METHODS
from app.drawing.palette import LIGHT, QUIET, STOP
from app.model.playback import PACES
from app.model.view_modes import HEIGHTS, LESSON, LIVE_DEMO, MAP, MUSEUM, OPERATOR, RESEARCH, SWARM
from app.page.panels.html_widgets import Action, on_choice, on_press, put

NAMES = {method.title: name for name, method in METHODS.items()}


class RunPanel:
    """Widgets; they know nothing of a run."""

    def __init__(self, gui: viser.GuiApi) -> None:
        self.merge = gui.add_button("Merge", color=LIGHT.ref, icon=viser.Icon.ARROWS_JOIN, order=1)
        self._at_work: set[str] = set()  # who can be stopped
        self._counting = Lock()  # they begin and end in threads of their own
        icon = viser.Icon.PLAYER_STOP
        self.stop = gui.add_button("Stop", color=STOP, icon=icon, disabled=True, order=2)
        hint = "How fast the steps are shown. Instant: as fast as they are computed."
        self._speed = gui.add_button_group("Speed", tuple(PACES), order=3, hint=hint)
        self._speed.value = "Normal"
        self._view = gui.add_button_group("View", (MAP, HEIGHTS, SWARM), order=4)
        hint = (
            "Lesson: the method step by step on these maps. Museum: where it goes wrong, and what cures it. "
            "Live demo: simulated robots explore, and their maps are merged meanwhile."
        )
        self._learn = gui.add_button_group("Learn", (LESSON, MUSEUM, LIVE_DEMO), order=4.7, hint=hint)
        self._open: list[str] = []  # which of them are
        hint = (
            "Operator: maps, sighting, result, export. Research: every setting of the method, its stages, "
            "comparison with others and sweeps, too."
        )
        self._mode = gui.add_button_group("Mode", (OPERATOR, RESEARCH), order=4.75, hint=hint)
        with gui.add_folder("Run", order=50):
            hint = "The way to merge; each has its own defaults."
            self._method = gui.add_dropdown("Method", tuple(NAMES), hint=hint)
            hint = "Random seed: the same seed gives the same answer."
            self._seed = gui.add_number("Seed", 0, min=0, max=2**31 - 1, step=1, hint=hint)
            self._follow = gui.add_checkbox("Camera follows", True, hint="The camera goes with the run.")
            self._fit = gui.add_button("Show everything", color=QUIET)
            self._dark = gui.add_checkbox("Dark", False, hint="Light writing on a dark page.")

    def connect_run(
        self, merge: Action, stop: Action, speed: Action, method: Callable[[str], None], seed: Action
    ) -> None:
        """What is done where a person wants a merge, or another speed, method or seed of it."""
        on_press((self.merge, merge), (self.stop, stop), (self._speed, speed))
        self._method.on_update(lambda _: method(NAMES[self._method.value]))
        on_choice(self._seed, seed)

    def connect_view(
        self,
        view: Callable[[str], None],
        fit: Action,
        dark: Callable[[bool], None],
        research: Callable[[bool], None],
    ) -> None:
        """What is done where a person wants to see it otherwise."""
        self._view.on_click(lambda event: view(self._view.value) if event.client_id is not None else None)
        self._fit.on_click(lambda _: fit())
        self._dark.on_update(lambda _: dark(self._dark.value))
        self._mode.on_click(lambda _: research(self._mode.value == RESEARCH))

    def connect_learn(self, lesson: Action, museum: Action, demo: Action) -> None:
        """What is done where a person opens or closes the lesson, the museum or the live demo."""
        does = {LESSON: lesson, MUSEUM: museum, LIVE_DEMO: demo}
        self._learn.on_click(lambda _: does[self._learn.value]())

    def research(self, yes: bool) -> None:
        """Show what only researchers set, or hide it."""
        for handle in (self._view, self._method, self._seed):
            put(handle, visible=yes)

    @property
    def view(self) -> str:
        return self._view.value

    @view.setter
    def view(self, view: str) -> None:
        put(self._view, value=view)

    @property
    def pace(self) -> float:
        """Factor on how long each step stays; 0: not at all."""
        return PACES[self._speed.value]

    @property
    def speed(self) -> str:
        return str(self._speed.value)

    @speed.setter
    def speed(self, name: str) -> None:
        if name in PACES:
            put(self._speed, value=name)

    @property
    def mode(self) -> str:
        return str(self._mode.value)

    @mode.setter
    def mode(self, mode: str) -> None:
        put(self._mode, value=mode)

    @property
    def seed(self) -> int:
        return int(self._seed.value)

    @property
    def dark(self) -> bool:
        return self._dark.value

    @dark.setter
    def dark(self, dark: bool) -> None:
        put(self._dark, value=dark)

    def restore(self, method: str, seed: int) -> None:
        put(self._method, value=METHODS[method].title)
        put(self._seed, value=seed)

    def stoppable(self, who: str, yes: bool) -> None:
        """Whether a run, or the reading or sending of a file, can be stopped now."""
        with self._counting:
            (self._at_work.add if yes else self._at_work.discard)(who)
            put(self.stop, disabled=not self._at_work)

    @property
    def follow(self) -> bool:
        return self._follow.value

    def open(self, what: str, yes: bool) -> None:
        """The lesson, the museum or the live demo was opened or closed."""
        self._open = [
            name for name in (LESSON, MUSEUM, LIVE_DEMO) if (yes if name == what else name in self._open)
        ]

    @property
    def pressed(self) -> list[str]:
        return [self._speed.value, self._view.value, self._mode.value, *self._open]
