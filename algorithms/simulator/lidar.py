"""The lidar: exact ray casting through the true floor, then noise, drop-outs and a limited reach."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from algorithms.common.parallel_kernels import kernel
from algorithms.common.pose import FloatArray
from algorithms.simulator.buildings.floor_plan import AIR, DARK, Building, Surface
from algorithms.simulator.portable_random import COSINES, SINES, TURN, Ticks, normals, uniforms


@dataclass(frozen=True)
class Lidar:
    """What a scanner can do."""

    beams: int = 540
    field: float = 270.0
    """Field of view around straight ahead; degrees."""
    reach: float = 8.0
    """Range beyond which nothing comes back; metres."""
    noise: float = 0.02
    """Standard deviation of a range; metres."""
    lost: float = 0.01
    """Share of beams that return nothing from a wall."""
    lost_on_dark: float = 0.8
    """Share of beams that return nothing from glass and black surfaces."""

    def beam_ticks(self) -> Ticks:
        """(beams,) directions from straight ahead, counter-clockwise; ticks."""
        span = round(self.field * TURN / 360)
        return np.asarray((np.arange(self.beams) * span) // self.beams - span // 2, dtype=np.int64)


@dataclass(frozen=True, eq=False)
class Scans:
    """What a scanner returned along a drive.

    ranges : (N, beams) metres; NaN where nothing useful came back, ``inf`` where there was nothing
             within reach
    """

    ranges: FloatArray


@kernel
def first_hit(
    surface: Surface, resolution: float, x: float, y: float, dx: float, dy: float, reach: float
) -> tuple[float, int]:
    """Follow one beam from cell to cell (every cell it touches, none left out) to the first wall.

    x, y    : where the beam starts; metres, world frame
    dx, dy  : its direction, a unit vector
    returns : distance to the face of the wall in metres and what the wall is made of; ``reach`` and
              AIR where the beam ends in the air or leaves the raster
    """
    height, width = surface.shape
    px, py = x / resolution, y / resolution
    col, row = int(np.floor(px)), int(np.floor(py))
    step_x, step_y = (1 if dx > 0 else -1), (1 if dy > 0 else -1)
    # Distance in cells to the n-th crossing is computed afresh each time: no error adds up.
    first_x = (col + 1 - px) if dx > 0 else (px - col)
    first_y = (row + 1 - py) if dy > 0 else (py - row)
    per_x = 1.0 / abs(dx) if dx != 0 else np.inf
    per_y = 1.0 / abs(dy) if dy != 0 else np.inf
    next_x = first_x * per_x if dx != 0 else np.inf
    next_y = first_y * per_y if dy != 0 else np.inf
    across, up, t = 0, 0, 0.0
    limit = reach / resolution
    while t < limit:
        if row < 0 or row >= height or col < 0 or col >= width:
            break
        if surface[row, col] != 0:
            return t * resolution, int(surface[row, col])
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
    return reach, 0


@kernel
def _sweep(
    surface: Surface,
    resolution: float,
    xy: FloatArray,
    headings: Ticks,
    beam_ticks: Ticks,
    cosines: FloatArray,
    sines: FloatArray,
    reach: float,
    ranges: FloatArray,
    kinds: NDArray[np.uint8],
) -> None:
    """Cast every beam of every pose; fills ``ranges`` and ``kinds``, both (N, beams)."""
    turn = len(cosines)
    for n in range(len(xy)):
        for b in range(len(beam_ticks)):
            k = (headings[n] + beam_ticks[b]) % turn
            ranges[n, b], kinds[n, b] = first_hit(
                surface, resolution, xy[n, 0], xy[n, 1], cosines[k], sines[k], reach
            )


def true_ranges(
    building: Building, xy: FloatArray, headings: Ticks, beam_ticks: Ticks, reach: float
) -> tuple[FloatArray, NDArray[np.uint8]]:
    """What a perfect lidar would measure.

    xy, headings : (N, 2) metres and (N,) ticks; poses in the world frame
    returns      : (N, beams) distance to the first wall, ``reach`` where there is none; metres; and
                   what the beam met, AIR where there is none
    """
    ranges = np.empty((len(xy), len(beam_ticks)))
    kinds = np.empty(ranges.shape, dtype=np.uint8)
    _sweep(
        building.surface,
        building.resolution,
        xy,
        headings,
        beam_ticks,
        COSINES,
        SINES,
        reach,
        ranges,
        kinds,
    )
    return ranges, kinds


def scan(
    building: Building, xy: FloatArray, headings: Ticks, lidar: Lidar, rng: np.random.Generator
) -> Scans:
    """What a real lidar returns along a drive; poses as in ``true_ranges``."""
    ranges, kinds = true_ranges(building, xy, headings, lidar.beam_ticks(), lidar.reach)
    noise = normals(rng, ranges.size).reshape(ranges.shape)
    luck = uniforms(rng, ranges.size).reshape(ranges.shape)
    nothing = kinds == AIR
    lost = luck < np.where(kinds == DARK, lidar.lost_on_dark, lidar.lost)
    noisy = np.maximum(ranges + lidar.noise * noise, 0.05)
    return Scans(np.where(lost, np.nan, np.where(nothing, np.inf, noisy)))


def sees(building: Building, from_xy: FloatArray, to_xy: FloatArray) -> bool:
    """Whether nothing stands between two (2,) points; metres, world frame."""
    delta = to_xy - from_xy
    distance = float(np.sqrt(delta[0] * delta[0] + delta[1] * delta[1]))
    if distance == 0.0:
        return True
    x, y = from_xy.tolist()
    dx, dy = (delta / distance).tolist()
    _, kind = first_hit(building.surface, building.resolution, x, y, dx, dy, distance)
    return kind == AIR
