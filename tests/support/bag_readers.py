"""Readers of recordings and of messages, and some to begin with: for test_fuzz.py and fuzz.py."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
from bags import (
    Recorded,
    bag_bytes,
    camera_message,
    grid_message,
    image_message,
    message_bytes,
    scan_message,
    transform_message,
    update_message,
)
from fake_link import FakeLink

from algorithms.common.pose import Pose2
from algorithms.files.bags.bag_path import BagPath
from algorithms.files.bags.bag_summary import read_summary
from algorithms.files.bags.frame_tree import FrameTree
from algorithms.files.bags.map_messages import grid_of, read_bag_map
from algorithms.files.bags.message_types import (
    CAMERA_INFO,
    GRID,
    IMAGES,
    SCAN,
    SEEN,
    TRANSFORMS,
    MessageReader,
)
from algorithms.files.bags.sensor_messages import camera_of, picture_of, scan_of
from algorithms.maps.grid_map import GridMap
from algorithms.sensors.camera import Camera
from algorithms.sensors.laser_scan import LaserScan
from app.live.live_frames import LiveFrames
from app.live.map_source import TopicSource
from app.live.message_fields import grid_message as grid_fields
from app.live.message_fields import seen_message, transforms_message
from app.live.ros_link import TF, Topic, map_topic
from app.live.sighting_sources import sighting_of


def _bag_file(kind: str) -> bytes:
    """A recording of one file, with a map, an update of it and a robot's frames."""
    grid = GridMap(np.array([[0, 100, -1], [50, 0, 0]], np.int8), 0.05)
    told = [
        grid_message(grid, 0.0),
        transform_message("map", "base_link", 0.5, (1, 2, 0)),
        update_message(grid.cells[:1, :2], 1, 0, 1.0),
    ]
    return bag_bytes(kind, told)


def _bag(suffix: str) -> Callable[[bytes], object]:
    """What a recording tells of itself, and its map."""

    def reader(data: bytes) -> object:
        with TemporaryDirectory() as folder:
            path = Path(folder, f"bag{suffix}")
            path.write_bytes(data)
            read_summary(path)
            return read_bag_map(BagPath(path))

    return reader


def _message(kind: str, use: Callable[[str, Any], object]) -> tuple[Callable[[bytes], object], list[bytes]]:
    """A reader of messages as ROS 2 sends them, and one to begin with."""
    good = [each for each in MESSAGES if each.type == kind]
    read = MessageReader(ros1=False).read
    return lambda data: use("topic", read("topic", kind, data)), [message_bytes(each) for each in good]


def _tree_of(name: str, message: Any) -> object:
    tree = FrameTree(name)
    tree.add(message, static=False)
    return [tree.pose(frame, frame, 0) for frame in tree.frames]


def _sighting(name: str, message: Any) -> object:
    """Of robots that stand in the frames that every message of these may name."""
    link = FakeLink()
    frames = LiveFrames(link)
    link.advertise(Topic("/tf", TF)).send(
        transforms_message([("map", "base", Pose2(1.0, 2.0, 3.0)), ("base", "odom", Pose2())], 0)
    )
    frames.poll()
    robots = []
    for robot in ("one", "other"):
        link.advertise(map_topic(robot)).send(grid_fields(GridMap(np.zeros((3, 4), np.int8), 0.05), "map", 0))
        source = TopicSource(robot, link, robot, frames, "base")
        source.poll(0.0)
        robots.append(source)
    return sighting_of(name, message, *robots)


MESSAGES = [
    grid_message(GridMap(np.zeros((3, 4), np.int8), 0.05), 1.0),
    transform_message("map", "odom", 1.0, (1, 2, 0)),
    image_message(np.zeros((32, 40, 3), np.uint8), 1.0),
    scan_message(LaserScan(-1.0, 0.1, np.ones(20), 0.1, 5.0), 1.0),
    camera_message(Camera(64, 48, (60.0, 60.0), (32.0, 24.0)), 1.0),
    Recorded("/sees", SEEN, 1.0, seen_message("base", 0, 2.0, 1.0, np.eye(2) / 100)),
]

BAG_READERS: dict[str, tuple[Callable[[bytes], object], list[bytes]]] = {
    "ROS 1 bag": (_bag(".bag"), [_bag_file("ros1"), _bag_file("ros1-bz2")]),
    "ROS 2 bag": (_bag(".db3"), [_bag_file("db3")]),
    "MCAP bag": (_bag(".mcap"), [_bag_file("mcap"), _bag_file("mcap-zstd")]),
    "map message": _message(GRID, lambda name, message: grid_of(name, "map", message)),
    "transform message": _message(TRANSFORMS[0], _tree_of),
    "image message": _message(IMAGES[0], picture_of),
    "scan message": _message(SCAN, scan_of),
    "camera message": _message(CAMERA_INFO, camera_of),
    "sighting message": _message(SEEN, _sighting),
}
