"""Where the newest map of one robot comes from."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from typing import Any, Protocol

from algorithms.common.display_text import show_hidden
from algorithms.common.errors import InputFileError, MapMergeError
from algorithms.common.pose import Pose2
from algorithms.files.bags.map_messages import grid_of
from algorithms.maps.grid_map import GridMap
from app.live.live_frames import LiveFrames
from app.live.ros_link import RosLink, map_topic

STALE_AFTER = 10.0  # seconds without a map
LONGEST_FRAME = 128  # letters of a frame's name


class SourceState(Enum):
    """WAITING: no map has come yet; STALE: none for a while; GONE: nobody publishes it any more."""

    WAITING = "waiting"
    LIVE = "live"
    STALE = "stale"
    GONE = "gone"


@dataclass(frozen=True, eq=False)
class ReceivedMap:
    """frame : of the map, as the robot calls it
    at    : when it came; seconds of the caller's clock
    """

    grid: GridMap
    frame: str
    at: float


class MapSource(Protocol):
    """name    : of the robot
    newest  : its newest map that can be used; None before there is one
    refused : why its newest message was none; "" where it was one
    """

    name: str
    newest: ReceivedMap | None
    refused: str

    def poll(self, now: float) -> None:
        """Take in what has come; ``now`` in seconds of a clock that only goes forward."""
        ...

    def pose(self, time: int | None = None) -> Pose2:
        """T_map_robot at a time of the robot's clock (nanoseconds), or now; raises InputFileError."""
        ...

    def state(self, now: float) -> SourceState: ...


class TopicSource:
    """A robot's map on a topic.

    frames : where it is told where the robot is
    base   : the robot's own frame
    """

    def __init__(self, name: str, link: RosLink, topic: str, frames: LiveFrames, base: str) -> None:
        self.name, self.frames, self.base = name, frames, base
        self.newest: ReceivedMap | None = None
        self.refused = ""
        self._maps = link.subscribe(map_topic(topic))
        self._place = f"{name}'s {topic}"

    def poll(self, now: float) -> None:
        for message in self._maps.take():
            try:
                self.newest = self._received(message, now)
                self.refused = ""
            except InputFileError as error:
                self.refused = error.found
            except MapMergeError as error:
                self.refused = str(error)

    def pose(self, time: int | None = None) -> Pose2:
        if self.newest is None:
            raise InputFileError(self._place, "has sent no map yet", "wait for it")
        return self.frames.pose(self.newest.frame, self.base, time)

    def state(self, now: float) -> SourceState:
        if self._maps.publishers == 0 and self.newest is not None:
            return SourceState.GONE
        if self.newest is None:
            return SourceState.WAITING
        return SourceState.STALE if now - self.newest.at > STALE_AFTER else SourceState.LIVE

    def _received(self, message: Any, now: float) -> ReceivedMap:
        if isinstance(message, InputFileError):
            raise message
        frame = str(message.header.frame_id).lstrip("/")
        if not (frame.strip() and frame.isprintable() and len(frame) <= LONGEST_FRAME):
            said = show_hidden(frame)[:LONGEST_FRAME]
            raise InputFileError(self._place, f"its frame is called {said!r}", "give it a name")
        return ReceivedMap(grid_of(self._place, self.name, message), frame, now)


class FileSource:
    """A map that stays as it is: of a robot that has done its work."""

    refused = ""

    def __init__(self, name: str, grid: GridMap, frame: str) -> None:
        self.name = name
        self.newest: ReceivedMap | None = ReceivedMap(grid, frame, 0.0)

    def poll(self, now: float) -> None:
        pass

    def pose(self, time: int | None = None) -> Pose2:
        raise InputFileError(self.name, "is a map from a file", "only robots that run are somewhere")

    def state(self, now: float) -> SourceState:
        return SourceState.LIVE
