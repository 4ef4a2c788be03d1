"""The lidar: exact ray casting through the true floor, then noise, drop-outs and a limited reach."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from algorithms.common.parallel_kernels import kernel
from algorithms.common.pose import FloatArray
from algorithms.simulator.buildings.floor_plan import AIR, DARK, Building, Surface
from algorithms.simulator.portable_random import DIRECTIONS, TURN, Ticks, normals, uniforms


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


@kernel
def enter(
    px: float, py: float, dx: float, dy: float
) -> tuple[int, int, int, int, float, float, float, float]:
    """How a beam from (px, py) in direction (dx, dy) goes from cell to cell; in cells.

    returns : column and row that it begins in, by how much they change at a crossing, distance along x and
              along y to the first crossing, and how far the beam goes per cell along x and along y
    """
    col, row = int(np.floor(px)), int(np.floor(py))
    step_x, step_y = (1 if dx > 0 else -1), (1 if dy > 0 else -1)
    first_x = (col + 1 - px) if dx > 0 else (px - col)
    first_y = (row + 1 - py) if dy > 0 else (py - row)
    per_x = 1.0 / abs(dx) if dx != 0 else np.inf
    per_y = 1.0 / abs(dy) if dy != 0 else np.inf
    # parallel to an axis it never crosses: without this 0 · inf would be no number
    return (
        col, row, step_x, step_y, first_x if dx != 0 else 1.0, first_y if dy != 0 else 1.0, per_x, per_y
    )  # fmt: skip


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
    col, row, step_x, step_y, first_x, first_y, per_x, per_y = enter(x / resolution, y / resolution, dx, dy)
    # Distance in cells to the n-th crossing is computed afresh each time: no error adds up.
    next_x, next_y = first_x * per_x, first_y * per_y
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
    directions: FloatArray,
    reach: float,
) -> tuple[FloatArray, NDArray[np.uint8]]:
    ranges = np.empty((len(xy), len(beam_ticks)))
    kinds = np.empty(ranges.shape, dtype=np.uint8)
    for n in range(len(xy)):
        for b in range(len(beam_ticks)):
            k = (headings[n] + beam_ticks[b]) % directions.shape[1]
            dx, dy = directions[0, k], directions[1, k]
            ranges[n, b], kinds[n, b] = first_hit(surface, resolution, xy[n, 0], xy[n, 1], dx, dy, reach)
    return ranges, kinds


def true_ranges(
    building: Building, xy: FloatArray, headings: Ticks, beam_ticks: Ticks, reach: float
) -> tuple[FloatArray, NDArray[np.uint8]]:
    """What a perfect lidar would measure.

    xy, headings : (N, 2) metres and (N,) ticks; poses in the world frame
    returns      : (N, beams) distance to the first wall, ``reach`` where there is none; metres; and
                   what the beam met, AIR where there is none
    """
    return _sweep(building.surface, building.resolution, xy, headings, beam_ticks, DIRECTIONS, reach)


def scan(
    building: Building, xy: FloatArray, headings: Ticks, lidar: Lidar, rng: np.random.Generator
) -> FloatArray:
    """What a real lidar returns along a drive; poses as in ``true_ranges``.

    returns : (N, beams) metres; NaN where nothing useful came back, ``inf`` where there was nothing within
              reach
    """
    ranges, kinds = true_ranges(building, xy, headings, lidar.beam_ticks(), lidar.reach)
    noise = normals(rng, ranges.size).reshape(ranges.shape)
    drawn = uniforms(rng, ranges.size).reshape(ranges.shape)
    nothing = kinds == AIR
    lost = drawn < np.where(kinds == DARK, lidar.lost_on_dark, lidar.lost)
    noisy = np.maximum(ranges + lidar.noise * noise, 0.05)
    return np.where(lost, np.nan, np.where(nothing, np.inf, noisy))


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
