"""A fleet as one file: a zip of its fleet file and its maps."""

from __future__ import annotations

import io
import posixpath
import zipfile
import zlib
from pathlib import PureWindowsPath

from algorithms.common.errors import InputFileError, TooLargeError
from algorithms.files.fleet_file import FLEET_FILE, fleet_from_bytes, fleet_to_bytes
from algorithms.files.map_file import map_from_bytes, map_to_bytes, parse_meta
from algorithms.maps.grid_map import GridMap
from algorithms.observations.fleet import Fleet

MOST_UNPACKED = 210_000_000  # bytes of all files together
MOST_CELLS = 200_000_000  # of all maps together: as many as a page holds
MOST_FILES = 2000
# what zipfile raises: NotImplementedError is its word for ways to pack that it does not know
BROKEN = (zipfile.BadZipFile, zlib.error, NotImplementedError, RuntimeError, EOFError, OSError, ValueError)
WHOLE = f"make a zip of {FLEET_FILE}, the maps' YAML files and their images"


def fleet_from_zip(source: str, content: bytes) -> Fleet:
    """Read a zip that holds a fleet file, in whatever folder, and the maps that it names.

    source : what the zip is called before a person
    raises : InputFileError, TooLargeError
    """
    try:
        archive = zipfile.ZipFile(io.BytesIO(content))
    except BROKEN as error:
        raise InputFileError(source, "is no zip that can be read", WHOLE) from error
    with archive:
        infos = archive.infolist()
        unpacked = sum(info.file_size for info in infos)
        if len(infos) > MOST_FILES or unpacked > MOST_UNPACKED:
            found = f"holds {len(infos):,} files of {unpacked / 1e6:,.0f} MB"
            limit = f"give at most {MOST_FILES:,} of {MOST_UNPACKED / 1e6:.0f} MB"
            raise InputFileError(source, found, limit)
        files = {posixpath.normpath(info.filename): info for info in infos if not info.is_dir()}
        fleets = [name for name in files if posixpath.basename(name) == FLEET_FILE]
        fleets.sort(key=lambda name: (name.count("/"), name))
        if not fleets:
            raise InputFileError(source, f"holds no {FLEET_FILE}", WHOLE)
        folder = posixpath.dirname(fleets[0])

        def member(name: str, of: str) -> bytes:
            info = files.get(posixpath.normpath(posixpath.join(folder, name)))
            if info is None:
                raise InputFileError(source, f"{of} names {name}, which is not in it", WHOLE)
            try:
                with archive.open(info) as stream:
                    return stream.read(info.file_size)
            except BROKEN as error:
                raise InputFileError(
                    f"{source}: {name}", "cannot be unpacked", "make the zip anew"
                ) from error

        cells = 0

        def read(name: str) -> GridMap:
            """A map; the same image may stand for many robots, and a small one unpack to a large map."""
            nonlocal cells
            text = member(name, FLEET_FILE)
            beside, image = posixpath.dirname(name), parse_meta(f"{source}: {name}", text).image
            if posixpath.normpath(posixpath.join(folder, beside, image)) not in files:  # of another machine
                image = PureWindowsPath(image).name
            image = posixpath.join(beside, image)
            grid = map_from_bytes(f"{source}: {name}", text, f"{source}: {image}", member(image, name))
            cells += grid.cells.size
            if cells > MOST_CELLS:
                most = f"{MOST_CELLS / 1e6:.0f} million cells"
                raise TooLargeError(f"{source}: its maps have more than {most} together; make them coarser")
            return grid

        return fleet_from_bytes(f"{source}: {fleets[0]}", member(FLEET_FILE, source), read)


def fleet_to_files(fleet: Fleet) -> dict[str, bytes]:
    """The fleet's file and maps by name; zipped, they read back to equal values."""
    names = {name: f"robot_{number}" for number, name in enumerate(fleet.maps, 1)}
    files = {FLEET_FILE: fleet_to_bytes(fleet, {name: f"{stem}.yaml" for name, stem in names.items()})}
    for name, grid in fleet.maps.items():
        files |= map_to_bytes(grid, names[name])
    return files
