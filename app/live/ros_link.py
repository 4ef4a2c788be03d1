"""A way to topics of ROS: what DDS and rosbridge have in common."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Protocol

from algorithms.common.errors import InputFileError
from algorithms.files.bags.message_types import GRID, TRANSFORMS
from algorithms.files.bags.message_writing import Fields

TF = TRANSFORMS[0]


@dataclass(frozen=True)
class Topic:
    """name : with its slash
    type    : of its messages, as ROS 2 writes it
    latched : who comes late is sent the last ones, too: transient local
    depth   : messages that are kept until they are taken; older ones are given up
    """

    name: str
    type: str
    latched: bool = False
    depth: int = 10


def map_topic(name: str) -> Topic:
    """A topic of maps: of several that wait, the newest alone is of use."""
    return Topic(name, GRID, latched=True, depth=1)


class Subscription(Protocol):
    """Messages of one topic."""

    def take(self) -> list[Any | InputFileError]:
        """Those that came since the last time; in the place of one that is damaged, what is wrong with it."""
        ...

    @property
    def publishers(self) -> int | None:
        """Who publishes it now; None where that cannot be known."""
        ...


class Publication(Protocol):
    """A topic that we publish."""

    def send(self, fields: Fields) -> None: ...

    @property
    def listeners(self) -> int | None:
        """Who listens to it now; None where that cannot be known."""
        ...


class RosLink(Protocol):
    """Robots within reach."""

    def subscribe(self, topic: Topic) -> Subscription: ...

    def advertise(self, topic: Topic) -> Publication: ...

    def published(self) -> dict[Topic, int]:
        """The topics that are published, as far as they have been found, and by how many."""
        ...

    def close(self) -> None: ...
