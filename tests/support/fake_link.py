"""A link to robots that are not there: what is sent on a topic is taken from it, in this process."""

from __future__ import annotations

from collections import deque
from typing import Any

from algorithms.files.bags.message_writing import MessageWriter
from app.live.ros_link import Topic

WRITER = MessageWriter()


class FakeTopic:
    """Of each subscription its own queue; a latched topic's last message waits for who comes late."""

    def __init__(self) -> None:
        self.queues: list[deque[Any]] = []
        self.sent: list[dict[str, Any]] = []
        self.publishers = 0


class FakeLink:
    """Every topic by its name; ``sent`` holds what was sent as it was given."""

    def __init__(self) -> None:
        self.topics: dict[str, FakeTopic] = {}
        self.closed = False

    def subscribe(self, topic: Topic) -> FakeEnd:
        at = self._at(topic)
        queue: deque[Any] = deque(maxlen=topic.depth)
        if topic.latched:
            queue.extend(WRITER.fill(topic.type, each) for each in at.sent[-1:])
        at.queues.append(queue)
        return FakeEnd(at, topic, queue)

    def advertise(self, topic: Topic) -> FakeEnd:
        at = self._at(topic)
        at.publishers += 1
        return FakeEnd(at, topic, deque())

    def published(self) -> dict[Topic, int]:
        return {Topic(name, ""): at.publishers for name, at in self.topics.items() if at.publishers}

    def close(self) -> None:
        self.closed = True

    def sent(self, name: str) -> list[dict[str, Any]]:
        return self.topics[name].sent

    def _at(self, topic: Topic) -> FakeTopic:
        return self.topics.setdefault(topic.name, FakeTopic())


class FakeEnd:
    def __init__(self, at: FakeTopic, topic: Topic, queue: deque[Any]) -> None:
        self._at, self._topic, self._queue = at, topic, queue

    def send(self, fields: dict[str, Any]) -> None:
        self._at.sent.append(fields)
        for queue in self._at.queues:
            queue.append(WRITER.fill(self._topic.type, fields))

    def put(self, message: Any) -> None:
        """What no link of ours would send."""
        for queue in self._at.queues:
            queue.append(message)

    def leave(self) -> None:
        self._at.publishers -= 1

    def take(self) -> list[Any]:
        found = list(self._queue)
        self._queue.clear()
        return found

    @property
    def listeners(self) -> int:
        return len(self._at.queues)

    @property
    def publishers(self) -> int:
        return self._at.publishers
