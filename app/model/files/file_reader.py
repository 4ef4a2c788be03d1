"""What comes of files that are given at once: a pair of maps, a fleet, robots more, a sighting; and what is
wrong with some of them.
"""

from __future__ import annotations

import posixpath
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from pathlib import PurePath

from algorithms.common.display_text import show_hidden
from algorithms.common.errors import InputFileError, MapMergeError
from algorithms.files.fleet_archive import MOST_UNPACKED, files_of_zip, fleet_from_files
from algorithms.files.map_file import GreyImage, grey_image, map_from_bytes
from algorithms.files.observation_file import known_from_bytes
from algorithms.maps.grid_map import GridMap
from algorithms.observations.fleet import MOST_ROBOTS, Fleet
from app.model.files.bag_maps import maps_of_bag
from app.model.files.file_kinds import kind_of_file
from app.model.files.file_roles import GivenFile, pair_roles, robot_roles, sighting_roles, told_of
from app.model.files.map_slots import (
    KNOWN,
    PAIR,
    ReadMaps,
    Uploads,
    inputs_of,
    knowing,
    map_slot,
    short_name,
)
from app.model.merge_inputs import Files, MergeInputs, OtherFile, Upload
from app.system.cancellation import CancellableReader, Check, never_cancelled

LONGEST_FOLDER = 120  # letters
MOST_TEXTS = MOST_ROBOTS + 16  # YAML files that are read of a choice: a fleet's, and what is known
TOO_MANY = f"not used: at most {MOST_TEXTS} maps and files of what is known are read at once"
NOT_OF_FLEET = "not used: a fleet came with it, which does not name it"
OF_ITS_FLEET = "waits for its fleet"

Greys = dict[Upload, GreyImage]


@dataclass(frozen=True, eq=False)
class OpenedFiles:
    """What is to be shown.

    files    : which is which
    inputs   : the pair; None: it is as it was
    greys    : decoded images that have no YAML file yet
    fleet    : in place of what is there; None: there is none
    robots   : to be added to the fleet that is there, by name
    sighting : files for the sighting from camera and scan
    errors   : what is wrong with some of them
    """

    files: Files
    inputs: MergeInputs | None = None
    greys: Greys = field(default_factory=dict)
    fleet: tuple[str, Fleet] | None = None
    robots: tuple[tuple[str, GridMap], ...] = ()
    sighting: tuple[Upload, ...] = ()
    errors: tuple[MapMergeError, ...] = ()


def upload_at(path: str, content: bytes, otherwise: str = "file") -> Upload:
    """A file under the path that is shown; ``otherwise``: the name of one that has none."""
    folder, name = posixpath.split(path.replace("\\", "/"))
    return Upload(short_name(name) or otherwise, content, folder=show_hidden(folder)[-LONGEST_FOLDER:])


