"""Folder "Export": the merged map as a file; a refused one only after a warning."""

from __future__ import annotations

import viser

from algorithms.steps import MergeResult
from app.export import STEM, archive
from app.palette import LIGHT, QUIET
from app.panels.replay import ReplayButton


class ExportPanel:
    """Holds the result that can be downloaded; None while there is none, or it is out of date."""

    def __init__(self, client: viser.ClientHandle) -> None:
        self._client = client
        self._result: MergeResult | None = None
        with client.gui.add_folder("Export", order=70):
            self._button = client.gui.add_button(
                "Download merged map",
                icon=viser.Icon.DOWNLOAD,
                color=QUIET,
                disabled=True,
                hint="A zip: merged.yaml, merged.pgm, transform.yaml.",
            )
            self._button.on_click(lambda _: self._download())
            self.replay = ReplayButton(client)

    def offer(self, result: MergeResult | None) -> None:
        """Take this result, or none; a replay of its run is offered apart."""
        self._result = result
        self.replay.offer(None)
        self._button.disabled = result is None

    def _download(self) -> None:
        result = self._result
        if result is None:
            return
        if result.verdict.accepted:
            self._send(result)
            return
        gui = self._client.gui
        modal = gui.add_modal("This merge was refused")
        with modal:
            gui.add_markdown(f"{result.verdict.reason}\n\nA robot that trusts this map may get lost.")
            yes = gui.add_button("Download the refused map anyway", color=LIGHT.conflict)
            no = gui.add_button("Cancel", color=QUIET)

        def go(really: bool) -> None:
            modal.close()
            if really:
                self._send(result)

        yes.on_click(lambda _: go(True))
        no.on_click(lambda _: go(False))

    def _send(self, result: MergeResult) -> None:
        self._client.send_file_download(f"{STEM}.zip", archive(result), save_immediately=True)
