"""Button "Save replay": the run that is on the page as one HTML file that plays offline."""

from __future__ import annotations

import re
from collections.abc import Callable

import viser

from app.drawing.palette import QUIET
from app.page.cancellable_task import CancellableTask, DownloadTask
from app.system.cancellation import Check


class ReplayButton:
    """Holds the run that can be recorded; None while there is none, or it is out of date."""

    def __init__(self, client: viser.ClientHandle, task: CancellableTask) -> None:
        self._deliver = DownloadTask(client, task)
        self._name = ""
        self._make: Callable[[Check], bytes] | None = None
        self._button = client.gui.add_button(
            "Save replay",
            icon=viser.Icon.MOVIE,
            color=QUIET,
            disabled=True,
            hint="One HTML page that plays this run again, without a network: for a talk or a lesson.",
        )
        self._button.on_click(lambda _: self._save())

    def offer(self, name: str | None, make: Callable[[Check], bytes] | None = None) -> None:
        """Take a run, by the name of its pair and a way to make its page, which can be left; or none."""
        self._name, self._make = name or "", make
        self._button.disabled = make is None

    def visible(self, yes: bool) -> None:
        """Show the button, or hide it while there is nothing to save."""
        self._button.visible = yes

    def _save(self) -> None:
        name, make = self._name, self._make
        if make is not None:
            self._deliver("Recording the run: it is told once more, for the file.", file_name(name), make)


def file_name(name: str) -> str:
    """What the file is called, after its pair: a name that every system takes."""
    stem = re.sub(r"[^\w-]+", "_", name).strip("_")[:60]
    return f"replay_{stem}.html" if stem else "replay.html"
