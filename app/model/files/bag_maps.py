"""The maps in a recording that was uploaded, as the files that they would be."""

from __future__ import annotations

import posixpath
from pathlib import Path, PurePath
from tempfile import TemporaryDirectory

from algorithms.common.errors import InputFileError
from algorithms.files.bags.bag_path import BagPath, suffix_of
from algorithms.files.bags.bag_reader import open_bag
from algorithms.files.bags.map_messages import choose_maps, read_bag_map
from algorithms.files.fleet_archive import MOST_UNPACKED
from algorithms.files.map_file import map_to_bytes
from app.model.merge_inputs import Upload
from app.system.cancellation import Check, never_cancelled


def maps_of_bag(upload: Upload, check: Check = never_cancelled) -> list[Upload]:
    """The last map of every topic, a YAML file and an image each; raises InputFileError, TooLargeError.

    check : is called before each, and may leave the work by raising
    """
    stem = PurePath(upload.name).stem
    folder = posixpath.join(upload.folder, stem)
    files: list[Upload] = []
    with TemporaryDirectory() as place:
        path = Path(place, f"{stem}{suffix_of(upload.content)}")
        path.write_bytes(upload.content)
        try:
            with open_bag(path) as bag:
                topics = choose_maps(bag)
            for topic in topics:
                check()
                if sum(len(file.content) for file in files) > MOST_UNPACKED:
                    found = f"its {len(topics)} maps are more than {MOST_UNPACKED // 10**6} MB"
                    raise InputFileError(upload.name, found, "take them out with: mapmeld bag map BAG#/topic")
                grid = read_bag_map(BagPath(path, topic.name))
                name = stem if len(topics) == 1 else f"{stem}{topic.name.replace('/', '_')}"
                files += [
                    Upload(each, data, folder=folder, modified=grid.made)
                    for each, data in map_to_bytes(grid, name).items()
                ]
        except InputFileError as error:
            raise InputFileError(upload.name, error.found, error.remedy) from error
    return files
