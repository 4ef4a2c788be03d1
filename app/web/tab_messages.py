"""Sends what is to be drawn to the scripts of one browser tab."""

from __future__ import annotations

import json
from typing import Any

import numpy as np
import viser
from viser._messages import RunJavascriptMessage

from app.drawing.browser_messages import BrowserMessages
from app.system.data_paths import asset

# map_drawing.js first: map_viewer.js draws with it, and so does a saved replay; the others add to the page
SCRIPTS = (
    *("map_drawing.js", "map_viewer.js", "map_editing.js", "zoom_detail.js", "map_comparison.js"),
    *("measure_tool.js", "lesson.js", "research.js", "sighting.js", "fleet.js", "upload.js", "open_files.js"),
    "keyboard_shortcuts.js",
)


_SCRIPT = "\n".join(asset(name) for name in SCRIPTS)


class TabMessages(BrowserMessages):
    """The browser's side of one tab."""

    def __init__(self, client: viser.ClientHandle) -> None:
        super().__init__()
        self._client = client
        self._run(_SCRIPT)

    def send(self, message: dict[str, Any]) -> None:
        self._run(f"window.mapmeld && window.mapmeld.apply({json.dumps(message, default=plain)})")

    def _run(self, source: str) -> None:
        # viser's own way to run a script in one tab; it keeps order with the scene's messages
        self._client._websock_connection.queue_message(RunJavascriptMessage(source=source))


def plain(value: Any) -> Any:
    """Arrays and their numbers as JSON can hold them."""
    if isinstance(value, np.ndarray):
        return np.round(value.astype(float), 4).tolist()
    if isinstance(value, np.generic):
        return value.item()
    raise TypeError(f"{type(value).__name__} cannot be sent to the page")
