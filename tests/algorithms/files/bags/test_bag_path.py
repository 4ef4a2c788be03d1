"""How a recording is named: where its name ends, and a topic and a time begin."""

from __future__ import annotations

import pytest
from bags import BEGIN, KINDS, SECOND, grid_message, write_bag
from drawn import drawn_map

from algorithms.common.pose import Pose2
from algorithms.files.bags.bag_path import BagPath, bag_kind, bag_path, nanoseconds

GRID = drawn_map(Pose2(), resolution=0.2)


@pytest.mark.parametrize("kind", KINDS)
def test_a_recording_of_every_kind_is_known_by_its_content(tmp_path, kind):
    path = write_bag(tmp_path, "robot1", kind, [grid_message(GRID, 0.0)])
    assert bag_path(path) == BagPath(path)
    assert bag_path(f"{path}#/robot1/map@12.5") == BagPath(path, "/robot1/map", 12.5)
    assert bag_path(f"{path}#map") == BagPath(path, "/map")
    assert bag_path(f"{path}@-3") == BagPath(path, "", -3.0)
    word = {"ros1": "ROS 1", "db3": "rosbag2", "mcap": "rosbag2"}[kind.partition("-")[0]]
    assert word in bag_kind(path)


def test_a_single_file_of_a_folder_is_a_recording_too(tmp_path):
    for kind, suffix in (("db3", ".db3"), ("mcap", ".mcap")):
        folder = write_bag(tmp_path, kind, kind, [grid_message(GRID, 0.0)])
        (file,) = folder.glob(f"*{suffix}")
        assert bag_path(file) == BagPath(file)


def test_names_with_the_signs_in_them_are_taken_as_they_are(tmp_path):
    path = write_bag(tmp_path, "robot#1@home", "ros1", [grid_message(GRID, 0.0)])
    assert bag_path(path) == BagPath(path)
    assert bag_path(f"{path}#/map@2") == BagPath(path, "/map", 2.0)


def test_what_is_no_recording_is_left_to_others(tmp_path):
    (tmp_path / "map.yaml").write_text("image: map.pgm\n")
    (tmp_path / "folder").mkdir()
    for name in ("map.yaml", "map.yaml#/map", "folder", "missing.bag", "missing.bag#/map", "nul\0"):
        assert bag_path(f"{tmp_path}/{name}") is None


def test_times_count_from_the_beginning_the_end_or_1970():
    end = BEGIN + 60 * SECOND
    assert nanoseconds(2.5, BEGIN, end) == BEGIN + 2.5 * SECOND
    assert nanoseconds(-2.5, BEGIN, end) == end - 2.5 * SECOND
    assert nanoseconds(BEGIN / SECOND + 7, BEGIN, end) == BEGIN + 7 * SECOND
