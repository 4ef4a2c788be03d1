"""HTML of the files that a person gave, what each was taken for, and what can be done with it."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from html import escape

from algorithms.common.display_text import show_hidden
from algorithms.common.robot_names import RobotNames
from app.model.files.map_files import image_path
from app.model.files.map_slots import KNOWN, PAIR, short_name
from app.model.merge_inputs import Files, OtherFile, Upload

LONGEST = 60  # letters of a path
MOST_ROWS = 40  # of files that are not of the pair
SEEN_AT_ONCE = 6  # lines; what is below is reached by keys, too
HINT = (
    "Or drop them anywhere: each map's YAML file and image, what is known, a fleet.yaml with its maps; or a "
    "zip or folder of them."
)
ORDER = ("yaml1", "image1", "yaml2", "image2", KNOWN)
ROLES = dict(zip(ORDER, ("map 1", "image of map 1", "map 2", "image of map 2", "what is known"), strict=True))
REMOVE = {"remove": "✕"}
AS_MAP = {"map1": "as map 1", "map2": "as map 2"}
SIGNS = {"used": "✓", "refused": "✗"}  # of the rest "·"


@dataclass(frozen=True)
class FileRow:
    """A line of the list.

    state : "used", "missing", "unused" or "refused"
    does  : words on buttons, by what each of them does
    at    : the key of an upload, or the number of another file
    """

    name: str
    told: str
    state: str
    does: Mapping[str, str] = field(default_factory=dict)
    at: str | int = ""


def rows_of(files: Files) -> Iterator[FileRow]:
    """A line for every file, and for those that are missing."""
    uploads = files.uploads
    names = Counter(name for name, _ in {(upload.name, upload.path) for upload in uploads.values()})
    for key in ORDER:
        role, upload, number = ROLES[key], uploads.get(key), key[-1]
        text, image = uploads.get(f"yaml{number}"), uploads.get(f"image{number}")
        if upload is not None and upload.by_form:
            yield FileRow("the form below", role, "used")
        elif upload is not None:
            told = role + (_how_found(text, upload) if text is not None and upload is image else "")
            shown = upload.name if names[upload.name] == 1 else upload.path
            yield FileRow(shown, told, "used", REMOVE, key)
        elif text is not None:
            yield FileRow(short_name(image_path(text)), f"{role}: missing", "missing")
        elif image is not None:
            yield FileRow("a YAML file", f"{role}: missing, or fill in the form", "missing")
    for k, other in enumerate(files.others[:MOST_ROWS]):
        state = "used" if other.used else "refused" if other.told.startswith("cannot") else "unused"
        yield FileRow(other.name, other.told, state, _does(other), k)


def _how_found(text: Upload, image: Upload) -> str:
    """What a person should know of an image that is not where the YAML file of its map says."""
    if text.by_form or image_path(text) == image.path:
        return ""
    named = show_hidden(text.meta.image)
    if short_name(named) == image.name:
        return f", found by its name: it is not at {named[-LONGEST:]}"
    return f"; but {text.name} names {short_name(named)}"


def _does(other: OtherFile) -> Mapping[str, str]:
    if other.upload is None:
        return {}
    use = AS_MAP if other.kind in ("map", "image") else {"use": "use it"} if other.kind == "known" else {}
    return {**use, **REMOVE}


def files_html(files: Files, names: RobotNames) -> str:
    """HTML of the list. A button has what it does and the number of its line, of those with buttons."""
    items, number = "", 0
    for row in rows_of(files):
        told = row.told if isinstance(row.at, int) else names.told(row.told)
        buttons = ""
        for what, words in row.does.items():
            label = escape(f"remove {row.name}" if what == "remove" else f"{row.name} {names.told(words)}")
            buttons += (
                f'<button type="button" data-mm-file="{what}" data-n="{number}" aria-label="{label}" '
                f'title="{label}">{escape(names.told(words))}</button>'
            )
        number += bool(row.does)
        items += (
            f'<li data-state="{row.state}"><i aria-hidden="true">{SIGNS.get(row.state, "·")}</i>'
            f"<span><b>{escape(row.name)}</b> {escape(told)}</span><div>{buttons}</div></li>"
        )
    if len(files.others) > MOST_ROWS:
        items += f"<li><i>·</i><span>and {len(files.others) - MOST_ROWS:,} more</span></li>"
    numbers = {key[-1] for key in files.uploads if key != KNOWN}
    swap = '<button type="button" data-mm-file="swap" data-n="0">Swap the maps</button>'
    below = swap if len(numbers) == len(PAIR) else ""
    below += '<button type="button" data-mm-folder>Open a folder…</button>'
    scrolls = ' tabindex="0"' if items.count("<li") > SEEN_AT_ONCE else ""
    shown = f'<ul aria-label="Files"{scrolls}>{items}</ul>' if items else f"<p>{escape(HINT)}</p>"
    return f'<div class="mm-given">{shown}<div>{below}</div></div>'
