"""Folder "What do you know?": which kind of knowledge is used, and the numbers of a rough one."""

from __future__ import annotations

from collections.abc import Callable
from math import degrees, radians
from typing import Any

import viser

from algorithms.maps.grid_map import FARTHEST
from algorithms.observations.priors import SIGMAS_XY, SIGMAS_YAW, Prior
from app.drawing.palette import LIGHT, QUIET
from app.model.knowledge import CHOICES, Choice, numbers_of
from app.model.merge_inputs import TO_PLACE, MergeInputs
from app.page.editing.observation_panel import ObservationPanel
from app.page.panels.html_widgets import Action, box, on_choice, on_press, put, small

TITLES = {choice: title.capitalize() for choice, title in CHOICES.items()}
TELLS: dict[Choice, str] = {
    "sighting": "",
    "initial": "Where map 2 lies in map 1. Ring and wedge: two standard deviations.",
    "turn": "How far map 2 is turned in map 1, by a compass or a dock.",
    "near": "The two rings hold one place, give or take their radius.",
    "all": "All of it counts, each with its own error.",
    "nothing": "Every turn and every shift is searched. It takes longer, and a place that looks like another "
    "cannot be told from it.",
}
# number -> label, hint, least, most, step; angles in degrees
FIELDS: dict[str, tuple[str, str, float, float, float]] = {
    "x": ("Δx (m)", "Map 2's origin in map 1.", -FARTHEST, FARTHEST, 0.01),
    "y": ("Δy (m)", "Map 2's origin in map 1.", -FARTHEST, FARTHEST, 0.01),
    "x1": ("map 1: x (m)", "Of the place in map 1.", -FARTHEST, FARTHEST, 0.01),
    "y1": ("map 1: y (m)", "Of the place in map 1.", -FARTHEST, FARTHEST, 0.01),
    "x2": ("map 2: x (m)", "Of the same place in map 2.", -FARTHEST, FARTHEST, 0.01),
    "y2": ("map 2: y (m)", "Of the same place in map 2.", -FARTHEST, FARTHEST, 0.01),
    "yaw": ("Δθ (°)", "Of map 2 in map 1, counter-clockwise.", -360, 360, 0.1),
    "s_xy": (
        "σ of Δx, Δy (m)",
        "One standard deviation: two thirds of the time it is nearer.",
        *SIGMAS_XY,
        0.01,
    ),
    "s_yaw": ("σ of Δθ (°)", "One standard deviation.", *map(degrees, SIGMAS_YAW), 0.1),
    "radius": ("radius (m)", "How far apart the two may be.", *SIGMAS_XY, 0.01),
}
ANGLES = {"yaw", "s_yaw"}


class KnowledgePanel:
    """Widgets; those of a sighting are the ObservationPanel's."""

    def __init__(self, gui: viser.GuiApi) -> None:
        with gui.add_folder("What do you know?", order=20.0) as self._folder:
            titles = tuple(TITLES.values())
            hint = "What the search may go by. The more is known, the quicker and the surer it is."
            self._choice = gui.add_dropdown("Known is", titles, initial_value=TITLES["nothing"], hint=hint)
            self._html = gui.add_html("")
            self.observation = ObservationPanel(gui)
            self._numbers = {
                name: gui.add_number(
                    label,
                    min(max(0.0, least), most),
                    min=least,
                    max=most,
                    step=step,
                    hint=hint,
                    visible=False,
                )
                for name, (label, hint, least, most, step) in FIELDS.items()
            }
            icon = viser.Icon.HAND_MOVE
            self._move = gui.add_button("Move it on the map", icon=icon, color=QUIET, visible=False)
            hint = "observation.yaml, to be loaded again."
            self._save = gui.add_button(
                "Save what is known", icon=viser.Icon.DOWNLOAD, hint=hint, color=QUIET, visible=False
            )

    def connect(
        self,
        choose: Callable[[Choice], None],
        typed: Callable[[str, float], None],
        move: Action,
        save: Action,
    ) -> None:
        """What is done where a person chooses a kind, types a number of ``numbers_of``, and presses.

        typed : metres, radians; called in viser's loop
        """
        choices = {title: choice for choice, title in TITLES.items()}
        on_choice(self._choice, lambda: choose(choices[self._choice.value]))
        on_press((self._move, move), (self._save, save))
        for name, handle in self._numbers.items():

            async def read(event: viser.GuiEvent[Any], name: str = name) -> None:  # before it is overwritten
                if event.client_id is not None:  # not set from here
                    value = float(event.target.value)
                    typed(name, radians(value) if name in ANGLES else value)

            handle.on_update(read)

    def show(self, inputs: MergeInputs, prior: Prior | None = None, moving: bool = False) -> None:
        """Show what these inputs know.

        prior  : whose numbers are shown
        moving : whether it is being moved on the map
        """
        choice, both = inputs.choice, inputs.ref is not None and inputs.mov is not None
        mixed = inputs.mixed or choice == "all"
        titles = tuple(title for each, title in TITLES.items() if mixed or each != "all")
        put(self._choice, options=titles, value=TITLES[choice])
        told = inputs.names.told
        missing = box(told(TO_PLACE[choice]), "plain") if both and not inputs.complete and not moving else ""
        put(self._html, content=small(told(TELLS[choice])) + missing)
        self.observation.show(inputs)
        numbers = {} if prior is None else numbers_of(prior)
        for name, handle in self._numbers.items():
            label, hint, *_ = FIELDS[name]
            put(handle, label=told(label), hint=told(hint))
            if name in numbers:
                value = numbers[name]
                put(handle, value=round(degrees(value) if name in ANGLES else value, 3))
            put(handle, visible=name in numbers)
        label, colour = ("Done", LIGHT.ref) if moving else ("Move it on the map", QUIET)
        put(self._move, visible=both and prior is not None, label=label, color=colour)
        self.savable(bool(inputs.known))

    def visible(self, yes: bool) -> None:
        """Whether there are two maps of which something may be known."""
        put(self._folder, visible=yes)

    def savable(self, yes: bool) -> None:
        """Whether there is anything to save."""
        put(self._save, visible=yes)

    def tell(self, trouble: str) -> None:
        """What was wrong with the last number."""
        put(self._html, content=box(trouble, "refused"))