class FileReader:
    """Keeps the maps that it has read as long as their files are used."""

    def __init__(self) -> None:
        self._read: ReadMaps = {}

    def open(
        self,
        before: Files,
        uploads: Sequence[Upload],
        current: MergeInputs,
        fleet_shown: bool = False,
        check: Check = never_cancelled,
    ) -> OpenedFiles:
        """Make of the files what can be made of them.

        before      : the files so far, of which some may wait for these
        current     : the pair on the page, which what is known is for where no map comes
        fleet_shown : whether maps become robots of a fleet
        check       : is called now and then, and may leave the work by raising
        """
        given, told, errors = _kinds(uploads, check)
        fleet = _fleet_among(before, given)
        if fleet is not None:
            opened = self._fleet(before, given, fleet, check)
        else:
            sighting, seen, given = sighting_roles(before, given)
            work = self._robots if fleet_shown and not _is_pair(given) else self._pair
            opened = work(before, given, current, check)
            others = (*opened.files.others, *seen)
            opened = replace(opened, sighting=sighting, files=replace(opened.files, others=others))
        others = _bounded((*opened.files.others, *told))
        return replace(opened, files=replace(opened.files, others=others), errors=(*errors, *opened.errors))

    def pair_of(self, files: Files, current: MergeInputs, check: Check = never_cancelled) -> OpenedFiles:
        """The pair that these files make up, with ``current`` and ``check`` as of ``open``; raises
        MapMergeError.
        """
        greys, bad = self._read_maps(files.uploads, check)
        if bad is not None:
            raise bad[1]
        return OpenedFiles(files, self._inputs(files, current, check), greys)

    def _inputs(self, files: Files, current: MergeInputs, check: Check) -> MergeInputs:
        uploads = files.uploads
        used = {(uploads.get(f"yaml{number}"), uploads.get(f"image{number}")) for number in PAIR}
        self._read = {both: grid for both, grid in self._read.items() if both in used}
        if files.sample or (current.grids and set(uploads) == {KNOWN}):  # the maps stay
            return knowing(current, uploads[KNOWN]) if KNOWN in uploads else current.knowing(())
        return inputs_of(uploads, self._read, check)

    def _pair(self, before: Files, given: list[GivenFile], current: MergeInputs, check: Check) -> OpenedFiles:
        errors: list[MapMergeError] = []
        told: list[OtherFile] = []
        while True:
            files = pair_roles(before, given)
            greys, bad = self._read_maps(files.uploads, check)
            if bad is None:
                break
            number, error = bad
            parts = files.uploads.get(f"yaml{number}"), files.uploads.get(f"image{number}")
            refused = [one for one in given if any(one.upload is part for part in parts)]
            if not refused:  # it was there before, and could be read
                raise error
            errors.append(error)
            told += [_refused(one.upload, error) for one in refused]
            given = [one for one in given if one not in refused]
        files = replace(files, others=(*files.others, *told))
        same = files.uploads == before.uploads
        inputs = None if same else self._inputs(files, current, check)
        return OpenedFiles(files, inputs, greys, errors=tuple(errors))

    def _read_maps(self, uploads: Uploads, check: Check) -> tuple[Greys, tuple[int, MapMergeError] | None]:
        """Images without a YAML file, decoded; and which map cannot be read, and why."""
        greys: Greys = {}
        for number in PAIR:
            image = uploads.get(f"image{number}")
            try:
                map_slot(number, uploads, self._read, check)
                if image is not None and f"yaml{number}" not in uploads:
                    greys[image] = grey_image(image.name, CancellableReader(image.content, check))
            except MapMergeError as error:
                return greys, (number, error)
        return greys, None

    def _robots(
        self, before: Files, given: list[GivenFile], current: MergeInputs, check: Check
    ) -> OpenedFiles:
        maps, files = robot_roles(before, given)
        robots, errors, told = [], [], []
        for one in maps:
            assert one.text is not None
            assert one.image is not None
            try:
                content = CancellableReader(one.image.content, check)
                grid = map_from_bytes(one.text.name, one.text.content, one.image.name, content)
            except MapMergeError as error:
                errors.append(error)
                told += [_refused(part, error) for part in one.parts]
                continue
            name = PurePath(one.text.name).stem
            robots.append((name, grid))
            told += [OtherFile(part.name, f"robot {name}", used=True) for part in one.parts]
        files = replace(files, others=(*told, *files.others))
        return OpenedFiles(files, robots=tuple(robots), errors=tuple(errors))

    def _fleet(self, before: Files, given: list[GivenFile], fleet: Upload, check: Check) -> OpenedFiles:
        """Of all files that there are; while some are missing, the others wait for them."""
        waiting = [other.upload for other in before.others if other.upload is not None]
        there = [*before.uploads.values(), *waiting, *(one.upload for one in given)]
        contents = {upload.path: upload.content for upload in there}
        try:
            made = fleet_from_files(contents, fleet.path, check)
        except MapMergeError as error:
            beside = [_beside_fleet(one) for one in given if one.upload is not fleet]
            left = [other for other in before.others if other.upload not in (None, fleet)]
            first = told_of(fleet, "fleet", _why(error))
            return OpenedFiles(replace(before, others=(first, *left, *beside)), errors=(error,))
        robots = [
            OtherFile(" + ".join(file.name for file in grid.files), f"robot {name}", used=True)
            for name, grid in made.maps.items()
        ]
        named = {file.name for grid in made.maps.values() for file in grid.files}
        beside = [
            replace(_beside_fleet(one), told=NOT_OF_FLEET, upload=None)
            for one in given
            if one.upload is not fleet and one.upload.name not in named
        ]
        first = OtherFile(fleet.name, f"a fleet of {len(made.maps)} robots", used=True)
        name = PurePath(fleet.folder.split("/")[-1]).name or PurePath(fleet.name).stem
        return OpenedFiles(Files(others=(first, *robots, *beside)), fleet=(name, made))


