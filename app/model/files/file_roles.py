"""What each of the files is for that a person gives at once: two maps and what is known of them, robots,
a sighting. None of them is read here but the names of images.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, replace

from algorithms.files.observation_file import OBSERVATION_FILE
from app.model.files.file_kinds import KINDS, FileKind
from app.model.files.map_files import (
    MapFiles,
    image_path,
    in_order,
    joined,
    maps_in,
    paired,
    place_for,
    uploads_of,
)
from app.model.files.map_slots import KNOWN, PAIR, short_name
from app.model.merge_inputs import Files, OtherFile, Upload

OF_A_SIGHTING: tuple[FileKind, ...] = ("camera", "scan", "encounters", "model")  # and a picture
BOTH_THERE = "not used: two maps are there already"
ROBOT_WAITS = "a robot: its {} is missing"
OF_A_MOMENT = "not used: {} was taken, which is of one moment"
ANOTHER = "not used: {} was taken"
A_TRUTH = "not used: a known answer, which mapmeld evaluate reads"
OF_A_PAIR = "not used: open a pair of the fleet to load what is known of it"
SENSORS = "{}: see From camera and scan"


@dataclass(frozen=True, eq=False)
class GivenFile:
    """A file that has come, and its kind."""

    kind: FileKind
    upload: Upload


def sighting_roles(
    before: Files, given: Sequence[GivenFile]
) -> tuple[tuple[Upload, ...], tuple[OtherFile, ...], list[GivenFile]]:
    """What goes to the sighting from camera and scan, one file of each kind; what is told of files of those
    kinds; and the other files.

    An image that no YAML file names is the camera's where other files of a sighting come with it.
    """
    there = [files.text for files in (*maps_in(before.uploads).values(), *_loose(before, given))]
    named = {short_name(image_path(text)) for text in there if text is not None}
    seeing = any(one.kind in OF_A_SIGHTING for one in given)

    def kind_of(one: GivenFile) -> FileKind:
        if one.kind in ("picture", "image"):
            of_a_map = one.upload.name in named or (one.kind == "image" and not seeing)
            return "image" if of_a_map else "picture"
        return one.kind

    known_better = [replace(one, kind=kind_of(one)) for one in given]
    seen = [one for one in known_better if one.kind in (*OF_A_SIGHTING, "picture")]
    taken: dict[FileKind, Upload] = {}
    told = []
    for one in sorted(seen, key=lambda one: _natural(one.upload.name)):
        first = taken.setdefault(one.kind, one.upload)
        used = first is one.upload
        words = SENSORS.format(KINDS[one.kind]) if used else OF_A_MOMENT.format(first.name)
        told.append(OtherFile(one.upload.name, words, used))
    # which robot stood where is known once the image is there that the table names
    order = sorted(taken, key=lambda kind: kind == "picture")
    others = [one for one in known_better if one not in seen]
    return tuple(taken[kind] for kind in order), tuple(told), others


def pair_roles(before: Files, given: Sequence[GivenFile]) -> Files:
    """The files of two maps and of what is known of them, once these have come.

    Two maps at once, with what comes beside them, take the place of everything.
    """
    loose = _loose(before, given)
    new = {id(one.upload) for one in given}
    came = [files for files in loose if new & {id(part) for part in files.parts}]
    whole = [files for files in came if files.text is not None]
    maps, known, spare = maps_in(before.uploads), before.uploads.get(KNOWN), []
    others = [other for other in before.others if other.upload is not None]
    if len(whole or came) >= len(PAIR):
        ordered = in_order(whole or came)
        maps, known, others = dict(zip(PAIR, ordered, strict=False)), None, []
        spare = [*ordered[len(PAIR) :], *(files for files in came if files not in ordered)]
    else:
        if came and before.sample:
            known = None  # of other maps
        for files in joined(maps, came):
            number = place_for(files, maps)
            if number is None:
                spare.append(files)
            else:
                maps[number] = files
    seen = [one for one in given if one.kind == "known"]
    best = min(seen, key=lambda one: _rank(one.upload, maps), default=None)
    known = known if best is None else best.upload
    uploads = uploads_of(maps) | ({} if known is None else {KNOWN: known})
    told = [
        told_of(one.upload, "known", ANOTHER.format(best.upload.name))
        for one in seen
        if best is not None and one is not best
    ]
    told += [told_of(part, kind, BOTH_THERE) for files in spare for kind, part in files.kinds.items()]
    used = {id(upload) for upload in uploads.values()}
    left = [other for other in others if id(other.upload) not in used]
    return Files("" if came else before.sample, uploads, (*told, *left, *_truths(given)))


def robot_roles(before: Files, given: Sequence[GivenFile]) -> tuple[list[MapFiles], Files]:
    """Maps that become robots of the fleet on the page, and what is told of the other files."""
    loose = _loose(before, given)
    robots = [files for files in loose if files.text is not None and files.image is not None]
    told = [
        told_of(part, kind, ROBOT_WAITS.format("YAML file" if kind == "image" else "image"))
        for files in loose
        if files not in robots
        for kind, part in files.kinds.items()
    ]
    seen = [OtherFile(one.upload.name, OF_A_PAIR) for one in given if one.kind == "known"]
    return robots, replace(before, others=(*told, *seen, *_truths(given)))


def with_other(files: Files, number: int, place: int) -> Files:
    """The same where a file that was not used is used, and the map that it belongs to.

    number : of the file among the others, from 0
    place  : 1 or 2, which map it becomes; of no matter where it is what is known
    """
    other = files.others[number]
    maps, known = maps_in(files.uploads), files.uploads.get(KNOWN)
    if other.upload is None:
        return files
    back: list[OtherFile] = []
    if other.kind == "known":
        if known is not None:
            back = [told_of(known, "known", ANOTHER.format(other.name))]
        known, sample = other.upload, files.sample
    else:
        chosen = next(each for each in _loose(files, ()) if other.upload in each.parts)
        gone = maps.get(place, MapFiles()).kinds.items()
        back = [told_of(part, kind, BOTH_THERE) for kind, part in gone if not part.by_form]
        maps[place], sample = chosen, ""
    uploads = uploads_of(maps) | ({} if known is None else {KNOWN: known})
    left = [each for each in files.others if each.upload not in uploads.values()]
    return Files(sample, uploads, (*left, *back))


def swapped(files: Files) -> Files:
    """The same where map 1 is map 2."""
    maps = {len(PAIR) + 1 - number: there for number, there in maps_in(files.uploads).items()}
    seen = {key: upload for key, upload in files.uploads.items() if key == KNOWN}
    return replace(files, uploads=uploads_of(maps) | seen)


def told_of(upload: Upload, kind: FileKind, words: str) -> OtherFile:
    """A file that is not used, of which something may be made yet."""
    return OtherFile(upload.name, words, upload=upload, kind=kind)


def _loose(before: Files, given: Sequence[GivenFile]) -> list[MapFiles]:
    """Maps among the files that came and those that wait."""
    waiting = [(other.kind, other.upload) for other in before.others if other.upload is not None]
    all_ = [*((one.kind, one.upload) for one in given), *waiting]
    texts, images = ([upload for each, upload in all_ if each == kind] for kind in ("map", "image"))
    return paired(texts, images)


def _truths(given: Sequence[GivenFile]) -> list[OtherFile]:
    return [OtherFile(one.upload.name, A_TRUTH) for one in given if one.kind == "truth"]


def _rank(seen: Upload, maps: dict[int, MapFiles]) -> tuple[bool, bool]:
    """How little a file of what is known seems to be the one of these maps: by its folder, then its name."""
    folders = {part.folder for there in maps.values() for part in there.parts}
    return seen.folder not in folders, seen.name != OBSERVATION_FILE


def _natural(name: str) -> list[tuple[int, str]]:
    """By which seen_2 comes before seen_10."""
    return [(int(part), "") if part.isdigit() else (-1, part) for part in re.split(r"(\d{1,9})", name)]
