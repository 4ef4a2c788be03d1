"""Things that stand before their background in a laser scan: the salient points of section III-A."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from algorithms.common.pose import FloatArray
from algorithms.maps.grid_map import BoolArray
from algorithms.sensors.laser_scan import LaserScan

GAP = 0.20  # metres between neighbouring points of two things, at least: a side seen aslant has few points
GAP_BEAMS = 3.0  # beams' spacings that points of one surface may lie apart: it is seen aslant
GAP_NOISE = 6.0  # standard deviations of a range that they may
BEHIND, BESIDE, BEFORE = "behind", "beside", "before"


@dataclass(frozen=True, eq=False)
class Cluster:
    """Neighbouring points of a scan that belong to one thing.

    beams       : (n,) which beams of the scan, counter-clockwise
    points      : (n, 2) what they hit; metres, the laser's frame
    first, last : what the beam next to the first and the last one shows: the background ``behind`` the thing,
                  a wall of the map ``beside`` it, or something ``before`` it that may hide a part
    """

    beams: NDArray[np.intp]
    points: FloatArray
    first: str
    last: str

    @property
    def whole(self) -> bool:
        """Whether nothing hides a part of it."""
        return BEFORE not in (self.first, self.last)

    @property
    def free(self) -> bool:
        """Whether it stands before its background on both sides."""
        return self.first == self.last == BEHIND


def clusters_of(scan: LaserScan, explained: BoolArray | None = None) -> list[Cluster]:
    """All things in a scan, counter-clockwise. Walls are among them: whoever asks knows how wide a robot is.

    explained : (N,) beams that hit a wall of the map; they belong to no thing
    """
    order = np.argsort(scan.angles, kind="stable")
    angles, ranges, valid = scan.angles[order], scan.ranges[order], scan.valid[order]
    known = np.zeros(len(order), dtype=bool) if explained is None else explained[order]
    hit = np.flatnonzero(valid & ~known)
    if not len(hit):
        return []
    hits = np.where(valid, ranges, np.nan)
    points = np.stack([hits * np.cos(angles), hits * np.sin(angles)], axis=1)
    step = abs(scan.angle_increment)
    spacing = GAP_BEAMS * step * ranges[hit[:-1]] * np.diff(hit)
    apart = np.hypot(*(points[hit[1:]] - points[hit[:-1]]).T)
    gap = np.maximum(np.maximum(GAP, GAP_NOISE * scan.noise()), spacing)
    # between two beams of one thing others may be lost, but none may have looked into the open
    open_beams = np.cumsum(np.isposinf(ranges) | (ranges >= scan.range_max) | known)
    broken = (apart > gap) | (open_beams[hit[1:]] > open_beams[hit[:-1]])
    parts = np.split(np.arange(len(hit)), np.flatnonzero(broken) + 1)
    round_about = step * len(order) > 2 * np.pi - 1.5 * step
    if round_about and len(parts) > 1:  # what lies across the seam of a whole turn is one thing
        joined = np.hypot(*(points[hit[-1]] - points[hit[0]]))
        seam = len(order) - 1 - hit[-1] + hit[0]
        if seam <= 2 and joined <= max(GAP, GAP_BEAMS * step * ranges[hit[0]] * (seam + 1)):
            parts = [np.concatenate([parts[-1], parts[0]]), *parts[1:-1]]
    view = _View(ranges, valid, known, round_about, max(GAP, GAP_NOISE * scan.noise()))
    return [
        Cluster(
            order[hit[part]], points[hit[part]], view.beyond(hit[part[0]], -1), view.beyond(hit[part[-1]], 1)
        )
        for part in parts
    ]


@dataclass(frozen=True, eq=False)
class _View:
    """A scan in the order of its bearings, asked for what lies next to a beam."""

    ranges: FloatArray
    valid: BoolArray
    known: BoolArray
    round_about: bool
    gap: float

    def beyond(self, beam: int, way: int) -> str:
        """What the next beam that says something shows; ``way`` is 1 counter-clockwise, else −1."""
        count = len(self.ranges)
        for k in range(1, count):
            n = beam + way * k
            if not 0 <= n < count:
                if not self.round_about:
                    return BEFORE  # the end of the view: a part may lie outside of it
                n %= count
            if np.isposinf(self.ranges[n]):
                return BEHIND
            if self.valid[n]:
                farther = self.ranges[n] > self.ranges[beam] + self.gap / 2
                if self.known[n]:
                    return BEHIND if farther else BESIDE
                return BEHIND if farther else BEFORE
        return BEHIND