def _kinds(
    uploads: Sequence[Upload], check: Check
) -> tuple[list[GivenFile], list[OtherFile], list[MapMergeError]]:
    """Files with their kinds, those of zips and recordings among them; what is told of the others, and what
    is wrong.

    What is no file of ours is wrong where it was given by itself; beside others in a folder it may well lie.
    """
    given: list[GivenFile] = []
    told: list[OtherFile] = []
    errors: list[MapMergeError] = []
    waiting, texts = list(uploads), 0
    while waiting:
        check()
        upload = waiting.pop(0)
        kind = None
        try:
            kind = kind_of_file(upload.name, upload.content)
            texts += kind in ("map", "known")
            if texts > MOST_TEXTS and kind in ("map", "known"):
                told.append(OtherFile(upload.name, TOO_MANY))
                continue
            if kind == "zip" and not upload.folder:
                inside = files_of_zip(upload.name, upload.content)
                stem = PurePath(upload.name).stem
                waiting += [upload_at(f"{stem}/{path}", content) for path, content in inside.items()]
                continue
            if kind == "bag":
                waiting += maps_of_bag(upload, check)
                continue
            if kind == "map":
                _ = upload.meta  # may raise
            elif kind == "known":
                known_from_bytes(upload.name, upload.content)
        except MapMergeError as error:
            if kind is not None or not upload.folder:
                errors.append(error)
            told.append(_refused(upload, error))
            continue
        given.append(GivenFile(kind, upload))
    return given, told, errors


def _beside_fleet(one: GivenFile) -> OtherFile:
    """What is told of a file that came with a fleet of which maps are missing."""
    if one.kind in ("map", "image"):
        return told_of(one.upload, one.kind, OF_ITS_FLEET)
    return OtherFile(one.upload.name, NOT_OF_FLEET)


def _is_pair(given: list[GivenFile]) -> bool:
    """Whether these are two maps and what is known of them, whatever else there is."""
    kinds = [one.kind for one in given]
    return kinds.count("map") >= len(PAIR) and "known" in kinds


def _fleet_among(before: Files, given: list[GivenFile]) -> Upload | None:
    """The fleet's file that came, the one in the outermost folder; else the one that waits for its maps."""
    came = [one.upload for one in given if one.kind == "fleet"]
    others = () if _is_pair(given) else before.others
    waiting = [other.upload for other in others if other.kind == "fleet" and other.upload is not None]
    return min(came or waiting, key=lambda upload: (upload.path.count("/"), upload.path), default=None)


def _bounded(others: tuple[OtherFile, ...]) -> tuple[OtherFile, ...]:
    """The same with one file of each path kept, the newest, and so many as may wait."""
    kept: dict[str, int] = {}
    left = []
    for other in others:
        if other.upload is not None:
            if other.upload.path in kept:
                continue
            kept[other.upload.path] = len(other.upload.content)
            if sum(kept.values()) > MOST_UNPACKED:
                other = replace(other, upload=None)
        left.append(other)
    return tuple(left)


def _refused(upload: Upload, error: MapMergeError) -> OtherFile:
    return OtherFile(upload.name, f"cannot be used: {_why(error)}")


def _why(error: MapMergeError) -> str:
    return f"{error.found}; {error.remedy}" if isinstance(error, InputFileError) else str(error)
