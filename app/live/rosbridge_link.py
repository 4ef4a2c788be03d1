"""Topics by a rosbridge server: robots with ROS 1, or behind a firewall. One port, and JSON."""

from __future__ import annotations

from collections import deque
from contextlib import suppress
from typing import Any
from urllib.parse import urlsplit

from algorithms.common.display_text import show_hidden
from algorithms.common.errors import InputFileError, SettingError
from algorithms.files.bags.message_writing import Fields, MessageWriter
from app.live.ros_link import Topic

INSTALL = "pip install 'mapmeld[rosbridge]'"
ANSWER_WITHIN = 10.0  # seconds
AGAIN_AFTER = 5.0  # seconds at most until a lost connection is tried again
MOST_MESSAGE = 128 * 1024 * 1024  # bytes; the connection of a server that sends more is closed
MOST_TOPICS = 10_000
TOPICS = "/rosapi/topics"
ROS1_TIME = {"secs": "sec", "nsecs": "nanosec"}


class RosbridgeLink:
    """A connection to a server; where it is lost it is tried again.

    address : ws://HOST:PORT, or wss://
    raises  : SettingError where it is none, or nobody answers
    """

    def __init__(self, address: str) -> None:
        parts = urlsplit(address)
        if parts.scheme not in ("ws", "wss") or not parts.hostname:
            raise SettingError(f"rosbridge: {address!r} is no address; give ws://HOST:9090")
        try:
            from roslibpy import Ros
        except ImportError as error:
            raise SettingError(f"rosbridge needs roslibpy; install it: {INSTALL}") from error
        self._messages = MessageWriter()
        self._ros = Ros(address)
        self._ros.factory.set_max_delay(AGAIN_AFTER)
        limits = {"maxFramePayloadSize": MOST_MESSAGE, "maxMessagePayloadSize": MOST_MESSAGE}
        self._ros.factory.setProtocolOptions(**limits)
        try:
            self._ros.run(timeout=ANSWER_WITHIN)
        except Exception as error:  # the library's, and the system's
            self.close()
            raise SettingError(f"rosbridge: nobody answers at {address}; is the server running?") from error

    def subscribe(self, topic: Topic) -> _RosbridgeSubscription:
        return _RosbridgeSubscription(self._ros, topic, self._messages)

    def advertise(self, topic: Topic) -> _RosbridgePublication:
        return _RosbridgePublication(self._ros, topic)

    def published(self) -> dict[Topic, int]:
        """As rosapi tells, which runs beside the server; how many publish is not told.

        raises : SettingError where it does not answer
        """
        from roslibpy import Service, ServiceRequest

        try:
            told = Service(self._ros, TOPICS, "rosapi/Topics").call(ServiceRequest(), timeout=ANSWER_WITHIN)
            listed = zip(told["topics"], told["types"], strict=True)
            pairs = [(str(name), _ros2_type(str(kind))) for name, kind in listed]
        except Exception as error:  # the library's, and what strangers' JSON leads to
            raise SettingError("rosbridge: the server tells no topics; rosapi is to run beside it") from error
        return {Topic(show_hidden(name), kind, latched=True): 1 for name, kind in pairs[:MOST_TOPICS]}

    def close(self) -> None:
        self._ros.factory.stopTrying()
        with suppress(Exception):  # nobody is there any more
            self._ros.close(timeout=1)


class _RosbridgeSubscription:
    def __init__(self, ros: Any, topic: Topic, messages: MessageWriter) -> None:
        self._ros, self._topic, self._messages = ros, topic, messages
        self._queue: deque[Any] = deque(maxlen=topic.depth)  # filled by the library's thread
        _ros_topic(ros, topic).subscribe(self._queue.append)

    def take(self) -> list[Any | InputFileError]:
        found: list[Any | InputFileError] = []
        while self._queue:
            try:
                found.append(self._messages.fill(self._topic.type, _as_ros2(self._queue.popleft())))
            except Exception:  # what JSON of strangers leads to is known to nobody
                damaged = f"its message ({self._topic.type}) is damaged"
                found.append(InputFileError(self._topic.name, damaged, "see what the server sends"))
        return found

    @property
    def publishers(self) -> int | None:
        """A server tells of publishers only by asking ROS; without a connection there is none."""
        return None if self._ros.is_connected else 0


class _RosbridgePublication:
    listeners = None

    def __init__(self, ros: Any, topic: Topic) -> None:
        self._topic = _ros_topic(ros, topic)
        self._topic.advertise()

    def send(self, fields: Fields) -> None:
        self._topic.publish(as_json(fields))


def _ros2_type(kind: str) -> str:
    """nav_msgs/OccupancyGrid as ROS 2 writes it."""
    package, _, name = kind.replace("/msg/", "/").partition("/")
    return f"{package}/msg/{name}"


def _ros_topic(ros: Any, topic: Topic) -> Any:
    """Of the library; of a topic on which the newest alone counts at most one message a second is sent."""
    from roslibpy import Topic as RosTopic

    kind = topic.type.replace("/msg/", "/")
    slow = {"throttle_rate": 1000, "queue_length": 1} if topic.depth == 1 else {}
    return RosTopic(ros, topic.name, kind, latch=topic.latched, queue_size=topic.depth, **slow)


def _as_ros2(value: Any) -> Any:
    """JSON as fields of ROS 2: a time's fields have other names in ROS 1, and what is no number is null."""
    if isinstance(value, dict) or hasattr(value, "items"):
        return {ROS1_TIME.get(key, key): _as_ros2(each) for key, each in value.items()}
    if isinstance(value, list) and value and not isinstance(value[0], int):
        return [_as_ros2(each) for each in value]
    return float("nan") if value is None else value


def as_json(value: Any) -> Any:
    """Fields as JSON, with times as either ROS takes them."""
    if isinstance(value, dict):
        found = {key: as_json(each) for key, each in value.items()}
        if set(found) == {"sec", "nanosec"}:
            found |= {"secs": found["sec"], "nsecs": found["nanosec"]}
        return found
    if isinstance(value, list):
        return [as_json(each) for each in value]
    return value.tolist() if hasattr(value, "tolist") else value
