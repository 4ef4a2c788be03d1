"""Reading a recording message by message: never more of it in memory than one message and its chunk."""

from __future__ import annotations

from collections.abc import Collection, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from rosbags.interfaces import Connection
from rosbags.rosbag1 import Reader as Reader1
from rosbags.rosbag2 import Reader as Reader2

from algorithms.common.errors import InputFileError, unreadable
from algorithms.files.bags.bag_path import NANO, bag_kind, is_ros1
from algorithms.files.bags.bounded_decompression import bound
from algorithms.files.bags.message_types import MessageReader

ROS2_SUFFIXES = (".db3", ".mcap")  # by which the library knows them
FIRST_SPAN = 2 * NANO  # that is looked through for a topic's last message, then WIDER times as much before it
WIDER = 8
MEND = "mend it (rosbag reindex, ros2 bag reindex), or record it again, or save the map while SLAM runs"


@dataclass(frozen=True)
class BagTopic:
    """name : of the topic
    type  : of its messages, as ROS 2 writes it: nav_msgs/msg/OccupancyGrid
    count : of its messages
    """

    name: str
    type: str
    count: int


class BagReader:
    """An open recording. Times are nanoseconds since 1970, by the clock of who recorded."""

    def __init__(self, path: Path, reader: Reader1 | Reader2) -> None:
        self.path = path
        self.is_ros1 = isinstance(reader, Reader1)
        self._reader = reader
        self._read = MessageReader(self.is_ros1).read
        self.begin, self.end = reader.start_time, reader.end_time  # the end lies after the last message
        self.message_count = reader.message_count

    @property
    def topics(self) -> tuple[BagTopic, ...]:
        """All topics, by name."""
        found: dict[tuple[str, str], int] = {}
        for each in self._reader.connections:
            found[each.topic, each.msgtype] = found.get((each.topic, each.msgtype), 0) + each.msgcount
        return tuple(BagTopic(name, kind, count) for (name, kind), count in sorted(found.items()))

    def of_type(self, *types: str) -> tuple[BagTopic, ...]:
        """The topics of these types that have a message."""
        return tuple(topic for topic in self.topics if topic.type in types and topic.count)

    def messages(
        self, topics: Collection[BagTopic], start: int | None = None, stop: int | None = None
    ) -> Iterator[tuple[BagTopic, int, Any]]:
        """Topic, time and message, by time, from ``start`` on and before ``stop``; raises InputFileError."""
        by_name = {(topic.name, topic.type): topic for topic in topics}
        for connection, time, data in self._raw(topics, start, stop):
            topic = by_name[connection.topic, connection.msgtype]
            yield topic, time, self._message(topic, data)

    def last(self, topic: BagTopic, until: int) -> tuple[int, Any] | None:
        """Time and message of the last one not after ``until``; None where there is none.

        raises : InputFileError
        """
        stop, span = min(self.end, until + 1), FIRST_SPAN
        while stop > self.begin:
            start = max(self.begin, stop - span)
            found: tuple[int, bytes] | None = None
            for _, time, data in self._raw([topic], start, stop):
                found = time, data
            if found is not None:
                return found[0], self._message(topic, found[1])
            stop, span = start, span * WIDER
        return None

    def first(self, topic: BagTopic) -> tuple[int, Any] | None:
        """Time and message of the first one; None where there is none; raises InputFileError."""
        return next(((time, message) for _, time, message in self.messages([topic])), None)

    def seconds(self, time: int) -> float:
        """A time as seconds since the recording began."""
        return (time - self.begin) / NANO

    def _raw(
        self, topics: Collection[BagTopic], start: int | None, stop: int | None
    ) -> Iterator[tuple[Connection, int, bytes]]:
        asked = {(topic.name, topic.type) for topic in topics}
        chosen = [each for each in self._reader.connections if (each.topic, each.msgtype) in asked]
        if chosen:  # to the reader no connection would mean all
            with _reading(self.path):
                yield from self._reader.messages(chosen, start, stop)

    def _message(self, topic: BagTopic, data: bytes) -> Any:
        return self._read(f"{self.path}#{topic.name}", topic.type, data)


@contextmanager
def open_bag(path: Path) -> Iterator[BagReader]:
    """A recording to read from; raises InputFileError where it is damaged."""
    if path.is_file() and not is_ros1(path) and path.suffix not in ROS2_SUFFIXES:
        remedy = f"let it end in {' or '.join(ROS2_SUFFIXES)}"
        raise InputFileError(path, f"is {bag_kind(path)} of another name", remedy)
    with _reading(path):
        reader = Reader1(path) if is_ros1(path) else Reader2(path)
        reader.open()
        if isinstance(reader, Reader1):
            bound(reader)
    try:
        yield BagReader(path, reader)
    finally:
        reader.close()


@contextmanager
def _reading(path: Path) -> Iterator[None]:
    """Whatever goes wrong in the library, told as what is wrong with the file."""
    try:
        yield
    except (InputFileError, GeneratorExit):
        raise
    except OSError as error:
        raise unreadable(path, error, MEND) from error
    except Exception as error:  # a damaged index leads the library anywhere, to asking for all memory, too
        raise InputFileError(
            path, f"is {bag_kind(path)}, and damaged, cut off, or a file of it is missing", MEND
        ) from error
