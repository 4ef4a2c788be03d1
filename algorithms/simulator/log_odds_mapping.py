"""Log-odds mapping: scans at believed poses become free, occupied and unknown cells."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from algorithms.common.parallel_kernels import kernel
from algorithms.common.pose import FloatArray, Pose2
from algorithms.maps.grid_map import FREE, OCCUPIED, UNKNOWN, GridMap
from algorithms.simulator.lidar import Lidar, Scans
from algorithms.simulator.path_planning import Track
from algorithms.simulator.portable_random import COSINES, SINES, Ticks

Odds = NDArray[np.int16]


@dataclass(frozen=True)
class OddsModel:
    """Evidence in whole twentieths of a log-odds unit: sums of integers have no rounding."""

    hit: int = 17  # 0.85
    miss: int = -8  # −0.40
    least: int = -60
    most: int = 70
    occupied_from: int = 13  # 0.62, a probability of 0.65
    free_to: int = -28  # −1.41, a probability of 0.196


@kernel
def _integrate(
    odds: Odds,
    stamps: NDArray[np.int32],
    resolution: float,
    xy: FloatArray,
    headings: Ticks,
    beam_ticks: Ticks,
    cosines: FloatArray,
    sines: FloatArray,
    ranges: FloatArray,
    reach: float,
    hit: int,
    miss: int,
    least: int,
    most: int,
) -> None:
    """Add all scans to ``odds``; a scan counts once per cell, and a hit there silences misses.

    xy : (N, 2) poses from the corner of the grid; metres
    """
    height, width = odds.shape
    turn = len(cosines)
    for n in range(len(xy)):
        px, py = xy[n, 0] / resolution, xy[n, 1] / resolution
        hit_stamp, miss_stamp = 2 * n + 2, 2 * n + 1
        for b in range(len(beam_ticks)):
            if not ranges[n, b] < np.inf:
                continue
            k = (headings[n] + beam_ticks[b]) % turn
            t = ranges[n, b] / resolution
            row, col = int(np.floor(py + t * sines[k])), int(np.floor(px + t * cosines[k]))
            if 0 <= row < height and 0 <= col < width and stamps[row, col] != hit_stamp:
                stamps[row, col] = hit_stamp
                odds[row, col] = min(most, odds[row, col] + hit)
        for b in range(len(beam_ticks)):
            distance = ranges[n, b]
            if np.isnan(distance):
                continue
            k = (headings[n] + beam_ticks[b]) % turn
            dx, dy = cosines[k], sines[k]
            t_end = min(distance, reach) / resolution
            end_row, end_col = -1, -1
            if distance < np.inf:
                end_row, end_col = int(np.floor(py + t_end * dy)), int(np.floor(px + t_end * dx))
            col, row = int(np.floor(px)), int(np.floor(py))
            step_x, step_y = (1 if dx > 0 else -1), (1 if dy > 0 else -1)
            per_x = 1.0 / abs(dx) if dx != 0 else np.inf
            per_y = 1.0 / abs(dy) if dy != 0 else np.inf
            first_x = (col + 1 - px) if dx > 0 else (px - col)
            first_y = (row + 1 - py) if dy > 0 else (py - row)
            next_x = first_x * per_x if dx != 0 else np.inf
            next_y = first_y * per_y if dy != 0 else np.inf
            across, up, t = 0, 0, 0.0
            while t < t_end and 0 <= row < height and 0 <= col < width:
                if row == end_row and col == end_col:
                    break
                if stamps[row, col] < miss_stamp:
                    stamps[row, col] = miss_stamp
                    odds[row, col] = max(least, odds[row, col] + miss)
                if next_x < next_y:
                    t = next_x
                    across += 1
                    col += step_x
                    next_x = (first_x + across) * per_x
                else:
                    t = next_y
                    up += 1
                    row += step_y
                    next_y = (first_y + up) * per_y


def build_map(
    believed: Track,
    scans: Scans,
    lidar: Lidar,
    resolution: float,
    name: str,
    model: OddsModel | None = None,
    margin: int = 8,
) -> GridMap:
    """The map a robot makes of its scans, in its own frame, cropped to what it saw.

    believed   : (N) poses in the robot's frame
    scans      : (N, beams) of those poses
    resolution : metres per cell of the map
    margin     : unknown cells left around what was seen
    """
    model = model or OddsModel()
    low = np.floor((believed.xy.min(axis=0) - lidar.reach) / resolution).astype(np.int64) - 2
    high = np.ceil((believed.xy.max(axis=0) + lidar.reach) / resolution).astype(np.int64) + 2
    width, height = (high - low).tolist()
    odds = np.zeros((height, width), dtype=np.int16)
    _integrate(
        odds,
        np.zeros(odds.shape, dtype=np.int32),
        resolution,
        believed.xy - low * resolution,
        believed.heading,
        lidar.beam_ticks(),
        COSINES,
        SINES,
        scans.ranges,
        lidar.reach,
        model.hit,
        model.miss,
        model.least,
        model.most,
    )
    cells = np.full(odds.shape, UNKNOWN, dtype=np.int8)
    cells[odds <= model.free_to] = FREE
    cells[odds >= model.occupied_from] = OCCUPIED
    rows, cols = (
        np.nonzero((cells != UNKNOWN).any(axis=1))[0],
        np.nonzero((cells != UNKNOWN).any(axis=0))[0],
    )
    r0, c0 = max(0, int(rows[0]) - margin), max(0, int(cols[0]) - margin)
    cropped = cells[r0 : int(rows[-1]) + margin + 1, c0 : int(cols[-1]) + margin + 1].copy()
    x, y = round((int(low[0]) + c0) * resolution, 6), round((int(low[1]) + r0) * resolution, 6)
    return GridMap(cropped, resolution, Pose2(x, y, 0.0), name)
