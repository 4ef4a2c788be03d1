"""Which YAML file and which image are one map, and which of the two maps that is."""

from __future__ import annotations

import posixpath
import re
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass
from pathlib import PurePath

from app.model.files.file_kinds import FileKind
from app.model.files.map_slots import PAIR, Uploads, short_name
from app.model.merge_inputs import Upload

NUMBER = re.compile(r"(\d{1,6})$")  # in the end of a name, its suffix apart


@dataclass(frozen=True)
class MapFiles:
    """The files of one map, as far as they are there: at least one of them."""

    text: Upload | None = None
    image: Upload | None = None

    @property
    def kinds(self) -> dict[FileKind, Upload]:
        """What is there, by its kind."""
        both: dict[FileKind, Upload | None] = {"map": self.text, "image": self.image}
        return {kind: part for kind, part in both.items() if part is not None}

    @property
    def parts(self) -> tuple[Upload, ...]:
        return tuple(self.kinds.values())

    @property
    def number(self) -> int | None:
        """The number in the end of its name: 1 of map1.yaml."""
        found = NUMBER.search(PurePath(self.parts[0].name).stem)
        return int(found[1]) if found else None


def maps_in(uploads: Uploads) -> dict[int, MapFiles]:
    """Maps by their number, as far as anything of them is there."""
    maps = {number: MapFiles(uploads.get(f"yaml{number}"), uploads.get(f"image{number}")) for number in PAIR}
    return {number: files for number, files in maps.items() if files.parts}


def uploads_of(maps: Mapping[int, MapFiles]) -> dict[str, Upload]:
    """The same by what each file is for."""
    slots = {f"yaml{number}": files.text for number, files in maps.items()}
    slots |= {f"image{number}": files.image for number, files in maps.items()}
    return {key: upload for key, upload in slots.items() if upload is not None}


def paired(texts: Sequence[Upload], images: Sequence[Upload]) -> list[MapFiles]:
    """YAML files with their images, and images that are left.

    An image belongs to the YAML file that names it, by its path, else by its name alone, for files are moved;
    else to the one that is called as it is. A single one of each that are left go together.
    """
    of: dict[int, Upload] = {}
    named = [image_path(text) for text in texts]

    def take(fits: Callable[[int, Upload], bool], again: bool) -> None:
        for k in range(len(texts)):
            free = [image for image in images if again or image not in of.values()]
            image = next((each for each in free if k not in of and fits(k, each)), None)
            if image is not None:
                of[k] = image

    take(lambda k, image: image.path == named[k], again=True)  # an image may be that of two maps
    take(lambda k, image: image.folder == texts[k].folder and short_name(named[k]) == image.name, again=True)
    take(lambda k, image: short_name(named[k]) == image.name, again=True)
    take(lambda k, image: image.folder == texts[k].folder and _same_stem(texts[k], image), again=False)
    lone = [k for k in range(len(texts)) if k not in of]
    left = [image for image in images if image not in of.values()]
    if len(lone) == len(left) == 1 and _waits_for(MapFiles(texts[lone[0]]), MapFiles(None, left[0])):
        of[lone[0]] = left.pop()
    maps = [MapFiles(text, of.get(k)) for k, text in enumerate(texts)]
    return [*maps, *(MapFiles(None, image) for image in left)]


def joined(maps: dict[int, MapFiles], loose: Sequence[MapFiles]) -> list[MapFiles]:
    """Have files take the place of those of their names, and single ones complete the maps that are there;
    those that belong to none of them.

    maps : by their number; takes them in
    """
    left = []
    for files in loose:
        fits = [number for number, there in maps.items() if _fits(there, files)]
        free = len(maps) < len(PAIR)
        same = [number for number, there in maps.items() if _is_newer(there, files, free)]
        if fits:
            maps[fits[0]] = _together(maps[fits[0]], files)
        elif len(same) == 1:
            maps[same[0]] = files
        else:
            left.append(files)
    waited = [(n, files) for files in left for n, there in maps.items() if _waits_for(there, files)]
    if len(waited) == 1:
        ((number, files),) = waited
        maps[number] = _together(maps[number], files)
        left.remove(files)
    return left


def in_order(maps: Sequence[MapFiles]) -> list[MapFiles]:
    """By the numbers in the ends of their names where all have different ones, else as they came."""
    numbers = [files.number for files in maps]
    if None in numbers or len(set(numbers)) < len(numbers):
        return list(maps)
    return sorted(maps, key=lambda files: files.number or 0)


def place_for(files: MapFiles, maps: Collection[int]) -> int | None:
    """Which map it is: the one of its number where that is free, else the first that is; None: both there.

    maps : numbers of those that are there
    """
    free = [number for number in PAIR if number not in maps]
    return files.number if files.number in free else next(iter(free), None)


def image_path(text: Upload) -> str:
    """The path of the image that a map's YAML file names, as its own stands; raises InputFileError."""
    image = text.meta.image.replace("\\", "/")
    return posixpath.normpath(posixpath.join(text.folder, image))


def _same_stem(text: Upload, image: Upload) -> bool:
    return PurePath(text.name).stem == PurePath(image.name).stem


def _together(there: MapFiles, files: MapFiles) -> MapFiles:
    """A map with a single file in place of its own one."""
    if files.text is not None:
        return MapFiles(files.text, there.image)
    by_form = there.text is not None and there.text.by_form  # it was filled in for another image
    return MapFiles(None if by_form else there.text, files.image)


def _is_newer(there: MapFiles, files: MapFiles, free: bool) -> bool:
    """Whether this is the map that is there, once more. The maps of two robots are often called alike: they
    are told apart by their folders where these are known, else by there being a place that is ``free``.
    """
    one, other = there.text, files.text
    if one is None or other is None or one.name != other.name:
        return False
    if one.folder and other.folder:
        return one.folder == other.folder
    return not free or [part.content for part in there.parts] == [part.content for part in files.parts]


def _waits_for(there: MapFiles, files: MapFiles) -> bool:
    """Whether a map that is there lacks just what this is, and nothing speaks against it."""
    if None not in (there.number, files.number) and there.number != files.number:
        return False
    if files.text is None:
        return there.image is None
    return files.image is None and there.text is None


def _fits(there: MapFiles, files: MapFiles) -> bool:
    """Whether a single file belongs to a map that is there: completes it, or comes in place of another."""
    if files.text is None and files.image is not None:
        if there.text is None or there.text.by_form:
            return there.image is not None and there.image.name == files.image.name
        named = short_name(image_path(there.text)) == files.image.name
        return named or (
            there.image.name == files.image.name if there.image else _same_stem(there.text, files.image)
        )
    if files.text is not None and files.image is None and there.image is not None:
        named = short_name(image_path(files.text)) == there.image.name
        if there.text is None or there.text.by_form:
            return named or _same_stem(files.text, there.image)
        return named and there.text.name == files.text.name
    return False
