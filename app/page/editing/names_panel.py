"""Folder "Names": what the two robots are called."""

from __future__ import annotations

from typing import Any

import viser

from algorithms.common.robot_names import UNNAMED, RobotNames
from app.page.panels.html_widgets import Action, box, put

HINT = "In words, legends and files, and in the name of its map's frame. Empty: {}."


class NamesPanel:
    """Two fields; there are none of them beside a fleet, whose folder has its own."""

    def __init__(self, gui: viser.GuiApi) -> None:
        with gui.add_folder("Names", order=15.0, expand_by_default=False) as self._folder:
            self._fields = tuple(
                gui.add_text(f"{name.capitalize()} is called", "", hint=HINT.format(name))
                for name in (UNNAMED.ref, UNNAMED.mov)
            )
            self._says = gui.add_html("", visible=False)

    def connect(self, typed: Action) -> None:
        """What is done at every letter that a person types."""
        for each in self._fields:

            def read(event: viser.GuiEvent[Any]) -> None:
                if event.client_id is not None:  # not set by ``show``
                    typed()

            each.on_update(read)

    @property
    def typed(self) -> tuple[str, str]:
        """What stands in the fields, of robot 1 and of robot 2."""
        ref, mov = (each.value for each in self._fields)
        return ref, mov

    def show(self, names: RobotNames, visible: bool) -> None:
        """Show these names; a field that says as much keeps its spaces, for who still types in it."""
        put(self._folder, visible=visible)
        self.tell("")
        for each, name, none in zip(
            self._fields, (names.ref, names.mov), (UNNAMED.ref, UNNAMED.mov), strict=True
        ):
            if (each.value.strip() or none) != name:
                put(each, value="" if name == none else name)

    def tell(self, trouble: str) -> None:
        """Why the robots cannot be called so; empty where they can."""
        put(self._says, visible=bool(trouble), content=box(trouble, "refused") if trouble else "")
