"""The maps of two robots as their files make them up, and what is known of them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import PurePath

from algorithms.common.display_text import show_hidden
from algorithms.common.source_file import SourceFile
from algorithms.files.map_file import map_from_bytes
from algorithms.files.observation_file import known_from_bytes
from algorithms.maps.grid_map import GridMap
from app.model.merge_inputs import MapSlot, MergeInputs, Upload
from app.system.cancellation import CancellableReader, Check, never_cancelled

PAIR = (1, 2)  # numbers of the maps
KNOWN = "observation"  # the key of what is known; of a map they are yaml1, image1, yaml2, image2
NO_YAML = (
    "Map {}'s image has no YAML file yet: load it, or fill in the form below the image and press “Use this "
    "map”."
)
Uploads = Mapping[str, Upload]
ReadMaps = dict[tuple[Upload, Upload], GridMap]


def short_name(name: str) -> str:
    """The last part of a file's name only, and not much of it: it is shown to a person, nothing else."""
    return show_hidden(PurePath(name.replace("\\", "/")).name)[:80]


def map_slot(number: int, uploads: Uploads, read: ReadMaps, check: Check = never_cancelled) -> MapSlot:
    """One robot's map, as far as its files are there; raises MapMergeError.

    read  : maps that were read before, by their two files; takes this one in
    check : is called now and then, and may leave the work by raising
    """
    text, image = uploads.get(f"yaml{number}"), uploads.get(f"image{number}")
    if text is None:
        return MapSlot(missing=NO_YAML.format(number) if image is not None else "")
    named = short_name(text.meta.image)  # what is wrong with it is reported at once
    if image is None:
        return MapSlot(missing=f"Map {number}'s YAML file is here. Load its image, too: {named}.")
    if (text, image) not in read:
        content = CancellableReader(image.content, check)
        grid = map_from_bytes(text.name, text.content, image.name, content)
        read[text, image] = replace(grid, made=image.modified)
    doubt = ""
    if named != image.name and not text.by_form:
        doubt = f"{text.name} names the image {named}; loaded is {image.name}. Do they belong together?"
    return MapSlot(read[text, image], doubt=doubt)


def inputs_of(uploads: Uploads, read: ReadMaps | None = None, check: Check = never_cancelled) -> MergeInputs:
    """What the files so far make up; ``read`` and ``check`` as of ``map_slot``. Raises MapMergeError."""
    read = {} if read is None else read
    slots = tuple(map_slot(number, uploads, read, check) for number in PAIR)
    inputs = MergeInputs(slots, name="your files" if uploads else "")
    seen = uploads.get(KNOWN)
    return inputs if seen is None else knowing(inputs, seen)


def knowing(inputs: MergeInputs, seen: Upload) -> MergeInputs:
    """The same maps with what a file says is known of them; raises InputFileError."""
    told = inputs.knowing(known_from_bytes(seen.name, seen.content))
    return told.read_from(SourceFile.of(seen.name, seen.content))
