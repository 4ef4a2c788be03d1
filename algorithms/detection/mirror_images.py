"""Whether a thing in a laser scan is a mirror image: the scan then shows it twice, turned over at a wall."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from algorithms.common.pose import FloatArray
from algorithms.detection.scan_clusters import GAP, Cluster
from algorithms.maps.grid_map import BoolArray
from algorithms.sensors.laser_scan import LaserScan

MOST_WALLS = 5  # on each side of the thing that are tried
WALL = 0.7  # metres of a wall beside the mirror that its line is told from
LEAST_OF_WALL = 6  # points
IN_LINE = 0.6  # share of those points that must lie on one line
OFF = 0.04  # metres that points of a wall may lie off its line, and the glass before it
BESIDE = 2  # beams on either side of the one in which a turned point is looked for
LEAST_ALIKE = 8  # points behind the wall that are seen before it as well,
ALIKE_SHARE = 0.6  # this share of those in whose direction the scanner looked,
FOR_ONE = 8  # times as many as are seen to be missing there,
MISSING = 0.3  # and of the thing itself at most this share: where it would stand the floor is free


@dataclass(frozen=True, eq=False)
class _Scan:
    """A scan with the thing in its middle, counter-clockwise; the thing is beams first to last.

    angles, ranges, seen : (N,) radians, metres (inf: nothing within reach), and whether a beam says anything
    points : (N, 2) metres, NaN where nothing was hit
    step   : radians from beam to beam
    noise  : metres
    """

    angles: FloatArray
    ranges: FloatArray
    seen: BoolArray
    points: FloatArray
    step: float
    noise: float
    first: int
    last: int

    @staticmethod
    def around(cluster: Cluster, scan: LaserScan) -> _Scan:
        order = np.argsort(scan.angles, kind="stable")
        step, count = abs(scan.angle_increment), len(order)
        place = np.empty(count, dtype=np.intp)
        place[order] = np.arange(count)
        at = place[cluster.beams]
        angles = scan.angles[order]
        if step * count > 2 * np.pi - 1.5 * step:  # a whole turn has no ends
            roll = int(at[len(at) // 2]) - count // 2
            order, at = np.roll(order, -roll), (at - roll) % count
            angles = angles[0] + step * (roll + np.arange(count))
        hit = scan.valid[order]
        ranges = np.where(hit, scan.ranges[order], np.nan)
        points = np.stack([ranges * np.cos(angles), ranges * np.sin(angles)], axis=1)
        nothing = np.isposinf(scan.ranges[order])
        ranges[nothing] = np.inf
        first, last = int(at.min()), int(at.max())
        return _Scan(angles, ranges, hit | nothing, points, step, scan.noise(), first, last)

    def walls(self) -> Iterator[FloatArray]:
        """(P, 2) points of each wall that begins where the scan, going outward from the thing, comes back to
        something nearer than it.
        """
        near = np.nanmin(self.ranges[self.first : self.last + 1])
        for start, way in ((self.first, -1), (self.last, 1)):
            beams = np.arange(start, -1, -1) if way < 0 else np.arange(start, len(self.ranges))
            beams = beams[self.seen[beams]]
            steps = np.flatnonzero(
                (self.ranges[beams[1:]] < self.ranges[beams[:-1]] - GAP / 2) & (self.ranges[beams[1:]] < near)
            )
            for k in beams[1:][steps[:MOST_WALLS]]:
                beside = self.points[k:] if way > 0 else self.points[k::-1]
                away = np.hypot(*(beside - self.points[k]).T)
                end = int(np.argmax(np.append(away > WALL, True)))
                wall = beside[:end][np.isfinite(away[:end])]
                if len(wall) >= LEAST_OF_WALL:
                    yield wall

    def shows_twice(self, middle: FloatArray, normal: FloatArray, length: float) -> bool:
        """Whether what lies behind a wall's line, around the thing, is seen before it, turned over.

        middle, normal : (2,) of the line; metres, and away from the scanner
        length         : of the wall that it is told from; metres
        """
        depth = (self.points - middle) @ normal
        before = np.flatnonzero(depth <= 2 * OFF)
        right, left = before[before < self.first], before[before > self.last]
        low = int(right[-1]) + 1 if len(right) else 0
        high = int(left[0]) if len(left) else len(depth)
        behind = np.arange(low, high)[np.isfinite(depth[low:high])]
        if len(behind) < LEAST_ALIKE or (depth[self.first : self.last + 1] <= 2 * OFF).any():
            return False
        turned = self.points[behind] - 2 * depth[behind, None] * normal
        away = np.hypot(*turned.T)
        off = np.arctan2(turned[:, 1], turned[:, 0]) - self.angles[0]
        beam = np.rint(off % (2 * np.pi) / self.step).astype(np.intp)
        there = beam[:, None] + np.arange(-BESIDE, BESIDE + 1)
        usable = (there >= 0) & (there < len(self.ranges)) & ((there < low) | (there >= high))
        there = np.where(usable, there, 0)
        usable &= self.seen[there]
        # the farther behind the wall, the more its line's own error counts
        slack = 3 * self.noise + OFF + depth[behind] * 2 * self.noise / max(length, WALL / 3)
        beyond = np.where(usable, self.ranges[there] - away[:, None], np.nan)
        alike = (np.abs(beyond) < slack[:, None]).any(axis=1)
        looked_at = usable.any(axis=1)
        missing = looked_at & ~(usable & ~(beyond > slack[:, None])).any(axis=1)
        own = (behind >= self.first) & (behind <= self.last)
        count, gone = int(alike.sum()), int(missing.sum())
        return count >= max(LEAST_ALIKE, FOR_ONE * gone, ALIKE_SHARE * int(looked_at.sum())) and int(
            missing[own].sum()
        ) <= MISSING * int(own.sum())


def is_mirror_image(cluster: Cluster, scan: LaserScan) -> bool:
    """Whether the scan shows what is around a thing a second time, turned over at a wall before it.

    A room behind an open door is not: what it holds is missing on this side. Nothing is said of a mirror
    whose wall, or the room before it, the scanner does not see.
    """
    around = _Scan.around(cluster, scan)
    for wall in around.walls():
        middle, normal, length, in_line = _line(wall, around.noise)
        if in_line >= IN_LINE and around.shows_twice(middle, normal, length):
            return True
    return False


def _line(points: FloatArray, noise: float) -> tuple[FloatArray, FloatArray, float, float]:
    """Middle, normal away from the scanner, and length of the line through (P, 2) points of a wall, and the
    share of them that lie on it.
    """
    on_it: NDArray[np.bool_] = np.ones(len(points), dtype=bool)
    for _ in range(4):
        middle = points[on_it].mean(axis=0)
        along, normal = np.linalg.svd(points[on_it] - middle)[2]
        off = np.abs((points - middle) @ normal)
        on_it = off <= max(OFF, 3 * noise, float(np.quantile(off, IN_LINE)))
    normal = normal * np.sign(middle @ normal)
    length = float(np.ptp((points[on_it] - middle) @ along))
    return middle, normal, length, float((off < max(OFF, 3 * noise)).mean())
