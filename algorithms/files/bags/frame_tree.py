"""Where frames were at a time, by the transforms of a recording (``/tf`` and ``/tf_static``)."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation, Slerp

from algorithms.common.errors import InputFileError
from algorithms.common.pose import FloatArray, Pose2
from algorithms.files.bags.bag_path import NANO
from algorithms.files.bags.bag_reader import BagReader, BagTopic
from algorithms.files.bags.message_types import TRANSFORMS

STATIC = "static"  # in the name of the topic of transforms that hold for good
LONGEST_GAP = NANO  # nanoseconds between two transforms that a pose is taken from; slower is no SLAM
AROUND = 5 * NANO  # nanoseconds of a recording that are read before and after a time
MOST_TRANSFORMS = 1_000_000  # of one look; five seconds of any robot are fewer
MOST_FRAMES = 10_000  # of one tree; a robot has a few dozen
LEVEL = 0.999  # cosine of the tilt up to which a robot counts as level: 2.6°
RECORD = "record /tf and /tf_static, and name the frames"


@dataclass(frozen=True)
class Placed:
    """A rigid motion of space, T_parent_child.

    turn  : from child to parent
    shift : (3,) metres, parent's frame
    """

    turn: Rotation
    shift: FloatArray

    @staticmethod
    def of(transform: Any) -> Placed | None:
        """Of a geometry_msgs/Transform; None where it is none."""
        q, t = transform.rotation, transform.translation
        turn, shift = np.array([q.x, q.y, q.z, q.w], float), np.array([t.x, t.y, t.z], float)
        with np.errstate(all="ignore"):
            size = float(turn @ turn)
        if not (np.isfinite(shift).all() and 0.5 < size < 2.0):
            return None
        return Placed(Rotation.from_quat(turn), shift)

    def matrix(self) -> FloatArray:
        """(4, 4) homogeneous."""
        matrix = np.eye(4)
        matrix[:3, :3], matrix[:3, 3] = self.turn.as_matrix(), self.shift
        return matrix

    def towards(self, other: Placed, share: float) -> Placed:
        """What lies between this (0) and another (1)."""
        turn = Slerp([0, 1], Rotation.concatenate([self.turn, other.turn]))(share)
        return Placed(turn, (1 - share) * self.shift + share * other.shift)


class FrameTree:
    """Frames, each in its parent, over time. Times are those in the messages; nanoseconds."""

    def __init__(self, source: object) -> None:
        """source : whose frames they are, for errors"""
        self._source = source
        self._parent: dict[str, str] = {}
        self._static: dict[str, Placed] = {}
        self._moving: dict[str, list[tuple[int, Placed]]] = {}

    @property
    def frames(self) -> tuple[str, ...]:
        """The names of all."""
        return tuple(sorted({*self._parent, *self._parent.values()}))

    def parent(self, frame: str) -> str | None:
        return self._parent.get(frame)

    def add(self, message: Any, static: bool) -> None:
        """Take in a tf2_msgs/TFMessage; what is no motion in it is passed over."""
        for each in message.transforms:
            parent, child = _name(each.header.frame_id), _name(each.child_frame_id)
            placed = Placed.of(each.transform)
            if placed is None or parent == child or not (parent and child):
                continue
            if child not in self._parent and len(self._parent) >= MOST_FRAMES:
                continue
            self._parent[child] = parent
            if static:
                self._static[child] = placed
            else:
                self._moving.setdefault(child, []).append((stamp_of(each.header), placed))

    def sort(self) -> None:
        """By time: transforms may be recorded out of order."""
        for series in self._moving.values():
            series.sort(key=lambda each: each[0])

    def forget(self, span: int, most: int) -> None:
        """Keep of each frame that moves so much before its newest time (nanoseconds), and so many at most."""
        for child, series in self._moving.items():
            since = series[-1][0] - span
            self._moving[child] = [each for each in series[-most:] if each[0] >= since]

    def newest(self, frame: str) -> int:
        """Until when a frame's way to its root is known; nanoseconds, 0 where nothing on it moves."""
        moving = [self._moving[each] for each in self._upwards(_name(frame)) if self._moving.get(each)]
        return min((series[-1][0] for series in moving), default=0)

    def transform(self, target: str, source: str, time: int) -> FloatArray:
        """(4, 4) T_target_source at a time; raises InputFileError that says which link is missing."""
        up, down = list(self._upwards(_name(target))), list(self._upwards(_name(source)))
        common = next((frame for frame in up if frame in down), None)
        if common is None:
            raise self._unconnected(_name(target), _name(source))
        to_target = self._chain(up[: up.index(common)], time)
        to_source = self._chain(down[: down.index(common)], time)
        return np.asarray(np.linalg.inv(to_target) @ to_source)

    def pose(self, target: str, source: str, time: int) -> Pose2:
        """The same as a motion of the plane; raises InputFileError where it is tilted."""
        matrix = self.transform(target, source, time)
        if matrix[2, 2] < LEVEL:
            raise self._error(f"{source} is tilted in {target}", "only robots on level ground can be placed")
        return Pose2(float(matrix[0, 3]), float(matrix[1, 3]), float(np.arctan2(matrix[1, 0], matrix[0, 0])))

    def _upwards(self, frame: str) -> Iterator[str]:
        """A frame, its parent, and so on to the root."""
        seen: set[str] = set()
        at: str | None = frame
        while at is not None and at not in seen:
            seen.add(at)
            yield at
            at = self._parent.get(at)

    def _chain(self, frames: Iterable[str], time: int) -> FloatArray:
        """(4, 4) from the first of these frames to the parent of the last."""
        matrix = np.eye(4)
        for frame in frames:
            matrix = self._at(frame, time).matrix() @ matrix
        return matrix

    def _at(self, frame: str, time: int) -> Placed:
        """A frame in its parent."""
        series = self._moving.get(frame)
        if not series:
            return self._static[frame]
        after = bisect_right(series, time, key=lambda each: each[0])
        before_time, before = series[max(after - 1, 0)]
        after_time, later = series[min(after, len(series) - 1)]
        if before_time <= time <= after_time and after_time - before_time <= LONGEST_GAP:
            span = after_time - before_time
            return before.towards(later, (time - before_time) / span if span else 0.0)
        # a little before the first or after the last: what was there then
        nearest_time, nearest = min(
            series[max(after - 1, 0)],
            series[min(after, len(series) - 1)],
            key=lambda each: abs(each[0] - time),
        )
        if abs(nearest_time - time) > LONGEST_GAP / 2:
            off = (nearest_time - time) / NANO
            raise self._error(
                f"the transform {self._parent[frame]} → {frame} is missing at this time: the nearest one is "
                f"{abs(off):.1f} s {'later' if off > 0 else 'earlier'}",
                "ask for a time at which all transforms were recorded",
            )
        return nearest

    def _unconnected(self, target: str, source: str) -> InputFileError:
        for frame in (target, source):
            if frame not in self.frames:
                listed = ", ".join(self.frames[:20]) or "none"
                return self._error(f"has no frame {frame} at this time", f"its frames: {listed}; {RECORD}")
        roots = [list(self._upwards(frame))[-1] for frame in (target, source)]
        return self._error(
            f"no transform ties {source} (below {roots[1]}) to {target} (below {roots[0]}) at this time",
            RECORD,
        )

    def _error(self, found: str, remedy: str) -> InputFileError:
        return InputFileError(self._source, found, remedy)


