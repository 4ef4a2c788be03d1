"""Files that are either whole or not there: written beside their place, then renamed into it."""

from __future__ import annotations

import os
import secrets
from collections.abc import Mapping
from pathlib import Path

from algorithms.errors import OutputError


def write_file(path: Path, data: bytes) -> None:
    """``write_files`` for one file."""
    write_files({path: data})


def write_files(files: Mapping[Path, bytes]) -> None:
    """Write all files, each whole or not at all; missing folders are made.

    Every file is written in full before the first takes its place, so a full disk leaves all the
    old ones as they were. They take their places in the order given: put a file that names another
    after the other.

    files  : what to write where; a link is written through, not replaced
    raises : OutputError that names the file, the cause and the remedy
    """
    written: list[tuple[Path, Path]] = []
    path = Path()
    try:
        for path, data in files.items():
            target = Path(os.path.realpath(path))
            target.parent.mkdir(parents=True, exist_ok=True)
            if target.is_dir():
                raise IsADirectoryError(None, "there is a folder of that name")
            beside = target.parent / f".{secrets.token_hex(8)}.tmp"
            with beside.open("xb") as stream:
                written.append((beside, target))
                stream.write(data)
                stream.flush()
                os.fsync(stream.fileno())  # or a power cut may leave the name on an empty file
        for beside, path in written:
            os.replace(beside, path)
    except (OSError, ValueError) as error:  # ValueError: a NUL in the name
        cause = getattr(error, "strerror", None) or str(error)
        raise OutputError(
            path,
            f"cannot be written ({cause})",
            "see that the folder may be written to and the disk has room, or choose another place",
        ) from error
    finally:
        for beside, _ in written:
            beside.unlink(missing_ok=True)
