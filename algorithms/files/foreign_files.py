"""Files that other tools keep their maps in: what each is, by its first bytes, and how to get a map of it."""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path

from algorithms.common.errors import InputFileError

HEAD = 65536  # bytes that are looked at
BAG_FOLDER = b"rosbag2_bagfile_information"  # in metadata.yaml
SAVE_MAP = "save its map with: mapmeld bag map BAG --out map.yaml"
GRID_OF_RTAB = "export its grid map (File, Export 2D map in rtabmap-databaseViewer)"
PROJECT = "project it to a grid map first, and save that"
UNPACK = "unpack it, and give the map's YAML file"


@dataclass(frozen=True)
class ForeignFile:
    """What a file is, and how to get a map out of it."""

    found: str
    remedy: str


KINDS = {
    b"#ROSBAG V": ForeignFile("is a recording of ROS 1 (a bag), not a map", SAVE_MAP),
    b"\x89MCAP0\r\n": ForeignFile("is a recording (an MCAP bag), not a map", SAVE_MAP),
    b"\xdb\x01\xf5\x5b\x7b\x1f\x1d\x7b": ForeignFile(
        "is a state of Cartographer (pbstream), not a map",
        "make one of it with cartographer_pbstream_to_ros_map",
    ),
    b"# Octomap OcTree": ForeignFile(
        "is an OctoMap, not a grid map",
        "project it (octomap_server publishes projected_map) and save that map",
    ),
    b"# .PCD": ForeignFile("is a point cloud (PCD), not a map", PROJECT),
    b"ply\n": ForeignFile("is a point cloud (PLY), not a map", PROJECT),
    b"PK\x03\x04": ForeignFile("is a zip, not a map", UNPACK),
    b"\x1f\x8b": ForeignFile("is packed with gzip", UNPACK),
}
BOOST = b"serialization::archive"  # a few bytes from the start
POSE_GRAPH = ForeignFile(
    "is a pose graph of slam_toolbox, not a map", "load it there and save the map (its service save_map)"
)
SQLITE = b"SQLite format 3\0"
ROSBAG2 = ForeignFile("is a recording of ROS 2 (a rosbag2 database), not a map", SAVE_MAP)
ROSBAG2_FOLDER = ForeignFile("is a recording of ROS 2 (a rosbag2 folder), not a map", SAVE_MAP)
OF_ROSBAG2 = ForeignFile("belongs to a recording of ROS 2 (a rosbag2 folder), not to a map", SAVE_MAP)
RTAB = ForeignFile("is a database of RTAB-Map, not a map", GRID_OF_RTAB)
SOME_DATABASE = ForeignFile(
    "is a SQLite database, not a map", f"if RTAB-Map's, {GRID_OF_RTAB}; if a rosbag2 recording, {SAVE_MAP}"
)


def check_foreign(source: str, content: bytes, instead: str = "") -> None:
    """Raise InputFileError where this content begins as another tool's file does.

    source  : name of the file as the user knows it
    instead : where no map is asked for: how to come by what is
    """
    foreign = _recognised(source, content[:HEAD])
    if foreign is not None:
        raise _refusal(source, foreign, instead)


def check_foreign_folder(path: Path, instead: str = "") -> None:
    """Raise InputFileError where a folder is a recording of ROS 2; ``instead`` as of ``check_foreign``."""
    about = path / "metadata.yaml"
    if about.is_file():
        with about.open("rb") as stream:
            if BAG_FOLDER in stream.read(HEAD):
                raise _refusal(path, ROSBAG2_FOLDER, instead)


def _refusal(source: object, foreign: ForeignFile, instead: str) -> InputFileError:
    if not instead:
        return InputFileError(source, foreign.found, foreign.remedy)
    return InputFileError(source, re.sub(", not (to )?a map$", "", foreign.found), instead)


def _recognised(source: str, head: bytes) -> ForeignFile | None:
    if BOOST in head[:64]:
        return POSE_GRAPH
    if head.startswith(SQLITE):
        return _database(source, head)
    if BAG_FOLDER in head:
        return OF_ROSBAG2
    return next((foreign for first, foreign in KINDS.items() if head.startswith(first)), None)


def is_rosbag2_database(source: str, head: bytes) -> bool:
    """Whether a SQLite database is a recording, by the tables that its first page names; else by its name."""
    if b"CREATE TABLE Node" in head:
        return False
    tables = b"CREATE TABLE topics" in head or b"CREATE TABLE messages" in head
    return tables or Path(source).suffix.lower() == ".db3"


def _database(source: str, head: bytes) -> ForeignFile:
    if is_rosbag2_database(source, head):
        return ROSBAG2
    rtab = b"CREATE TABLE Node" in head or Path(source).suffix.lower() == ".db"
    return RTAB if rtab else SOME_DATABASE
