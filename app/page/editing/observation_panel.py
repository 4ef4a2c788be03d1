"""A sighting's numbers, and the tools to place the robots by hand."""

from __future__ import annotations

from collections.abc import Callable
from math import degrees, radians
from typing import Any

import viser

from algorithms.common.robot_names import UNNAMED
from algorithms.maps.grid_map import FARTHEST
from algorithms.observations.observation import MOST_RANGE, SIGMA_BEARINGS, SIGMA_RANGES
from app.drawing.palette import LIGHT, QUIET
from app.model import status_text as words
from app.model.merge_inputs import MergeInputs
from app.model.observation_draft import ObservationDraft
from app.page.panels.html_widgets import Action, box, on_choice, on_press, put, table
from app.report.result_rows import named, sighting_rows

# field -> label, hint, least, most, step; angles in degrees
FIELDS: dict[str, tuple[str, str, float, float, float]] = {
    "x1": ("robot 1: x (m)", "In map 1.", -FARTHEST, FARTHEST, 0.01),
    "y1": ("robot 1: y (m)", "In map 1.", -FARTHEST, FARTHEST, 0.01),
    "turn1": ("robot 1: heading (°)", "Counter-clockwise from map 1's x axis.", -360, 360, 0.1),
    "range": ("range r (m)", "Of robot 2 from robot 1.", 0, MOST_RANGE, 0.01),
    "bearing": ("bearing β (°)", "Counter-clockwise from robot 1's heading.", -360, 360, 0.1),
    "sigma_range": ("σ_r of the range (m)", "One standard deviation.", *SIGMA_RANGES, 0.005),
    "sigma_bearing": (
        "σ_β of the bearing (°)",
        "One standard deviation.",
        *map(degrees, SIGMA_BEARINGS),
        0.1,
    ),
    "x2": ("robot 2: x (m)", "In map 2.", -FARTHEST, FARTHEST, 0.01),
    "y2": ("robot 2: y (m)", "In map 2.", -FARTHEST, FARTHEST, 0.01),
    "turn2": ("robot 2: heading (°)", "From map 2's x axis; the method does not need it.", -360, 360, 0.1),
}
ANGLES = {"turn1", "bearing", "sigma_bearing", "turn2"}


class ObservationPanel:
    """Shows where the robots were and what one saw of the other; its widgets only ask."""

    def __init__(self, gui: viser.GuiApi) -> None:
        self._names = UNNAMED
        self._html = gui.add_html("", visible=False)
        quiet: Any = {"color": QUIET, "visible": False}
        hint = "With the mouse, in place of an observation file; or to correct the one there is."
        icon = viser.Icon.MAP_PIN
        self._toggle = gui.add_button("Place robots on the maps", icon=icon, hint=hint, **quiet)
        self._step = gui.add_html("", visible=False)
        self._which = gui.add_dropdown("Observation", ("1",), visible=False, hint="Which one is moved.")
        self._fields: dict[str, Any] = {
            name: gui.add_number(
                label, max(0.0, least), min=least, max=most, step=step, hint=hint, visible=False
            )
            for name, (label, hint, least, most, step) in FIELDS.items()
        }
        self._add = gui.add_button("Add another observation", **quiet)
        self._remove = gui.add_button("Remove this observation", **quiet)

    def connect(
        self,
        toggle: Action,
        typed: Callable[[str, float], None],
        choose: Callable[[int], None],
        add: Action,
        remove: Action,
    ) -> None:
        """What is done where a person begins or ends to place the robots, and meanwhile.

        typed  : a field and its new value; metres, radians; called in viser's loop
        choose : the number of an observation, from 0
        """
        on_press((self._toggle, toggle), (self._add, add), (self._remove, remove))
        on_choice(self._which, lambda: choose(int(self._which.value) - 1))
        for name, handle in self._fields.items():

            async def read(event: viser.GuiEvent[Any], name: str = name) -> None:  # before it is overwritten
                if event.client_id is not None:  # not set from here
                    value = float(event.target.value)
                    typed(name, radians(value) if name in ANGLES else value)

            handle.on_update(read)

    def show(self, inputs: MergeInputs) -> None:
        """Show the numbers of these inputs; nothing is being placed."""
        self._names = inputs.names
        for name, (label, hint, *_) in FIELDS.items():
            put(self._fields[name], label=self._names.told(label), hint=self._names.told(hint))
        seen, both = bool(inputs.observations), inputs.ref is not None and inputs.mov is not None
        put(self._html, content=observations_html(inputs), visible=seen)
        self._toggle.visible = both and inputs.choice in ("sighting", "all")
        self._toggle.label = "Move the robots by hand" if seen else "Place robots on the maps"
        self._toggle.color = QUIET if seen else LIGHT.ref
        for handle in (self._step, self._which, self._add, self._remove, *self._fields.values()):
            handle.visible = False

    def edit(self, drafts: list[ObservationDraft], chosen: int, trouble: str = "") -> None:
        """Show a draft in fields, and what is to be done next; ``trouble``: what was wrong with the last."""
        draft, several = drafts[chosen], len(drafts) > 1
        self._html.visible = False
        self._toggle.label, self._toggle.color = "Done", LIGHT.ref
        step = box(self._names.told(words.PLACING[draft.missing]), "plain")
        self._step.content = (box(trouble, "refused") if trouble else "") + step
        self._step.visible = True
        options = tuple(str(number) for number in range(1, len(drafts) + 1))
        put(self._which, options=options, value=str(chosen + 1), visible=several)
        for name, value in fields_of(draft).items():
            handle = self._fields[name]
            if value is not None:
                handle.value = round(degrees(value) if name in ANGLES else value, 3)
            put(handle, visible=value is not None)
        whole = draft.missing is None
        self._add.visible, self._remove.visible = whole, several or draft.observer is not None


def fields_of(draft: ObservationDraft) -> dict[str, float | None]:
    """The number of every field; metres, radians; None where it is not known yet."""
    observer, observed = draft.observer, draft.observed
    placed = draft.seen is not None
    return {
        "x1": observer.x if observer else None,
        "y1": observer.y if observer else None,
        "turn1": observer.theta if observer else None,
        "range": draft.range,
        "bearing": draft.bearing,
        "sigma_range": draft.sigma_range if placed else None,
        "sigma_bearing": draft.sigma_bearing if placed else None,
        "x2": observed[0] if observed else None,
        "y2": observed[1] if observed else None,
        "turn2": draft.heading if observed else None,
    }


def observations_html(inputs: MergeInputs) -> str:
    """HTML of a table per sighting, each under what is odd about it."""
    parts = []
    total = len(inputs.observations)
    rows = zip(inputs.observations, inputs.encounters, inputs.doubts(), strict=True)
    for number, (o, at, doubt) in enumerate(rows, 1):
        head = (f"Observation {number} of {total}", "") if total > 1 else ()
        odd = box(inputs.names.told(doubt), "refused") if doubt else ""
        parts.append(odd + table(named(sighting_rows(o, at), inputs.names), head))
    return "".join(parts)