def stamp_of(header: Any) -> int:
    """The time in a message's header; nanoseconds."""
    return int(header.stamp.sec) * NANO + int(header.stamp.nanosec)


def frames_around(bag: BagReader, time: int) -> FrameTree:
    """The frames of a recording about a time of the robot's clock, which messages carry; nanoseconds.

    raises : InputFileError
    """
    tree = FrameTree(bag.path)
    topics = bag.of_type(*TRANSFORMS)
    static = [topic for topic in topics if STATIC in topic.name]
    moving = [topic for topic in topics if topic not in static]
    for _, _, message in bag.messages(static):
        tree.add(message, static=True)
    around = _recorded_at(bag, moving, time)
    count = 0
    for _, _, message in bag.messages(moving, around - AROUND, around + AROUND):
        tree.add(message, static=False)
        count += len(message.transforms)
        if count > MOST_TRANSFORMS:
            raise InputFileError(
                bag.path, f"holds more than {MOST_TRANSFORMS:,} transforms in ten seconds", RECORD
            )
    tree.sort()
    return tree


def _recorded_at(bag: BagReader, topics: Sequence[BagTopic], time: int) -> int:
    """When something of this time of the robot's clock was recorded, by the recorder's clock.

    The two may differ, and run at different speeds: a simulation's begins at 0. The first and the last
    transform tell.
    """
    pairs = []
    for topic in topics:
        for recorded, message in filter(None, (bag.first(topic), bag.last(topic, bag.end))):
            pairs += [(recorded, stamp_of(each.header)) for each in message.transforms[:1]]
    if not pairs:
        return time
    (first, began), (last, ended) = min(pairs), max(pairs)
    speed = (last - first) / (ended - began) if ended > began else 1.0
    return first + round((time - began) * speed)


def _name(frame: str) -> str:
    """A frame's name; in ROS 1 some begin with a slash."""
    return frame.lstrip("/")
