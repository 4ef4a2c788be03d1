"""The project as one file, ``NAME.mapmeld``: a zip of its document and of the files that it names."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

from algorithms.common.errors import InputFileError, TooLargeError, unreadable
from algorithms.files.fleet_archive import files_of_zip
from app.model.files.file_kinds import PROJECT_DOCUMENT, PROJECT_SUFFIX
from app.page.project.project_reader import ANEW, saved_tab
from app.page.project.project_writer import Project, bounded_project, project_of
from app.page.undo.undo_history import SavedTab
from app.report.result_files import zip_bytes
from app.system.cancellation import Check, never_cancelled

FOLDER = "files"  # of the zip
MOST_UNPACKED = 500_000_000  # bytes; two maps of the largest size, and the images that they came from


def project_to_bytes(saved: SavedTab, check: Check = never_cancelled) -> bytes:
    """The project's file: its whole history, or the page as it is where that would be too large.

    check  : is called now and then, and may leave the work by raising
    raises : TooLargeError
    """
    files = _files(bounded_project(saved), check)
    if files is None:
        files = _files(project_of(replace(saved, steps=(saved.steps[saved.position],), position=0)), check)
    if files is None:
        raise TooLargeError(f"the project would have more than {MOST_UNPACKED / 1e6:.0f} MB; save the maps")
    return zip_bytes(files)


def _files(project: Project, check: Check) -> dict[str, bytes] | None:
    """What goes into the zip; None where it is too much."""
    files, size = {PROJECT_DOCUMENT: project.document}, len(project.document)
    for digest, content in project.contents.items():
        check()
        files[f"{FOLDER}/{digest}"] = made = content()
        size += len(made)
        if size > MOST_UNPACKED:
            return None
    return files


def project_from_bytes(source: str, content: bytes, check: Check = never_cancelled) -> SavedTab:
    """What a project's file holds.

    source : what the file is called before a person
    check  : is called now and then, and may leave the work by raising
    raises : InputFileError, TooLargeError
    """
    check()
    files = files_of_zip(source, content, MOST_UNPACKED)
    if PROJECT_DOCUMENT not in files:
        raise InputFileError(source, f"is no project: it has no {PROJECT_DOCUMENT}", "give a .mapmeld file")
    return saved_tab(source, files[PROJECT_DOCUMENT], lambda digest: files.get(f"{FOLDER}/{digest}"), check)


def read_project(path: Path) -> SavedTab:
    """Read a project's file; raises InputFileError, TooLargeError."""
    try:
        if path.stat().st_size > MOST_UNPACKED:
            raise InputFileError(path, f"has more than {MOST_UNPACKED / 1e6:.0f} MB", ANEW)
        content = path.read_bytes()
    except (OSError, ValueError) as error:  # ValueError: a NUL in the name
        raise unreadable(path, error, "give a project that was saved on the page") from error
    return project_from_bytes(str(path), content)


def project_name(name: str) -> str:
    """What the file is called, after its pair or fleet: a name that every system takes."""
    stem = re.sub(r"[^\w-]+", "_", name).strip("_")[:60]
    return f"{stem or 'project'}{PROJECT_SUFFIX}"
