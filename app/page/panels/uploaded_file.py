"""What a button for uploads holds, as a file of the page."""

from __future__ import annotations

from pathlib import PurePath
from typing import Any

import viser

from algorithms.common.display_text import show_hidden
from app.model.merge_inputs import Upload

NO_FILE = viser.UploadedFile("", b"")  # what a button holds that holds no file any more


def short_name(name: str) -> str:
    """The last part of a file's name only, and not much of it: it is shown to a person, nothing else."""
    return show_hidden(PurePath(name.replace("\\", "/")).name)[:80]


def taken_from(event: viser.GuiEvent[Any]) -> viser.UploadedFile | None:
    """The file of the button, which would keep it, refused or not, for as long as the tab is there.

    None where an earlier call has taken it: where two files came at once the newest counts.
    """
    held = event.target._impl
    file, held.value = held.value, NO_FILE
    return None if file is NO_FILE else file


def upload_of(file: viser.UploadedFile, otherwise: str) -> Upload:
    """The file under the name that is shown; ``otherwise``: of one that has none."""
    return Upload(short_name(file.name) or otherwise, file.content)
