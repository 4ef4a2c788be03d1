"""What other tools keep their maps in is told in a line, with the way to a map."""

from __future__ import annotations

import sqlite3

import pytest
from hypothesis import given
from hypothesis import strategies as st

from algorithms.common.errors import InputFileError
from algorithms.files.foreign_files import BAG_FOLDER, BOOST, KINDS, check_foreign
from algorithms.files.map_file import map_from_bytes, read_map
from algorithms.files.observation_file import known_from_bytes

POSE_GRAPH = b"\x16\0\0\0\0\0\0\0serialization::archive\x12\0"


@pytest.mark.parametrize("first", [*KINDS, POSE_GRAPH, b"SQLite format 3\0"])
@given(rest=st.binary(max_size=200))
def test_it_is_known_by_its_first_bytes_whatever_follows_and_whatever_its_name(first, rest):
    for name in ("map1.yaml", "robot.xyz"):
        with pytest.raises(InputFileError, match=rf"^{name}: (is|belongs)") as told:
            check_foreign(name, first + rest)
        assert "YAML (" not in str(told.value)
        with pytest.raises(InputFileError):
            map_from_bytes(name, first + rest, "map.pgm", b"")
        with pytest.raises(InputFileError):
            known_from_bytes(name, first + rest)


@pytest.mark.parametrize(
    ("table", "said"), [("topics", "rosbag2"), ("Node", "RTAB-Map"), ("kitchen", "SQLite database")]
)
def test_a_database_is_known_by_its_tables_before_its_name(tmp_path, table, said):
    path = tmp_path / "robot.sqlite"
    with sqlite3.connect(path) as database:
        database.execute(f"CREATE TABLE {table} (id INTEGER)")
    with pytest.raises(InputFileError, match=said):
        read_map(path)
    empty = b"SQLite format 3\0" + bytes(100)
    for name, whose in (("a.db3", "rosbag2 database"), ("a.db", "RTAB-Map")):
        with pytest.raises(InputFileError, match=whose):
            check_foreign(name, empty)


def test_a_folder_that_is_a_damaged_recording_and_its_description_are_told(tmp_path):
    (tmp_path / "metadata.yaml").write_text("rosbag2_bagfile_information:\n  version: 5\n")
    for path in (tmp_path, tmp_path / "metadata.yaml"):
        with pytest.raises(InputFileError, match=r"rosbag2 folder, and damaged.*; mend it"):
            read_map(path)
    (tmp_path / "metadata.yaml").write_text("author: me\n")
    with pytest.raises(InputFileError, match="is a folder; give the YAML file of a map"):
        read_map(tmp_path)


@given(st.binary(max_size=64))
def test_what_begins_otherwise_is_let_through(content):
    known = (*KINDS, b"SQLite format 3\0")
    if not (any(content.startswith(first) for first in known) or BOOST in content or BAG_FOLDER in content):
        check_foreign("map.yaml", content)
