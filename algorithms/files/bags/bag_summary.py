"""What a recording holds, and what of it can be used."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import islice
from pathlib import Path
from typing import Any

from algorithms.common.display_text import show_hidden
from algorithms.common.errors import InputFileError
from algorithms.files.bags.bag_path import NANO, bag_kind
from algorithms.files.bags.bag_reader import BagReader, BagTopic, open_bag
from algorithms.files.bags.frame_tree import STATIC, FrameTree
from algorithms.files.bags.map_messages import shortest
from algorithms.files.bags.message_types import CAMERA_INFO, GRID, GRID_UPDATE, IMAGES, SCAN, TRANSFORMS

MOST_READ = 500  # messages of transforms that are looked at for frames

Use = Callable[[Any], str]
USES: dict[str, Use] = {
    GRID: lambda m: (
        f"map: {m.info.width} × {m.info.height} cells of {shortest(m.info.resolution):g} m, "
        f"frame {m.header.frame_id}"
    ),
    GRID_UPDATE: lambda _: "map: brings it up to date",
    **dict.fromkeys(TRANSFORMS, lambda _: "poses"),
    IMAGES[0]: lambda m: f"observe: {m.width} × {m.height} pixels, {m.encoding}, frame {m.header.frame_id}",
    IMAGES[1]: lambda m: f"observe: {m.format}, frame {m.header.frame_id}",
    CAMERA_INFO: lambda m: f"observe: calibration for {m.width} × {m.height} pixels",
    SCAN: lambda m: f"observe: {len(m.ranges)} beams, frame {m.header.frame_id}",
}


@dataclass(frozen=True)
class TopicSummary:
    """topic : name, type, count of messages
    first, last : seconds since the recording began; None where nobody looked
    use : what it is good for, "map: …", "poses", "observe: …"; empty where for nothing
    """

    topic: BagTopic
    first: float | None = None
    last: float | None = None
    use: str = ""


@dataclass(frozen=True)
class BagSummary:
    """kind : what the recording is, "a ROS 1 bag"
    begin   : seconds since 1970, by the recorder's clock
    length  : seconds
    topics  : by name
    frames  : the parent of every frame; None of a root
    """

    kind: str
    begin: float
    length: float
    messages: int
    topics: tuple[TopicSummary, ...]
    frames: dict[str, str | None]


def read_summary(path: Path) -> BagSummary:
    """What a recording holds; raises InputFileError."""
    with open_bag(path) as bag:
        empty = not bag.message_count
        return BagSummary(
            bag_kind(path),
            0.0 if empty else bag.begin / NANO,
            0.0 if empty else bag.seconds(bag.end - 1),
            bag.message_count,
            tuple(_summary(bag, topic) for topic in bag.topics),
            _frames(bag),
        )


def _summary(bag: BagReader, topic: BagTopic) -> TopicSummary:
    if topic.type not in USES or not topic.count:
        return TopicSummary(topic)
    try:
        first, last = bag.first(topic), bag.last(topic, bag.end)
        if first is None or last is None:
            return TopicSummary(topic)
        use = show_hidden(USES[topic.type](last[1]))
        return TopicSummary(topic, bag.seconds(first[0]), bag.seconds(last[0]), use)
    except InputFileError as error:  # one damaged topic hides no other
        return TopicSummary(topic, use=error.found)


def _frames(bag: BagReader) -> dict[str, str | None]:
    tree = FrameTree(bag.path)
    for topic in bag.of_type(*TRANSFORMS):
        static = STATIC in topic.name
        for _, _, message in islice(bag.messages([topic]), MOST_READ):
            tree.add(message, static)
    return {frame: tree.parent(frame) for frame in tree.frames}
