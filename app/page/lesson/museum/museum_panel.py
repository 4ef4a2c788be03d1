"""Folder "Museum": an exhibit, what to press, what happened and why, and the cure."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from html import escape

import viser

from app.drawing.palette import LIGHT, QUIET
from app.page.panels.html_widgets import Action, box, on_choice, on_press, put, table


class MuseumPanel:
    """Widgets; they know nothing of the exhibits."""

    def __init__(self, gui: viser.GuiApi) -> None:
        self._titles: tuple[str, ...] = ("…",)
        self._folder = gui.add_folder("Museum", order=4.8, visible=False)
        with self._folder:
            self._exhibit = gui.add_dropdown("Exhibit", self._titles)
            self._body = gui.add_markdown("")
            self._picture = gui.add_html("")
            self._settings = gui.add_html("")
            self._told = gui.add_html("")
            self._cure = gui.add_button("Cure", color=LIGHT.mov, icon=viser.Icon.BANDAGE, visible=False)
            self._again = gui.add_button("Once more, uncured", color=QUIET, visible=False)
            self._leave = gui.add_button("Leave the museum", color=QUIET)

    def connect(self, pick: Callable[[int], None], cure: Action, again: Action, leave: Action) -> None:
        """What is done where a person picks an exhibit by its number from 0, cures it, or leaves."""

        def picked() -> None:
            if self._exhibit.value in self._titles:
                pick(self._titles.index(self._exhibit.value))

        on_choice(self._exhibit, picked)
        on_press((self._cure, cure), (self._again, again), (self._leave, leave))

    def visible(self, yes: bool) -> None:
        put(self._folder, visible=yes)

    def contents(self, titles: Sequence[str]) -> None:
        self._titles = tuple(f"{k}. {title}" for k, title in enumerate(titles, 1))
        put(self._exhibit, options=self._titles)

    def exhibit(self, index: int, body: str) -> None:
        """Show an exhibit before its merge."""
        put(self._exhibit, value=self._titles[index])
        self._body.content = body
        self._settings.content = self._told.content = ""
        put(self._picture, content="")
        self._buttons(cure="", again=False)

    def picture(self, svg: str, said: Sequence[tuple[str, str]] = ()) -> None:
        """Show the picture of an exhibit, or a line in its place; ``said``: who says what of it."""
        shown = svg if svg.startswith("<svg") else f'<div class="mm-wait">{escape(svg)}</div>'
        words = "".join(
            f'<p style="margin:4px 0"><span style="opacity:.7">{escape(who)}:</span> {escape(what)}</p>'
            for who, what in said
        )
        put(
            self._picture,
            content=f'<div style="margin:4px 10px 8px;font-size:12.5px;line-height:1.4">{shown}{words}</div>',
        )

    def settings(self, settings: Sequence[tuple[str, ...]]) -> None:
        """Show what is set for the exhibit, or by its cure."""
        self._settings.content = table(settings, ("set for this exhibit", ""))

    def broken(self, index: int, what: str) -> None:
        """Tell what is wrong with the text of an exhibit."""
        self.exhibit(index, "")
        self._told.content = box(f"This text cannot be read. {what}", "refused")

    def failed(self, why: str, numbers: str, cure: str) -> None:
        """The merge went wrong, as it was to."""
        self._told.content = box(numbers, "refused", why)
        self._buttons(cure, again=False)

    def cured(self, why: str, numbers: str) -> None:
        """The cure has helped."""
        self._told.content = box(numbers, "accepted", why)
        self._buttons("", again=True)

    def _buttons(self, cure: str, again: bool) -> None:
        if cure and self._cure.label != f"Cure: {cure}":
            self._cure.label = f"Cure: {cure}"
        put(self._cure, visible=bool(cure))
        put(self._again, visible=again)
