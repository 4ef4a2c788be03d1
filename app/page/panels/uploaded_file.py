"""What a button for uploads holds, as a file of the page."""

from __future__ import annotations

from typing import Any

import viser

NO_FILE = viser.UploadedFile("", b"")  # what a button holds that holds no file any more


def taken_from(event: viser.GuiEvent[Any]) -> viser.UploadedFile | None:
    """The file of the button, which would keep it, refused or not, for as long as the tab is there.

    None where an earlier call has taken it: where two files came at once the newest counts.
    """
    held = event.target._impl
    file, held.value = held.value, NO_FILE
    return None if file is NO_FILE else file
