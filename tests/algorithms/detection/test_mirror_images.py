"""What a mirror shows is told from what stands behind an opening in a wall."""

from __future__ import annotations

from math import hypot, pi

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from algorithms.common.pose import FloatArray, Pose2
from algorithms.detection.mirror_images import is_mirror_image
from algorithms.detection.scan_clusters import Cluster, clusters_of
from algorithms.sensors.laser_scan import LaserScan

WALL_AT = 2.0  # metres ahead of the scanner; the opening in it is from RIGHT to LEFT
RIGHT, LEFT = -1.0, 1.0
ROBOT = (0.4, 1.2)  # in the room
IMAGE = (2 * WALL_AT - ROBOT[0], ROBOT[1])
NOISE = 0.01


def box(x: float, y: float, size: float) -> list[list[float]]:
    """Four sides; x0, y0, x1, y1 of each."""
    h = size / 2
    corners = [(x - h, y - h), (x + h, y - h), (x + h, y + h), (x - h, y + h)]
    return [[*a, *b] for a, b in zip(corners, [*corners[1:], corners[0]], strict=True)]


ROOM = np.array(
    [
        [WALL_AT, -3.0, WALL_AT, RIGHT],
        [WALL_AT, LEFT, WALL_AT, 2.5],
        [-2.0, -3.0, WALL_AT, -3.0],
        [-2.0, 2.5, WALL_AT, 2.5],
        [-2.0, -3.0, -2.0, 2.5],
        *box(0.6, -1.6, 0.7),
        *box(-1.0, 1.5, 0.5),
    ]
)
NEXT_ROOM = np.array(
    [
        [WALL_AT, -1.5, 5.5, -1.5],
        [WALL_AT, 2.0, 5.5, 2.0],
        [5.5, -1.5, 5.5, 2.0],
        *box(4.6, -0.6, 0.6),
    ]
)


def turned_over(segments: FloatArray) -> FloatArray:
    """Segments as the mirror shows them."""
    return segments * [-1, 1, -1, 1] + [2 * WALL_AT, 0, 2 * WALL_AT, 0]


def cast(segments: FloatArray, ways: FloatArray) -> FloatArray:
    """(N,) distance from the origin along (N, 2) unit vectors to the first segment; inf: none."""
    a, e = segments[:, :2], segments[:, 2:] - segments[:, :2]
    across = ways[:, :1] * e[:, 1] - ways[:, 1:] * e[:, 0]
    with np.errstate(all="ignore"):
        t = (a[:, 0] * e[:, 1] - a[:, 1] * e[:, 0]) / across
        share = (a[:, 0] * ways[:, 1:] - a[:, 1] * ways[:, :1]) / across
    return np.where((t > 0) & (share >= 0) & (share <= 1), t, np.inf).min(axis=1)


def scan_of(here: FloatArray, behind: FloatArray, field: float, seed: int, turn: float = 0.0) -> LaserScan:
    """A scan of this room and, through the opening, of what is or seems to be behind it."""
    step = field / 540
    angles = -field / 2 + step * np.arange(540)
    ways = np.stack([np.cos(angles + turn), np.sin(angles + turn)], axis=1)
    ranges, through = cast(here, ways), np.full(len(ways), np.inf)
    with np.errstate(divide="ignore"):
        height = WALL_AT * ways[:, 1] / ways[:, 0]
    open_ = (ways[:, 0] > 0) & (height > RIGHT) & (height < LEFT)
    through[open_] = cast(behind, ways[open_])
    seen = np.where(open_ & (ranges > WALL_AT / np.abs(ways[:, 0])), through, ranges)
    return LaserScan(
        -field / 2, step, seen + NOISE * np.random.default_rng(seed).normal(size=540), 0.05, 12.0
    )


def thing_at(scan: LaserScan, x: float, y: float, turn: float = 0.0) -> Cluster:
    at = Pose2(theta=-turn).apply(np.array([x, y]))
    near = [one for one in clusters_of(scan) if hypot(*(one.points.mean(axis=0) - at)) < 0.4]
    return max(near, key=lambda one: len(one.beams))


@given(st.integers(0, 20))
def test_a_robot_in_a_mirror_is_told_by_the_room_that_is_seen_twice(seed):
    here = np.concatenate([ROOM, box(*ROBOT, 0.4)])
    scan = scan_of(here, turned_over(here), 2 * pi, seed)
    assert is_mirror_image(thing_at(scan, *IMAGE), scan)


@given(st.floats(-3, 3))
def test_however_the_scanner_is_turned(turn):
    here = np.concatenate([ROOM, box(*ROBOT, 0.4)])
    scan = scan_of(here, turned_over(here), 2 * pi, 3, turn)
    assert is_mirror_image(thing_at(scan, *IMAGE, turn), scan)


@pytest.mark.parametrize("field", [1.5 * pi, 2 * pi])
@given(st.integers(0, 20))
def test_a_robot_in_the_next_room_is_none_though_the_door_stands_in_a_wall(field, seed):
    behind = np.concatenate([NEXT_ROOM, box(*IMAGE, 0.4)])
    scan = scan_of(ROOM, behind, field, seed)
    assert not is_mirror_image(thing_at(scan, *IMAGE), scan)


@given(st.integers(0, 20))
def test_a_next_room_that_is_this_one_turned_over_is_told_by_the_robot_that_is_missing_here(seed):
    behind = np.concatenate([turned_over(ROOM), box(*IMAGE, 0.4)])
    scan = scan_of(ROOM, behind, 2 * pi, seed)
    assert not is_mirror_image(thing_at(scan, *IMAGE), scan)


@given(st.integers(0, 20))
def test_a_robot_before_the_wall_is_none(seed):
    here = np.concatenate([ROOM, box(*ROBOT, 0.4)])
    scan = scan_of(here, turned_over(here), 2 * pi, seed)
    assert not is_mirror_image(thing_at(scan, *ROBOT), scan)
