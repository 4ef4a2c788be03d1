"""What a file is, by what it holds: what it is called does not count."""

from __future__ import annotations

import re
from typing import Literal

from algorithms.common.errors import InputFileError
from algorithms.files.bags.bag_path import suffix_of
from algorithms.files.camera_file import OST_TXT
from algorithms.files.camera_picture import is_picture
from algorithms.files.foreign_files import check_foreign
from algorithms.files.images.picture_headers import JPEG, is_webp

FileKind = Literal[
    "map",
    "image",
    "known",
    "fleet",
    "truth",
    "zip",
    "bag",
    "picture",
    "camera",
    "scan",
    "encounters",
    "model",
]

KINDS: dict[FileKind, str] = {
    "map": "a map's YAML file",
    "image": "an image",
    "known": "what is known of how the maps lie",
    "fleet": "a fleet's YAML file",
    "truth": "a known answer",
    "zip": "a zip",
    "bag": "a recording",
    "picture": "a camera's image",
    "camera": "a camera's calibration",
    "scan": "a laser scan",
    "encounters": "a table of encounters",
    "model": "a detector",
}
"""What each is called before a person."""

HEAD = 65536  # bytes that are looked at
ZIP, PICKLE = b"PK", b"\x80"
WIDE = (b"\xff\xfe", b"\xfe\xff")  # UTF-16, as the shell of Windows writes it
NAME_AT, NAME_LENGTH_AT = 30, 26  # bytes of a zip before the name of its first file, and before its length
PROJECT_SUFFIX = ".mapmeld"
PROJECT_DOCUMENT = "project.json"  # the first file of its zip
UNKNOWN = "is nothing that is known here"
GIVE = "give a map's YAML file or image, what is known, a fleet, a recording, a zip, or a sighting's files"


def _key(*names: str) -> re.Pattern[str]:
    """A line that begins with one of these keys, in whatever list or mapping."""
    return re.compile(rf"^[ \t{{-]*(?:{'|'.join(names)})[ \t]*:", flags=re.M)


# the first one counts: each kind has keys that those above it lack
TEXTS: tuple[tuple[FileKind, re.Pattern[str]], ...] = (
    ("camera", _key("camera_matrix", "image_width", "distortion_\\w+", "field_of_view", "binning_x", "[kK]")),
    ("scan", _key("ranges", "angle_increment", "range_max")),
    ("encounters", re.compile(r"\A(?:sep=.\s+)?[^\n]*\b(?:observer_x|observed_x)\b", flags=re.I)),
    ("fleet", re.compile(r"^\{?[ \t]*(?:robots|sightings)[ \t]*:", flags=re.M)),
    ("truth", _key("T_ref_mov", "T_anchor_robot", "expected")),
    ("known", _key("observer", "observed", "observations", "measurement", "initial", "turn", "near")),
    ("map", _key("image", "resolution", "occupied_thresh", "free_thresh", "negate")),
)


def is_project(name: str, content: bytes) -> bool:
    """Whether a file is a project, or is called one."""
    first = _first_in_zip(content) if content.startswith(ZIP) else b""
    return name.lower().endswith(PROJECT_SUFFIX) or first == PROJECT_DOCUMENT.encode()


def kind_of_file(name: str, content: bytes) -> FileKind:
    """What a file is; raises InputFileError where it is nothing that is used here.

    name : of the file, as the user knows it
    """
    if not content:
        raise InputFileError(name, "is empty", GIVE)
    if is_picture(content):
        lossy = content.startswith(JPEG) or is_webp(content)
        return "picture" if lossy else "image"
    if is_project(name, content):
        raise InputFileError(name, "is a project", "open it by itself")
    if content.startswith(ZIP):
        return "model" if _first_in_zip(content).endswith(b".npy") else "zip"
    if content.startswith(PICKLE):  # whose reader tells what that is
        return "model"
    if suffix_of(content, name):
        return "bag"
    head = content[:HEAD]
    if head.lstrip().startswith(OST_TXT):
        return "camera"
    check_foreign(name, content)
    text = head.decode("utf-16" if head.startswith(WIDE) else "utf-8-sig", errors="replace").lstrip()
    for kind, pattern in TEXTS:
        if pattern.search(text):
            return kind
    raise InputFileError(name, UNKNOWN, GIVE)


def _first_in_zip(content: bytes) -> bytes:
    length = int.from_bytes(content[NAME_LENGTH_AT : NAME_LENGTH_AT + 2], "little")
    return content[NAME_AT : NAME_AT + length]
