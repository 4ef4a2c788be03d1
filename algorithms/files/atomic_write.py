"""Files that are either whole or not there: written beside their place, then renamed into it."""

from __future__ import annotations

import os
import secrets
from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path
from tempfile import TemporaryFile

from algorithms.common.errors import OutputError

REMEDY = "see that the folder may be written to and the disk has room, or choose another place"


def write_file(path: Path, data: bytes) -> None:
    """``write_files`` for one file."""
    write_files({path: data})


def write_files(files: Mapping[Path, bytes]) -> None:
    """Write all files, each whole or not at all; missing folders are made.

    Every file is written in full before the first takes its place, so a full disk leaves all the
    old ones as they were, and no new folder; an interrupt leaves all the old ones or all the new.
    They take their places in the order given: put a file that names another after the other.

    files  : what to write where; a link is written through, not replaced
    raises : OutputError that names the file, the cause and the remedy
    """
    written: list[tuple[Path, Path]] = []
    made: list[Path] = []
    placing = False
    path = Path()
    try:
        for path, data in files.items():
            target = _target(path)
            made += [folder for folder in target.parents if not folder.exists()]
            target.parent.mkdir(parents=True, exist_ok=True)
            beside = target.parent / f".{secrets.token_hex(8)}.tmp"
            written.append((beside, target))  # before it is there: an interrupt may come at any time
            with beside.open("xb") as stream:
                stream.write(data)
                stream.flush()
                os.fsync(stream.fileno())  # or a power cut may leave the name on an empty file
        placing = True
        for beside, path in written:
            os.replace(beside, path)
        made.clear()
    except KeyboardInterrupt:
        if placing:  # a moment at the most: rather all of the new files than some of them
            for beside, path in written:
                if beside.exists():
                    os.replace(beside, path)
            made.clear()
        raise
    except (OSError, ValueError) as error:  # ValueError: a NUL in the name
        raise OutputError(path, f"cannot be written ({_cause(error)})", REMEDY) from error
    finally:
        for beside, _ in written:
            with suppress(OSError):  # never made, or in its place by now, or the disk bears nothing any more
                beside.unlink()
        for folder in sorted(made, key=lambda folder: -len(folder.parts)):
            with suppress(OSError):  # never made, or something is in it
                folder.rmdir()


def check_file(path: Path) -> None:
    """``check_folder`` for the place of one file."""
    try:
        target = _target(path)
    except (OSError, ValueError) as error:
        raise OutputError(path, f"cannot be written ({_cause(error)})", REMEDY) from error
    check_folder(target.parent)


def check_folder(folder: Path) -> None:
    """Raise OutputError where no file could be written in a folder, there already or still to be made.

    For before long work: what it is to leave should not be lost at its end. Leaves nothing behind.
    """
    try:
        place = asked = Path(os.path.realpath(folder))
        while not place.exists():
            place = place.parent
        if not place.is_dir():
            raise NotADirectoryError(None, f"{'it' if place == asked else place} is a file, not a folder")
        with TemporaryFile(dir=place):
            pass
    except (OSError, ValueError) as error:
        raise OutputError(folder, f"cannot be written to ({_cause(error)})", REMEDY) from error


def _target(path: Path) -> Path:
    """Where a file really goes, links followed."""
    if path.is_dir():
        raise IsADirectoryError(None, "there is a folder of that name")
    if path.exists() and not path.is_file():  # renamed into its place, a file would do away with it
        raise OSError(None, "it is a device or a pipe, no file")
    return Path(os.path.realpath(path))


def _cause(error: OSError | ValueError) -> str:
    return getattr(error, "strerror", None) or str(error)
