"""Files that came together, as in a zip, and the fleet that they make up."""

from __future__ import annotations

import io
import posixpath
import zipfile
import zlib
from collections.abc import Callable, Mapping
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
TOGETHER = "give the fleet's file and all of its maps"
ANEW = "make the zip anew"
OF_A_SYSTEM = ("__MACOSX", ".")  # how names begin that nobody has packed by intent


def files_of_zip(source: str, content: bytes, most: int | None = None) -> dict[str, bytes]:
    """What a zip holds, by the paths in it. Nothing is ever written to one of them.

    source : what the zip is called before a person
    most   : bytes that all of its files may have together; MOST_UNPACKED unless given
    raises : InputFileError
    """
    most = MOST_UNPACKED if most is None else most
    try:
        archive = zipfile.ZipFile(io.BytesIO(content))
    except BROKEN as error:
        raise InputFileError(source, "is no zip that can be read", ANEW) from error
    with archive:
        infos = archive.infolist()
        unpacked = sum(info.file_size for info in infos)
        if len(infos) > MOST_FILES or unpacked > most:
            found = f"holds {len(infos):,} files of {unpacked / 1e6:,.0f} MB"
            limit = f"give at most {MOST_FILES:,} of {most / 1e6:.0f} MB"
            raise InputFileError(source, found, limit)
        files = {}
        for info in infos:
            path = posixpath.normpath(info.filename.replace("\\", "/"))
            if path.startswith(("/", "../")) or path == "..":
                raise InputFileError(source, "names a file outside of itself", ANEW)
            if info.is_dir() or any(part.startswith(OF_A_SYSTEM) for part in path.split("/")):
                continue
            try:
                with archive.open(info) as stream:
                    files[path] = stream.read(info.file_size)
            except BROKEN as error:
                raise InputFileError(f"{source}: {path}", "cannot be unpacked", ANEW) from error
    return files


def fleet_from_files(
    files: Mapping[str, bytes], fleet: str, check: Callable[[], object] = lambda: None
) -> Fleet:
    """Read a fleet file and the maps that it names: by their paths, else by their names alone.

    files  : by paths, which are shown to a person, and nothing else
    fleet  : path of the fleet file
    check  : is called before every map, and may leave the work by raising
    raises : InputFileError, TooLargeError
    """

    def found(name: str, of: str) -> str:
        """The path of a file that another one names."""
        path = posixpath.normpath(posixpath.join(posixpath.dirname(of), name))
        if path in files:
            return path
        last = PureWindowsPath(name).name  # of another machine, or given without its folder
        beside = posixpath.join(posixpath.dirname(of), last)
        alike = [beside] if beside in files else [each for each in files if posixpath.basename(each) == last]
        if len(alike) != 1:
            why = "of which there are several" if alike else "which is not there"
            raise InputFileError(of, f"names {name}, {why}", TOGETHER)
        return alike[0]

    cells = 0

    def read(name: str) -> GridMap:
        """A map; the same image may stand for many robots, and a small one unpack to a large map."""
        nonlocal cells
        check()
        text = found(name, fleet)
        image = found(parse_meta(text, files[text]).image, text)
        grid = map_from_bytes(text, files[text], image, files[image])
        cells += grid.cells.size
        if cells > MOST_CELLS:
            most = f"{MOST_CELLS / 1e6:.0f} million cells"
            raise TooLargeError(f"{fleet}: its maps have more than {most} together; make them coarser")
        return grid

    return fleet_from_bytes(fleet, files[fleet], read)


def fleet_to_files(fleet: Fleet) -> dict[str, bytes]:
    """The fleet's file and maps by name; zipped, they read back to equal values."""
    names = {name: f"robot_{number}" for number, name in enumerate(fleet.maps, 1)}
    files = {FLEET_FILE: fleet_to_bytes(fleet, {name: f"{stem}.yaml" for name, stem in names.items()})}
    for name, grid in fleet.maps.items():
        files |= map_to_bytes(grid, names[name])
    return files
