"""Where robots are, by the transforms that are published now."""

from __future__ import annotations

from algorithms.common.errors import InputFileError
from algorithms.common.pose import Pose2
from algorithms.files.bags.bag_path import NANO
from algorithms.files.bags.frame_tree import FrameTree
from app.live.ros_link import TF, RosLink, Topic

KEPT = 10 * NANO  # nanoseconds of transforms, for sightings that come late
MOST_KEPT = 2000  # transforms of one frame


class LiveFrames:
    """The frames of a topic of transforms and of that beside it, on which they hold for good."""

    def __init__(self, link: RosLink, topic: str = "/tf") -> None:
        self.topic = topic
        self._tree = FrameTree(topic)
        self._moving = link.subscribe(Topic(topic, TF, depth=500))
        self._static = link.subscribe(Topic(f"{topic}_static", TF, latched=True, depth=500))

    def poll(self) -> None:
        """Take in what has come; what is damaged is passed over."""
        for subscription, static in ((self._static, True), (self._moving, False)):
            for message in subscription.take():
                if not isinstance(message, InputFileError):
                    self._tree.add(message, static)
        self._tree.sort()
        self._tree.forget(KEPT, MOST_KEPT)

    @property
    def names(self) -> tuple[str, ...]:
        """Of all frames that were told of."""
        return self._tree.frames

    def pose(self, target: str, source: str, time: int | None = None) -> Pose2:
        """T_target_source at a time (nanoseconds), or now; raises InputFileError."""
        return self._tree.pose(target, source, self._tree.newest(source) if time is None else time)
