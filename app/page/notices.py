"""The notice in the corner of a tab: at most one."""

from __future__ import annotations

from typing import Literal

import viser

from algorithms.common.errors import InputFileError, MapMergeError, TooLargeError
from app.drawing.browser_messages import BrowserMessages
from app.page.page_state import TabLocks


class Notices:
    """Of one tab."""

    def __init__(self, client: viser.ClientHandle, messages: BrowserMessages, locks: TabLocks) -> None:
        self._client, self._messages, self._locks = client, messages, locks
        self._shown: viser.NotificationHandle | None = None

    def report(self, error: MapMergeError) -> None:
        """Say what is wrong with an input, as a notice and over the map."""
        title = "Too large" if isinstance(error, TooLargeError) else "This cannot be used"
        text = str(error)
        if not isinstance(error, InputFileError):  # that begins with a file's name
            text = text[:1].upper() + text[1:]
        with self._locks.drawing:
            self.show(title, self._messages.names.told(text), "orange")
            self._messages.hud(state=text, mood="failed", progress=None)
            self._messages.flush()

    def show(self, title: str, text: str, colour: Literal["orange", "red"]) -> None:
        """Show a notice in place of the last one."""
        self.clear()
        self._shown = self._client.add_notification(title, text, auto_close_seconds=12.0, color=colour)

    def clear(self) -> None:
        """What the last notice said is mended, or out of date."""
        if self._shown is not None:
            self._shown.remove()
            self._shown = None
