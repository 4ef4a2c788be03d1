"""Which file of a sighting is which, by what it holds: what it is called does not count."""

from __future__ import annotations

import re
from typing import Literal

from algorithms.common.errors import InputFileError
from algorithms.files.camera_file import OST_TXT
from algorithms.files.camera_picture import is_picture

FileKind = Literal["picture", "camera", "scan", "encounters", "model"]

HEAD = 65536  # bytes that are looked at
ZIP, PICKLE = b"PK", b"\x80"
WIDE = (b"\xff\xfe", b"\xfe\xff")  # UTF-16, as the shell of Windows writes it


def _key(*names: str) -> re.Pattern[str]:
    """A line that begins with one of these keys."""
    return re.compile(rf"^[ \t{{]*(?:{'|'.join(names)})[ \t]*:", flags=re.M)


SCAN = _key("ranges", "angle_increment", "range_max")
CAMERA = _key("camera_matrix", "image_width", "distortion_\\w+", "field_of_view", "binning_x", "[kK]")
TABLE = re.compile(r"\A(?:sep=.\s+)?[^\n]*\b(?:observer_x|observed_x)\b", flags=re.I)
# others' files that are taken for one of ours, and where they belong
ELSEWHERE = (
    (_key("resolution", "occupied_thresh"), "is a map's YAML file", "load it under Maps, Upload your own"),
    (
        _key("observer", "observed", "observations", "measurement", "initial", "near"),
        "says what is known of how the maps lie",
        "load it under Maps, Upload your own, What is known",
    ),
    (_key("robots", "sightings"), "is a fleet's YAML file", "load its zip under Maps, Upload your own"),
)
GIVE = "give a JPEG or PNG, the camera's camera.yaml, or the laser's scan.yaml"


def kind_of_file(name: str, content: bytes) -> FileKind:
    """What a file is; raises InputFileError where it is none of a sighting's."""
    if not content:
        raise InputFileError(name, "is empty", GIVE)
    if is_picture(content):
        return "picture"
    if content.startswith((ZIP, PICKLE)):  # whose reader tells of zips that are none
        return "model"
    head = content[:HEAD]
    text = head.decode("utf-16" if head.startswith(WIDE) else "utf-8-sig", errors="replace").lstrip()
    if head.lstrip().startswith(OST_TXT) or CAMERA.search(text):
        return "camera"
    if SCAN.search(text):
        return "scan"
    if TABLE.match(text):
        return "encounters"
    for pattern, found, remedy in ELSEWHERE:
        if pattern.search(text):
            raise InputFileError(name, found, remedy)
    raise InputFileError(name, "is neither an image, nor a camera's calibration, nor a laser scan", GIVE)
