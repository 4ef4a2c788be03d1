"""Messages of ROS that are published, as their fields: times in nanoseconds since 1970."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from math import cos, sin
from typing import Any

from algorithms.common.pose import FloatArray, Pose2
from algorithms.files.bags.bag_path import NANO
from algorithms.maps.grid_map import GridMap

Fields = dict[str, Any]
OK, WARN, ERROR, STALE = 0, 1, 2, 3  # levels of a DiagnosticStatus


def header(frame: str, time: int) -> Fields:
    return {"stamp": {"sec": time // NANO, "nanosec": time % NANO}, "frame_id": frame}


def grid_message(grid: GridMap, frame: str, time: int) -> Fields:
    """nav_msgs/OccupancyGrid"""
    info = {
        "map_load_time": header("", time)["stamp"],
        "resolution": grid.resolution,
        "width": grid.width,
        "height": grid.height,
        "origin": _pose(grid.origin),
    }
    return {"header": header(frame, time), "info": info, "data": grid.cells.ravel()}


def transforms_message(transforms: Iterable[tuple[str, str, Pose2]], time: int) -> Fields:
    """tf2_msgs/TFMessage of parents, children and T_parent_child."""
    listed = []
    for parent, child, T in transforms:
        pose = _pose(T)
        transform = {"translation": pose["position"], "rotation": pose["orientation"]}
        listed.append({"header": header(parent, time), "child_frame_id": child, "transform": transform})
    return {"transforms": listed}


def seen_message(frame: str, time: int, x: float, y: float, covariance: FloatArray) -> Fields:
    """geometry_msgs/PoseWithCovarianceStamped of a robot that is seen at (x, y) m of a frame.

    covariance : (2, 2) m²
    """
    spread = [0.0] * 36
    spread[0], spread[1], spread[6], spread[7] = covariance.ravel().tolist()
    return {"header": header(frame, time), "pose": {"pose": _pose(Pose2(x, y)), "covariance": spread}}


def scan_message(
    frame: str, time: int, first: float, step: float, reach: float, ranges: FloatArray
) -> Fields:
    """sensor_msgs/LaserScan; directions in radians from straight ahead, (N,) ranges in metres."""
    return {
        "header": header(frame, time),
        "angle_min": first,
        "angle_max": first + step * (len(ranges) - 1),
        "angle_increment": step,
        "range_max": reach,
        "ranges": ranges,
    }


def diagnostics_message(states: Sequence[tuple[str, int, str, Mapping[str, str]]], time: int) -> Fields:
    """diagnostic_msgs/DiagnosticArray of names, levels, sentences and further values."""
    listed = [
        {
            "name": name,
            "level": level,
            "message": said,
            "hardware_id": "",
            "values": [{"key": key, "value": value} for key, value in values.items()],
        }
        for name, level, said, values in states
    ]
    return {"header": header("", time), "status": listed}


def _pose(T: Pose2) -> Fields:
    half = T.theta / 2
    orientation = {"x": 0.0, "y": 0.0, "z": sin(half), "w": cos(half)}
    return {"position": {"x": T.x, "y": T.y, "z": 0.0}, "orientation": orientation}
