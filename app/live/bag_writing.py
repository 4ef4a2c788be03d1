"""A recording of ROS 2, whole or not there."""

from __future__ import annotations

import shutil
from pathlib import Path
from types import TracebackType
from typing import Any

from rosbags.rosbag2 import StoragePlugin, Writer

from algorithms.common.errors import OutputError
from algorithms.files.bags.message_writing import Fields, MessageWriter
from app.live.ros_link import Topic

METADATA_VERSION = 9  # of rosbag2's metadata, which every ROS 2 that is supported reads


class BagRecorder:
    """Writes messages into a new folder; raises OutputError where there is one, or none can be made."""

    def __init__(self, folder: Path) -> None:
        self._folder, self._messages = folder, MessageWriter()
        if folder.exists():
            raise OutputError(folder, "is there already", "choose another name, or take it away")
        try:
            self._writer = Writer(folder, version=METADATA_VERSION, storage_plugin=StoragePlugin.SQLITE3)
            self._writer.open()
        except Exception as error:  # the library's, and the system's
            raise OutputError(folder, f"cannot be written ({error})", "choose another place") from error
        self._connections: dict[Topic, Any] = {}

    def write(self, topic: Topic, fields: Fields, time: int) -> None:
        """A message at a time, nanoseconds since 1970."""
        if topic not in self._connections:
            added = self._writer.add_connection(topic.name, topic.type, typestore=self._messages.types)
            self._connections[topic] = added
        self._writer.write(self._connections[topic], time, self._messages.write(topic.type, fields))

    def __enter__(self) -> BagRecorder:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._writer.close()
        if error is not None:
            shutil.rmtree(self._folder, ignore_errors=True)
