"""Maps in a recording: the last nav_msgs/OccupancyGrid of a topic, or the one at a time, with its updates."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from math import atan2, hypot, isfinite
from typing import Any

import numpy as np

from algorithms.common.display_text import show_hidden
from algorithms.common.errors import InputFileError
from algorithms.common.pose import Pose2
from algorithms.common.source_file import SourceFile
from algorithms.files.bags.bag_path import BagPath, bag_kind, nanoseconds
from algorithms.files.bags.bag_reader import BagReader, BagTopic, open_bag
from algorithms.files.bags.message_types import GRID, GRID_UPDATE
from algorithms.maps.grid_map import FARTHEST, OCCUPIED, UNKNOWN, CellArray, GridMap, check_size

UPDATES = "_updates"  # what the topic of a map's updates ends in
COST = "costmap"  # in the name of a topic whose cells are costs, not walls
USUAL = "/map"
TILTED = 0.01  # of a unit vector along z that may lie in the plane: 0.6°
RECORD = "record a map topic too (nav_msgs/OccupancyGrid), or play it while SLAM runs and save the map"


def read_bag_map(asked: BagPath) -> GridMap:
    """The map of a recording at the time that is asked for, or its last one.

    raises : InputFileError, TooLargeError
    """
    with open_bag(asked.path) as bag:
        topic, remarks = _choose(bag, asked)
        until = bag.end if asked.time is None else nanoseconds(asked.time, bag.begin, bag.end)
        found = bag.last(topic, until)
        if found is None:
            first = bag.first(topic)
            when = "none" if first is None else f"its first one at {bag.seconds(first[0]):.3f} s"
            raise InputFileError(
                asked, f"has no map on {topic.name} by then, {when}", "give a later time after the @"
            )
        time, message = found
        name = f"{asked.path}#{topic.name}"
        label = asked.path.stem if topic.name == USUAL else f"{asked.path.stem} {topic.name}"
        further = [each for each in bag.of_type(GRID_UPDATE) if each.name == topic.name + UPDATES]
        updates = (update for _, _, update in bag.messages(further, time, until + 1))
        grid = grid_of(name, label, message, updates)
        return replace(grid, remarks=remarks, made=time / 1e9)


def grid_of(name: str, label: str, message: Any, updates: Iterable[Any] = ()) -> GridMap:
    """The map of a message, with what was sent afterwards to bring it up to date.

    name   : of where it comes from, for errors
    label  : what to call the map before a person
    raises : InputFileError, TooLargeError; SettingError for a resolution that is none
    """
    cells = _cells(name, message)
    for update in updates:
        _update(name, cells, update)
    source = SourceFile.of(name, cells.tobytes())
    origin = _origin(name, message.info.origin)
    return GridMap(cells, shortest(message.info.resolution), origin, show_hidden(label), files=(source,))


def choose_maps(bag: BagReader) -> tuple[BagTopic, ...]:
    """The topics with a map of walls, not of costs, where there are such; raises InputFileError."""
    maps = bag.of_type(GRID)
    if not maps:
        raise InputFileError(bag.path, f"is {bag_kind(bag.path)} (a recording) that holds no map", RECORD)
    return tuple(topic for topic in maps if COST not in topic.name) or maps


def shortest(number: float) -> float:
    """The shortest decimal number that a float32 is the nearest one to: 0.05 for 0.0500000007."""
    return float(str(np.float32(number)))


def yaw_of(name: str, q: Any, what: str) -> float:
    """Heading of a quaternion message, about z; radians.

    raises : InputFileError where it is none, or tilted
    """
    x, y, z, w = (float(part) for part in (q.x, q.y, q.z, q.w))
    size = x * x + y * y + z * z + w * w
    if not isfinite(size):
        raise InputFileError(name, f"{what} has an orientation that is not finite", "record it again")
    if size == 0.0:  # a message that nobody filled in
        return 0.0
    if 2 * hypot(x * z + w * y, y * z - w * x) / size > TILTED:
        raise InputFileError(name, f"{what} is tilted", "only level maps can be merged")
    return atan2(2 * (w * z + x * y), w * w + x * x - y * y - z * z)


def _choose(bag: BagReader, asked: BagPath) -> tuple[BagTopic, tuple[str, ...]]:
    """The topic of the map, and what is to be said of the choice."""
    walls, maps = choose_maps(bag), bag.of_type(GRID)
    listed = ", ".join(topic.name for topic in maps)
    if asked.topic:
        for topic in maps:
            if topic.name.strip("/") == asked.topic.strip("/"):
                return topic, ()
        raise InputFileError(bag.path, f"has no map on {asked.topic}", f"its maps are on {listed}")
    if len(maps) == 1:
        return maps[0], ()
    usual = walls if len(walls) == 1 else tuple(topic for topic in walls if topic.name == USUAL)
    if not usual:
        raise InputFileError(
            bag.path, f"has maps on {listed}", f"say which one, as {bag.path.name}#{maps[0].name}"
        )
    others = ", ".join(topic.name for topic in maps if topic.name != usual[0].name)
    return usual[0], (f"its topic {usual[0].name} was taken, not {others}",)


def _cells(name: str, message: Any) -> CellArray:
    """(H, W) int8, row 0 at the bottom, to be written to."""
    width, height = int(message.info.width), int(message.info.height)
    if width == 0 or height == 0:
        raise InputFileError(name, f"its map has {width} × {height} cells", "record until there is a map")
    check_size(width, height, name)
    return np.array(_block(name, message.data, width, height))


def _block(name: str, data: Any, width: int, height: int) -> CellArray:
    cells: CellArray = np.asarray(data, dtype=np.int8)
    if cells.size != width * height:
        found = f"says that it has {width} × {height} cells, and has {cells.size:,}"
        raise InputFileError(name, found, "the message is damaged; record it again")
    if cells.min() < UNKNOWN or cells.max() > OCCUPIED:
        wrong = cells[(cells < UNKNOWN) | (cells > OCCUPIED)][0]
        raise InputFileError(
            name, f"has a cell of {wrong}", "cells are −1 for unknown and 0 to 100; record a map, not costs"
        )
    block: CellArray = cells.reshape(height, width)
    return block


def _update(name: str, cells: CellArray, update: Any) -> None:
    """Replace a part of a map; raises InputFileError where the part is not on it."""
    x, y, width, height = (int(each) for each in (update.x, update.y, update.width, update.height))
    if width == 0 or height == 0:
        return
    if min(x, y) < 0 or x + width > cells.shape[1] or y + height > cells.shape[0]:
        found = f"has an update of {width} × {height} cells from ({x}, {y}) on, outside of the map"
        raise InputFileError(name, found, f"the map has {cells.shape[1]} × {cells.shape[0]} cells")
    cells[y : y + height, x : x + width] = _block(name, update.data, width, height)


def _origin(name: str, pose: Any) -> Pose2:
    x, y = float(pose.position.x), float(pose.position.y)
    if not (abs(x) <= FARTHEST and abs(y) <= FARTHEST):  # NaN is neither
        raise InputFileError(name, f"its origin is ({x:g}, {y:g}) m", "record it again")
    return Pose2(x, y, yaw_of(name, pose.orientation, "its origin"))
