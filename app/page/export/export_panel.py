"""Folder "Export": everything as one zip, each file alone, and the line that publishes the transform.

What a robot would act upon is given of a refused merge only after a warning.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from html import escape
from typing import Any

import viser

from app.drawing.palette import LIGHT, QUIET
from app.page.cancellable_task import CancellableTask, DownloadTask
from app.page.export.frame_panel import FramePanel
from app.page.panels.html_widgets import Action, box, on_press
from app.report.result_files import ACTED_UPON, ALONE, ARCHIVE, ResultFiles, zip_bytes
from app.report.ros_transform import publish_commands
from app.system.cancellation import Check

_NOTHING = box("After a merge it can be taken away from here: map, transform, report.", "plain")
_OUTDATED = "Out of date: a setting was changed."


class ExportPanel:
    """Holds the result that can be downloaded; None while there is none, or it is out of date."""

    def __init__(self, client: viser.ClientHandle, task: CancellableTask) -> None:
        self._client, self._deliver = client, DownloadTask(client, task)
        self.harvest: ResultFiles | None = None
        self.offered: Action = lambda: None  # called once a result is there to be taken
        gui = client.gui
        with gui.add_folder("Export", order=70):
            hint = "All that is here and was done, to go on from another day: Open files… takes it."
            self._project = gui.add_button(
                "Save project", color=QUIET, icon=viser.Icon.DEVICE_FLOPPY, hint=hint
            )
            hint = "A zip: merged map for Nav2, transform, report to read and print, picture, observation."
            quiet: Any = {"color": QUIET, "visible": False}
            icon = viser.Icon.DOWNLOAD
            self._all = gui.add_button("Download everything", icon=icon, hint=hint, **quiet)
            self._one = gui.add_dropdown("One file", ALONE, visible=False, hint="A file of the zip, alone.")
            self._alone = gui.add_button("Download this file", **quiet)
            on_press(
                (self._all, lambda: self._ask(ARCHIVE)), (self._alone, lambda: self._ask(self._one.value))
            )
            self.replay = ReplayButton(client, task)
            self.replay.visible(False)
            self.frame = FramePanel(gui)
            self._line = gui.add_html("")
            self._note = gui.add_html(_NOTHING)  # last, so that nothing moves when it comes

    def connect_project(self, save: Action) -> None:
        """What is done where all of the page is to become a file."""
        on_press((self._project, save))

    def offer(self, harvest: ResultFiles | None) -> None:
        """Take this result, or none; a replay of its run is offered apart."""
        self._show(harvest, there=harvest is not None)
        self._note.content = "" if harvest is not None else _NOTHING
        self._line.content = "" if harvest is None else line_html(harvest)
        if harvest is not None:
            self.offered()

    def reframe(self, harvest: ResultFiles) -> None:
        """The same result, whose merged map is given away in another frame or other cells."""
        self.harvest = harvest
        self._line.content = line_html(harvest)

    def outdate(self, why: str = _OUTDATED) -> None:
        """The result is out of date, or not what is seen: it is greyed, and nothing of it can be taken."""
        last = self.harvest
        if last is not None:
            self._show(None, there=True)
            self._note.content = box(why, "plain", faded=True)
            self._line.content = line_html(last, faded=True)

    def _show(self, harvest: ResultFiles | None, there: bool) -> None:
        self.harvest = harvest
        self.frame.offer(there, enabled=harvest is not None)
        self.replay.offer(None)
        self.replay.visible(there)
        for widget in (self._all, self._one, self._alone):
            widget.visible, widget.disabled = there, harvest is None

    def _ask(self, name: str) -> None:
        """Send a file of the result, or all of them; of a refused one only harmless ones at once."""
        harvest = self.harvest
        if harvest is None:
            return
        verdict = harvest.result.verdict
        if verdict.accepted or name not in (ARCHIVE, *ACTED_UPON):
            self._send(harvest, name)
            return
        gui = self._client.gui
        modal = gui.add_modal("This merge was refused")
        with modal:
            gui.add_markdown(f"{verdict.reason}\n\nA robot that trusts this map may get lost.")
            yes = gui.add_button("Download the refused map anyway", color=LIGHT.conflict)
            no = gui.add_button("Cancel", color=QUIET)

        def anyway() -> None:
            modal.close()
            self._send(harvest, name)

        on_press((yes, anyway), (no, modal.close))

    def _send(self, harvest: ResultFiles, name: str) -> None:
        def make(check: Check) -> bytes:
            files = harvest.make(check)
            return zip_bytes(files) if name == ARCHIVE else files[name]

        self._deliver("Making the files: map, pictures and report.", name, make)


def line_html(harvest: ResultFiles, faded: bool = False) -> str:
    """HTML of the line that publishes the transform, with a button that copies it: see measure_tool.js."""
    if not harvest.result.verdict.accepted:
        return box("Refused: there is no transform to publish.", "refused", faded=faded)
    commands = publish_commands(harvest.result.T_ref_mov, harvest.inputs.names, harvest.frame)
    dim, off = (' style="opacity:.4"', " disabled") if faded else ("", "")
    what, copy = ("transform", "line") if len(commands) == 1 else ("transforms", "lines")
    shown = "".join(f"<code>{escape(command)}</code>" for command in commands)
    lines = escape("\n".join(commands))
    return (
        f'<div class="mm-publish"{dim}><p>Publish the {what} in ROS 2:</p>{shown}'
        f'<button type="button" data-mm-copy="{lines}"{off}>Copy the {copy}</button></div>'
    )


class ReplayButton:
    """Holds the run that can be recorded; None while there is none, or it is out of date."""

    def __init__(self, client: viser.ClientHandle, task: CancellableTask) -> None:
        self._deliver = DownloadTask(client, task)
        self._name = ""
        self._make: Callable[[Check], bytes] | None = None
        hint = "One HTML page that plays this run again, without a network: for a talk or a lesson."
        how: Any = {"icon": viser.Icon.MOVIE, "color": QUIET, "disabled": True, "hint": hint}
        self._button = client.gui.add_button("Save replay", **how)
        self._button.on_click(lambda _: self._save())

    def offer(self, name: str | None, make: Callable[[Check], bytes] | None = None) -> None:
        """Take a run, by the name of its pair and a way to make its page, which can be left; or none."""
        self._name, self._make = name or "", make
        self._button.disabled = make is None

    def visible(self, yes: bool) -> None:
        self._button.visible = yes

    def _save(self) -> None:
        name, make = self._name, self._make
        if make is not None:
            self._deliver("Recording the run: it is played once more, for the file.", file_name(name), make)


def file_name(name: str) -> str:
    """What the file is called, after its pair: a name that every system takes."""
    stem = re.sub(r"[^\w-]+", "_", name).strip("_")[:60]
    return f"replay_{stem}.html" if stem else "replay.html"
