"""How a recording is named: its file or folder, and where it is asked for, a topic and a time."""

from __future__ import annotations

import re
from dataclasses import dataclass
from math import isfinite
from pathlib import Path

from algorithms.files.foreign_files import BAG_FOLDER, HEAD, SQLITE, is_rosbag2_database

NANO = 1_000_000_000  # nanoseconds of a second
SINCE_1970 = 1e8  # seconds; what is less counts from the start of the recording
ROS1, MCAP = b"#ROSBAG V", b"\x89MCAP0\r\n"  # what files of these kinds begin with
ABOUT = "metadata.yaml"  # in the folder of a recording of ROS 2
FORM = re.compile(r"(?P<path>.+?)(?:#(?P<topic>[^@#]+))?(?:@(?P<time>-?[0-9.]+))?", flags=re.S)


@dataclass(frozen=True)
class BagPath:
    """A recording, and what is asked of it.

    path  : of its file, or the folder of ROS 2
    topic : of the map; empty where there is only one to choose
    time  : seconds: since 1970 from SINCE_1970 on, since the recording began below that, before its end where
            negative; None: its end
    """

    path: Path
    topic: str = ""
    time: float | None = None

    def __str__(self) -> str:
        topic = f"#{self.topic}" if self.topic else ""
        return f"{self.path}{topic}" + ("" if self.time is None else f"@{self.time:.10g}")


def bag_path(path: Path | str) -> BagPath | None:
    """A path ``BAG[#/topic][@TIME]`` taken apart; None where it names no recording that is there."""
    whole = Path(path)
    if whole.name == ABOUT and is_bag(whole.parent):
        whole = whole.parent
    if whole.exists():
        return BagPath(whole) if is_bag(whole) else None
    form = FORM.fullmatch(str(path))
    if form is None or not (form["topic"] or form["time"]) or not is_bag(Path(form["path"])):
        return None
    topic = f"/{form['topic'].strip('/')}" if form["topic"] else ""
    return BagPath(Path(form["path"]), topic, _number(form["time"]))


def is_bag(path: Path) -> bool:
    """Whether a file or folder that is there is a recording, by its first bytes; it may be damaged."""
    try:
        if path.is_dir():
            about = path / ABOUT
            return about.is_file() and BAG_FOLDER in _head(about)
        return bool(suffix_of(_head(path), path.name))
    except (OSError, ValueError):  # ValueError: a NUL in the name
        return False


def suffix_of(content: bytes, name: str = "") -> str:
    """What the name of a recording with this content ends in, by its first bytes; "" where it is none.

    name : as it is; a database without tables is a recording where that says so
    """
    for first, suffix in ((ROS1, ".bag"), (MCAP, ".mcap")):
        if content.startswith(first):
            return suffix
    return ".db3" if content.startswith(SQLITE) and is_rosbag2_database(name, content[:HEAD]) else ""


def is_ros1(path: Path) -> bool:
    """Whether a recording is one of ROS 1."""
    return path.is_file() and _head(path).startswith(ROS1)


def bag_kind(path: Path) -> str:
    """What a recording is, as a person calls it."""
    if path.is_dir():
        return "a rosbag2 folder"
    head = _head(path)
    if head.startswith(ROS1):
        return "a ROS 1 bag"
    return "an MCAP bag" if head.startswith(MCAP) else "a ROS 2 bag (rosbag2)"


def _head(path: Path) -> bytes:
    with path.open("rb") as stream:
        return stream.read(HEAD)


def _number(text: str | None) -> float | None:
    try:
        number = None if text is None else float(text)
    except ValueError:
        return None
    return number if number is None or isfinite(number) else None


def nanoseconds(time: float, begin: int, end: int) -> int:
    """A time of ``BagPath`` in nanoseconds since 1970, in a recording from ``begin`` to ``end``."""
    if time >= SINCE_1970:
        return round(time * NANO)
    return (end if time < 0 else begin) + round(time * NANO)
