"""Recordings that tests write: maps, transforms, images and scans in bags of every kind."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cache
from math import cos, sin
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
from rosbags.rosbag1 import Writer as Writer1
from rosbags.rosbag2 import CompressionFormat, CompressionMode, StoragePlugin
from rosbags.rosbag2 import Writer as Writer2

from algorithms.common.pose import Pose2
from algorithms.files.bags.message_writing import MessageWriter
from algorithms.maps.grid_map import GridMap
from algorithms.sensors.camera import Camera
from algorithms.sensors.laser_scan import LaserScan

SECOND = 1_000_000_000
BEGIN = 1_700_000_000 * SECOND  # nanoseconds since 1970
KINDS = ("ros1", "ros1-bz2", "ros1-lz4", "db3", "db3-zstd", "db3-messages", "mcap", "mcap-zstd")
OPTICAL = (-0.5, 0.5, -0.5, 0.5)  # quaternion of a frame with z along the axis of a camera that looks ahead


@dataclass(frozen=True)
class Recorded:
    """A message: topic, type, seconds since the recording began, and its fields."""

    topic: str
    type: str
    at: float
    fields: dict[str, Any]


def write_bag(folder: Path, name: str, kind: str, messages: Iterable[Recorded]) -> Path:
    """A recording of one of KINDS, with these messages; its file or its folder."""
    ros1 = kind.startswith("ros1")
    types = _writer(ros1).types
    path = folder / (f"{name}.bag" if ros1 else name)
    if ros1:
        writer: Any = Writer1(path)
        if "-" in kind:
            writer.set_compression(Writer1.CompressionFormat[kind.partition("-")[2].upper()])
    else:
        plugin = StoragePlugin.MCAP if kind.startswith("mcap") else StoragePlugin.SQLITE3
        writer = Writer2(path, version=9, storage_plugin=plugin)
        if "-" in kind:
            # an MCAP's own chunks are packed as storage; a database as a whole, or message by message
            mode = {"db3-zstd": "FILE", "db3-messages": "MESSAGE", "mcap-zstd": "STORAGE"}[kind]
            writer.set_compression(CompressionMode[mode], CompressionFormat.ZSTD)
    with writer:
        connections: dict[str, Any] = {}
        for each in messages:
            if each.topic not in connections:
                connections[each.topic] = writer.add_connection(each.topic, each.type, typestore=types)
            writer.write(connections[each.topic], BEGIN + round(each.at * SECOND), message_bytes(each, ros1))
    return path


@cache
def _writer(ros1: bool) -> MessageWriter:
    return MessageWriter(ros1)


def bag_bytes(kind: str, messages: Iterable[Recorded]) -> bytes:
    """A recording of one file."""
    with TemporaryDirectory() as folder:
        path = write_bag(Path(folder), "bag", kind, messages)
        (file,) = [path] if path.is_file() else path.glob("bag*")
        return file.read_bytes()


def message_bytes(message: Recorded, ros1: bool = False) -> bytes:
    """A message as ROS 1 or ROS 2 sends it."""
    return _writer(ros1).write(message.type, message.fields)


def header(at: float, frame: str = "") -> dict[str, Any]:
    """By a robot's clock that is the recorder's."""
    time = BEGIN + round(at * SECOND)
    return {"stamp": {"sec": time // SECOND, "nanosec": time % SECOND}, "frame_id": frame}


def grid_message(grid: GridMap, at: float, topic: str = "/map", frame: str = "map") -> Recorded:
    """A map as SLAM publishes it."""
    half = grid.origin.theta / 2
    origin = {
        "position": {"x": grid.origin.x, "y": grid.origin.y},
        "orientation": {"z": sin(half), "w": cos(half)},
    }
    info = {"resolution": grid.resolution, "width": grid.width, "height": grid.height, "origin": origin}
    fields = {"header": header(at, frame), "info": info, "data": grid.cells.ravel()}
    return Recorded(topic, "nav_msgs/msg/OccupancyGrid", at, fields)


def update_message(cells: np.ndarray, x: int, y: int, at: float, topic: str = "/map_updates") -> Recorded:
    """A part of a map, (H, W) int8 from column x and row y on."""
    height, width = cells.shape
    fields = {"header": header(at), "x": x, "y": y, "width": width, "height": height, "data": cells.ravel()}
    return Recorded(topic, "map_msgs/msg/OccupancyGridUpdate", at, fields)


def transform_message(
    parent: str,
    child: str,
    at: float,
    shift: Sequence[float],
    quaternion: Sequence[float] = (0.0, 0.0, 0.0, 1.0),
    topic: str = "/tf",
    stamp: float | None = None,
) -> Recorded:
    """T_parent_child; ``stamp`` where the robot's clock says another time than ``at``."""
    transform = {
        "translation": dict(zip("xyz", map(float, shift), strict=True)),
        "rotation": dict(zip("xyzw", map(float, quaternion), strict=True)),
    }
    head = header(at if stamp is None else stamp, parent)
    fields = {"transforms": [{"header": head, "child_frame_id": child, "transform": transform}]}
    return Recorded(topic, "tf2_msgs/msg/TFMessage", at, fields)


