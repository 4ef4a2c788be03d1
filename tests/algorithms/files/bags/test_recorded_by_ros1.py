"""Recordings that ROS 1 itself wrote: the one that lies here, and a new one where ROS 1 is installed."""

from __future__ import annotations

import subprocess
from pathlib import Path

import numpy as np
import pytest
from repository import ROOT

from algorithms.files.bags.bag_path import NANO
from algorithms.files.bags.bag_reader import open_bag
from algorithms.files.bags.frame_tree import frames_around
from algorithms.files.map_file import read_map

HERE = Path(__file__).parent / "recorded_by_ros1.bag"
BEGIN = 1_600_000_000
DEBIANS = "/usr/bin/python3"  # the Python that Debian's python3-rosbag belongs to


@pytest.fixture(scope="module")
def recordings(tmp_path_factory):
    new = tmp_path_factory.mktemp("ros1") / "new.bag"
    script = ROOT / "tests/tools/ros1_recording.py"
    try:
        done = subprocess.run([DEBIANS, script, new], capture_output=True, text=True, check=False)
    except FileNotFoundError:
        return [HERE]
    if done.returncode:
        assert "ModuleNotFoundError" in done.stderr, done.stderr  # ROS 1 is not installed
        return [HERE]
    return [HERE, new]


def test_maps_updates_and_poses_are_those_that_were_recorded(recordings):
    for path in recordings:
        grid = read_map(f"{path}@6")
        assert (grid.height, grid.width, grid.resolution) == (30, 40, 0.05)
        assert tuple(grid.origin.array()) == (-1.25, 2.5, 0.0)
        walls = np.zeros((30, 40), bool)
        walls[[0, -1]] = walls[:, [0, -1]] = True
        assert grid.cells[0, 0] == -1
        assert (grid.cells == np.where(walls, 100, 0)).sum() == 30 * 40 - 1
        walls[5:8, 7:9] = True
        assert np.array_equal(read_map(path).occupied | (read_map(path).cells < 0), walls)
        assert read_map(f"{path}@4.9").cells[15, 20] == 20
        with open_bag(path) as bag:
            time = (BEGIN + 6) * NANO + NANO // 5
            pose = frames_around(bag, time).pose("map", "base_link", time)
        assert pose.array() == pytest.approx([7.2, 0.0, 0.0])
