"""A way to robots in this process, as the simulated ones of the page are: no network is opened."""

from __future__ import annotations

from collections import deque
from typing import Any

from algorithms.common.errors import InputFileError
from algorithms.files.bags.message_writing import Fields, MessageWriter
from app.live.ros_link import Topic


class InnerLink:
    """Hands messages on; of a latched topic the last one waits for who comes late."""

    def __init__(self) -> None:
        self._topics: dict[str, _InnerTopic] = {}
        self._writer = MessageWriter()

    def subscribe(self, topic: Topic) -> _InnerSubscription:
        at = self._at(topic)
        queue: deque[Any] = deque(maxlen=topic.depth)
        if topic.latched and at.last is not None:
            queue.append(at.last)
        at.queues.append(queue)
        return _InnerSubscription(at, queue)

    def advertise(self, topic: Topic) -> InnerPublication:
        at = self._at(topic)
        at.publishers += 1
        return InnerPublication(at, topic, self._writer)

    def published(self) -> dict[Topic, int]:
        return {at.topic: at.publishers for at in self._topics.values() if at.publishers}

    def close(self) -> None:
        self._topics.clear()

    def _at(self, topic: Topic) -> _InnerTopic:
        return self._topics.setdefault(topic.name, _InnerTopic(topic))


class _InnerTopic:
    def __init__(self, topic: Topic) -> None:
        self.topic = topic
        self.queues: list[deque[Any]] = []
        self.last: Any = None
        self.publishers = 0


class _InnerSubscription:
    def __init__(self, at: _InnerTopic, queue: deque[Any]) -> None:
        self._at, self._queue = at, queue

    def take(self) -> list[Any | InputFileError]:
        return [self._queue.popleft() for _ in range(len(self._queue))]

    @property
    def publishers(self) -> int:
        return self._at.publishers


class InnerPublication:
    """``leave``: nobody publishes it by this one any more."""

    def __init__(self, at: _InnerTopic, topic: Topic, writer: MessageWriter) -> None:
        self._at, self._topic, self._writer = at, topic, writer

    def send(self, fields: Fields) -> None:
        if not (self._at.queues or self._topic.latched):
            return
        message = self._writer.fill(self._topic.type, fields)
        if self._topic.latched:
            self._at.last = message
        for queue in self._at.queues:
            queue.append(message)

    def leave(self) -> None:
        self._at.publishers -= 1

    @property
    def listeners(self) -> int:
        return len(self._at.queues)