def level(pose: Pose2) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """Shift and quaternion of a motion of the plane."""
    return (pose.x, pose.y, 0.0), (0.0, 0.0, sin(pose.theta / 2), cos(pose.theta / 2))


def image_message(picture: np.ndarray, at: float, topic: str = "/camera/image_raw") -> Recorded:
    """(H, W, 3) uint8 red, green, blue."""
    height, width, _ = picture.shape
    fields = {
        "header": header(at, "camera_optical"),
        "width": width,
        "height": height,
        "encoding": "rgb8",
        "step": 3 * width,
        "data": picture.ravel(),
    }
    return Recorded(topic, "sensor_msgs/msg/Image", at, fields)


def camera_message(camera: Camera, at: float, topic: str = "/camera/camera_info") -> Recorded:
    fields = {
        "header": header(at, "camera_optical"),
        "width": camera.width,
        "height": camera.height,
        "distortion_model": "plumb_bob",
        "d": list(camera.distortion) or [0.0] * 5,
        "k": camera.matrix().ravel(),
        "r": np.eye(3).ravel(),
        "p": np.zeros(12),
    }
    return Recorded(topic, "sensor_msgs/msg/CameraInfo", at, fields)


def scan_message(scan: LaserScan, at: float, topic: str = "/scan") -> Recorded:
    fields = {
        "header": header(at, "laser"),
        "angle_min": scan.angle_min,
        "angle_max": scan.angle_min + scan.angle_increment * (len(scan.ranges) - 1),
        "angle_increment": scan.angle_increment,
        "range_min": scan.range_min,
        "range_max": scan.range_max,
        "ranges": scan.ranges,
    }
    return Recorded(topic, "sensor_msgs/msg/LaserScan", at, fields)


def robot_frames(pose: Pose2, at: float) -> list[Recorded]:
    """A robot that stands at a pose in its map, about that time: map → odom → base_link, twice a second."""
    drift = Pose2(0.3, -0.2, 0.1)
    T_map_odom = pose @ drift.inverse()
    found = []
    for k in range(-6, 7):
        time = at + k / 2
        found.append(transform_message("map", "odom", time, *level(T_map_odom)))
        found.append(transform_message("odom", "base_link", time, *level(drift)))
    return found


def sensor_frames(camera: Pose2, laser: Pose2) -> list[Recorded]:
    """Where a robot's camera and laser are on it, as ROS describes them."""
    shift, turn = level(camera)
    return [
        transform_message("base_link", "camera", 0.0, shift, turn, "/tf_static"),
        transform_message("camera", "camera_optical", 0.0, (0, 0, 0), OPTICAL, "/tf_static"),
        transform_message("base_link", "laser", 0.0, *level(laser), "/tf_static"),
    ]
