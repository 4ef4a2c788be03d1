"""Topics of ROS 2 over bare DDS: no ROS needs to be installed. Nothing is opened before a link is made."""

from __future__ import annotations

import ipaddress
import os
import re
from collections import Counter
from contextlib import suppress
from functools import cache
from typing import Any
from xml.sax.saxutils import quoteattr

from algorithms.common.display_text import show_hidden
from algorithms.common.errors import InputFileError, SettingError
from algorithms.files.bags.message_types import MessageReader
from algorithms.files.bags.message_writing import Fields, MessageWriter
from app.live.ros_link import Topic

MOST_DOMAIN = 232  # of DDS; higher ones have no ports
MOST_MESSAGE = "128 MiB"  # more than the largest map; what is longer is thrown away before it is put together
LOOPBACK = ("lo", "127.0.0.1", "localhost")
INSTALL = "pip install 'mapmeld[ros2]'"
ROS2_TOPIC = "rt/"  # what the names of its topics begin with
ROS2_TYPE = re.compile(r"(?P<package>\w+)::msg::dds_::(?P<name>\w+)_")
MOST_ENDPOINTS = 10_000  # of a domain that are looked at
SEND_WAIT = 0.1  # seconds that a writer waits for readers that do not keep up


class DdsLink:
    """A participant of a DDS domain.

    domain    : ROS_DOMAIN_ID of the robots
    interface : name or address of the network's; "" leaves it to DDS; a loopback's keeps everything on this
                machine
    raises    : SettingError where there is no DDS, or no such domain or interface
    """

    def __init__(self, domain: int = 0, interface: str = "") -> None:
        if not 0 <= domain <= MOST_DOMAIN:
            raise SettingError(
                f"the DDS domain is {domain}; give 0 to {MOST_DOMAIN}, the robots' ROS_DOMAIN_ID"
            )
        try:
            from cyclonedds.core import DDSException
            from cyclonedds.domain import DomainParticipant
        except ImportError as error:
            raise SettingError(f"topics of ROS 2 need Cyclone DDS; install it: {INSTALL}") from error
        self._reader, self._writer = MessageReader(ros1=False), MessageWriter()
        self._topics: dict[Topic, Any] = {}
        self._writers: list[Any] = []  # for a latched topic goes on as long as its writer is there
        try:
            _open_domain(domain, interface)
            self._participant: Any = DomainParticipant(domain)
        except DDSException as error:
            where = f" on the interface {interface}" if interface else ""
            raise SettingError(f"DDS domain {domain} cannot be opened{where}; check the interface") from error

    def subscribe(self, topic: Topic) -> _DdsSubscription:
        from cyclonedds.sub import DataReader

        return _DdsSubscription(
            DataReader(self._participant, self._topic(topic), qos=_qos(topic)), topic, self._reader
        )

    def advertise(self, topic: Topic) -> _DdsPublication:
        from cyclonedds.pub import DataWriter

        self._writers.append(DataWriter(self._participant, self._topic(topic), qos=_qos(topic)))
        return _DdsPublication(self._writers[-1], topic, self._writer)

    def published(self) -> dict[Topic, int]:
        """The topics of ROS 2 that are published in the domain, as far as they have been found, and by how
        many.
        """
        from cyclonedds.builtin import BuiltinDataReader, BuiltinTopicDcpsPublication
        from cyclonedds.core import InstanceState, Policy, ReadCondition, SampleState, ViewState

        reader = BuiltinDataReader(self._participant, BuiltinTopicDcpsPublication)
        there = ReadCondition(reader, ViewState.Any | InstanceState.Alive | SampleState.Any)
        found: Counter[Topic] = Counter()
        for each in reader.read(MOST_ENDPOINTS, there):
            kind = ROS2_TYPE.fullmatch(each.type_name)
            if kind is not None and each.topic_name.startswith(ROS2_TOPIC):
                latched = Policy.Durability.TransientLocal in each.qos
                name = show_hidden(each.topic_name[len(ROS2_TOPIC) - 1 :])
                found[Topic(name, f"{kind['package']}/msg/{kind['name']}", latched)] += 1
        return dict(found)

    def close(self) -> None:
        """Leave the domain, once nobody holds what was made of this link any more."""
        self._writers.clear()
        self._topics.clear()
        self._participant = None

    def _topic(self, topic: Topic) -> Any:
        from cyclonedds.topic import Topic as DdsTopic

        from app.live.dds_types import dds_type

        if topic not in self._topics:
            name = f"{ROS2_TOPIC}{topic.name.strip('/')}"
            self._topics[topic] = DdsTopic(self._participant, name, dds_type(topic.type))
        return self._topics[topic]


