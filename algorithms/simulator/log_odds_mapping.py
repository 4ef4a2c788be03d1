"""Log-odds mapping: scans at believed poses become free, occupied and unknown cells."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from algorithms.common.parallel_kernels import kernel
from algorithms.common.pose import FloatArray, Pose2
from algorithms.maps.grid_map import FREE, OCCUPIED, UNKNOWN, GridMap
from algorithms.simulator.lidar import Lidar, enter
from algorithms.simulator.path_planning import Track
from algorithms.simulator.portable_random import DIRECTIONS, Ticks

Odds = NDArray[np.int16]

MARGIN = 8  # unknown cells left around what was seen


class OddsModel(NamedTuple):
    """Evidence in whole twentieths of a log-odds unit: sums of integers have no rounding."""

    hit: int = 17  # 0.85
    miss: int = -8  # −0.40
    least: int = -60
    most: int = 70
    occupied_from: int = 13  # 0.62, a probability of 0.65
    free_to: int = -28  # −1.41, a probability of 0.196


USUAL = OddsModel()


@kernel
def _integrate(
    odds: Odds,
    xy: FloatArray,
    headings: Ticks,
    beam_ticks: Ticks,
    directions: FloatArray,
    ranges: FloatArray,
    reach: float,
    model: OddsModel,
) -> None:
    """Add all scans to ``odds``; a scan counts once per cell, and a hit there silences misses.

    xy, ranges, reach : in cells; (N, 2) poses from the corner of the grid
    """
    height, width = odds.shape
    stamps = np.zeros(odds.shape, dtype=np.int32)
    for n in range(len(xy)):
        px, py = xy[n]
        hit_stamp, miss_stamp = 2 * n + 2, 2 * n + 1
        for b in range(len(beam_ticks)):
            t = ranges[n, b]
            if not t < np.inf:
                continue
            k = (headings[n] + beam_ticks[b]) % directions.shape[1]
            row, col = int(np.floor(py + t * directions[1, k])), int(np.floor(px + t * directions[0, k]))
            if 0 <= row < height and 0 <= col < width and stamps[row, col] != hit_stamp:
                stamps[row, col] = hit_stamp
                odds[row, col] = min(model.most, odds[row, col] + model.hit)
        for b in range(len(beam_ticks)):
            if np.isnan(ranges[n, b]):
                continue
            k = (headings[n] + beam_ticks[b]) % directions.shape[1]
            dx, dy = directions[0, k], directions[1, k]
            t_end = min(ranges[n, b], reach)
            end_row, end_col = -1, -1
            if ranges[n, b] < np.inf:
                end_row, end_col = int(np.floor(py + t_end * dy)), int(np.floor(px + t_end * dx))
            col, row, step_x, step_y, first_x, first_y, per_x, per_y = enter(px, py, dx, dy)
            next_x, next_y = first_x * per_x, first_y * per_y
            across, up, t = 0, 0, 0.0
            while t < t_end and 0 <= row < height and 0 <= col < width:
                if row == end_row and col == end_col:
                    break
                if stamps[row, col] < miss_stamp:
                    stamps[row, col] = miss_stamp
                    odds[row, col] = max(model.least, odds[row, col] + model.miss)
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
    ranges: FloatArray,
    lidar: Lidar,
    resolution: float,
    name: str,
    model: OddsModel = USUAL,
) -> GridMap:
    """The map a robot makes of its scans, in its own frame, cropped to what it saw.

    believed   : (N) poses in the robot's frame
    ranges     : (N, beams) of those poses, as ``scan`` returns them; metres
    resolution : metres per cell of the map
    """
    low = np.floor((believed.xy.min(axis=0) - lidar.reach) / resolution).astype(np.int64) - 2
    high = np.ceil((believed.xy.max(axis=0) + lidar.reach) / resolution).astype(np.int64) + 2
    width, height = (high - low).tolist()
    odds = np.zeros((height, width), dtype=np.int16)
    xy, beams = (believed.xy - low * resolution) / resolution, lidar.beam_ticks()
    reach = lidar.reach / resolution
    _integrate(odds, xy, believed.heading, beams, DIRECTIONS, ranges / resolution, reach, model)
    cells = np.full(odds.shape, UNKNOWN, dtype=np.int8)
    cells[odds <= model.free_to] = FREE
    cells[odds >= model.occupied_from] = OCCUPIED
    rows, cols = (np.flatnonzero((cells != UNKNOWN).any(axis=axis)) for axis in (1, 0))
    r0, c0 = max(0, int(rows[0]) - MARGIN), max(0, int(cols[0]) - MARGIN)
    cropped = cells[r0 : int(rows[-1]) + MARGIN + 1, c0 : int(cols[-1]) + MARGIN + 1].copy()
    x, y = round((int(low[0]) + c0) * resolution, 6), round((int(low[1]) + r0) * resolution, 6)
    return GridMap(cropped, resolution, Pose2(x, y, 0.0), name)
