"""A panel's controls by what a person reads on them, without the panel's private names."""

from __future__ import annotations

from typing import Any

import viser


class Controls:
    """Stands for viser's GUI where a panel is made: it makes what that makes, and notes each control.

    Of several with one label the newest counts, as in a panel that fills itself anew.
    """

    def __init__(self, gui: viser.GuiApi) -> None:
        self._gui = gui
        self._made: list[tuple[str, str, Any]] = []

    def __getattr__(self, name: str) -> Any:
        made = getattr(self._gui, name)
        if not name.startswith("add_"):
            return made

        def noting(*what: Any, **how: Any) -> Any:
            handle = made(*what, **how)
            label = what[0] if what else how.get("label", "")
            self._made.append((name.removeprefix("add_"), str(label), handle))
            return handle

        return noting

    def find(self, label: str) -> Any:
        """The control of this label."""
        return next(handle for _, name, handle in reversed(self._made) if name == label)

    def of_kind(self, kind: str) -> list[Any]:
        """All controls that one of viser's ``add_`` functions made, in their order: "html", "folder"."""
        return [handle for made, _, handle in self._made if made == kind]

    def press(self, label: str) -> None:
        """Press a button, as far as a program can: its callbacks are called at once."""
        self.find(label).value = True

    def text(self) -> str:
        """All words that are shown now, in their order."""
        return "\n".join(html.content for html in self.of_kind("html") if html.visible)