@cache
def _open_domain(domain: int, interface: str) -> Any:
    """A process opens a domain once, for all of its participants: whose end would be the others' end, too."""
    from cyclonedds.domain import Domain

    return Domain(domain, configuration(interface))


class _DdsSubscription:
    def __init__(self, reader: Any, topic: Topic, messages: MessageReader) -> None:
        self._reader, self._topic, self._messages = reader, topic, messages

    def take(self) -> list[Any | InputFileError]:
        from app.live.dds_types import RawMessage

        found: list[Any | InputFileError] = []
        if self._reader.get_requested_incompatible_qos_status().total_count_change:
            offered = "is published in a way that does not fit: volatile, or best effort"
            found.append(InputFileError(self._topic.name, offered, "publish it reliable and transient-local"))
        for sample in self._reader.take(self._topic.depth):
            if isinstance(sample, RawMessage):  # else its publisher has taken it back
                try:
                    found.append(self._messages.read(self._topic.name, self._topic.type, sample.data))
                except InputFileError as error:
                    found.append(error)
        return found

    @property
    def publishers(self) -> int:
        return len(self._reader.get_matched_publications())


class _DdsPublication:
    def __init__(self, writer: Any, topic: Topic, messages: MessageWriter) -> None:
        self._writer, self._topic, self._messages = writer, topic, messages

    def send(self, fields: Fields) -> None:
        from cyclonedds.core import DDSException

        from app.live.dds_types import dds_message

        message = dds_message(self._topic.type, self._messages.write(self._topic.type, fields))
        with suppress(DDSException):  # a reader that does not keep up must not hold the others up
            self._writer.write(message)

    @property
    def listeners(self) -> int:
        return len(self._writer.get_matched_subscriptions())


def configuration(interface: str) -> str:
    """Cyclone's settings as XML, after those that the user has set."""
    found = []
    discovery = ""
    if interface:
        key = "name"
        with suppress(ValueError):
            ipaddress.ip_address(interface)
            key = "address"
        chosen = f"<NetworkInterface {key}={quoteattr(interface)}/>"
        if interface in LOOPBACK:  # which knows no multicast: participants look for each other one by one
            chosen = '<NetworkInterface address="127.0.0.1"/>'
            discovery = (
                '<Discovery><ParticipantIndex>auto</ParticipantIndex><Peers><Peer Address="127.0.0.1"/>'
                "</Peers></Discovery>"
            )
        found.append(f"<Interfaces>{chosen}</Interfaces>")
    if discovery:
        found.append("<AllowMulticast>false</AllowMulticast>")
    general = f"<General>{''.join(found)}</General>" if found else ""
    size = f"<Internal><MaxSampleSize>{MOST_MESSAGE}</MaxSampleSize></Internal>"
    ours = f'<CycloneDDS><Domain Id="any">{general}{discovery}{size}</Domain></CycloneDDS>'
    theirs = os.environ.get("CYCLONEDDS_URI", "")
    return f"{theirs},{ours}" if theirs else ours


def _qos(topic: Topic) -> Any:
    """As ROS 2 publishes: reliable, the last few kept."""
    from cyclonedds.core import Policy, Qos
    from cyclonedds.util import duration

    durability = Policy.Durability.TransientLocal if topic.latched else Policy.Durability.Volatile
    return Qos(
        Policy.Reliability.Reliable(duration(seconds=SEND_WAIT)),
        durability,
        Policy.History.KeepLast(topic.depth),
    )
