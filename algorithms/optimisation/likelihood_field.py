"""The robust objective: metres of wall that agree, less metres of wall that the other map knows to be free.

Γ of eq. (17) rewards ink on ink and knows nothing of contradictions, so a thick wall across another
robot's free floor costs it nothing. Here a wall counts by how near the other map's nearest wall is (the
likelihood field of Thrun 2001), speaks against the transform where the other map saw free floor instead,
and says nothing where the other map knows nothing. Both maps are asked in turn, so that swapping them
changes nothing but the direction of the answer.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import ceil, floor, log, sqrt
from typing import Annotated

import numpy as np

from algorithms.common.pose import FloatArray, Pose2
from algorithms.common.setting_bounds import Bounds, CheckedConfig
from algorithms.maps.grid_map import BoolArray, Float32Array, GridMap, where
from algorithms.maps.wall_distance import distance_to_walls, surface
from algorithms.observations.observation import Encounter, robots_of
from algorithms.observations.search_window import CoupledWindow
from algorithms.optimisation.objective import PAD, Lookup, Objective, Side
from algorithms.spectra.augmented_map import AugmentConfig

# Walls that count less than this share of one at the encounter are left out: the cost of a look-up
# would then be most of what they bring.
LEAST_NEARNESS = 0.05
REACH = sqrt(-2 * log(LEAST_NEARNESS))  # in standard deviations, 2.45


@dataclass(frozen=True)
class AgreementConfig(CheckedConfig):
    """Settings of the agreement."""

    blur: Annotated[float, Bounds(0.02, 1, 0.01, "m", "σ_d", "blur")] = 0.1
    """Standard deviation of the distance between two drawings of the same wall."""
    penalty: Annotated[float, Bounds(0, 5, 0.1, "", "λ", "contradiction")] = 1.0
    """What a metre of wall in the other map's free floor takes back, in metres of wall that agree."""
    evidence: Annotated[float, Bounds(0.05, 5, 0.05, "m", "ℓ", "evidence")] = 0.25
    """Metres of wall that say as much as one measurement: neighbouring cells err alike. It weighs the
    sightings against the walls, and makes a covariance of the peak's width."""


def make_agreement(
    ref: GridMap,
    mov: GridMap,
    encounters: Sequence[Encounter],
    augmentation: AugmentConfig,
    config: AgreementConfig,
    window: CoupledWindow | None = None,
    lookup: Lookup = Lookup.BILINEAR,
    robot_size: float = 0.0,
) -> Objective:
    """The agreement of two maps as a function of the transform; in metres of wall.

    augmentation : its Σ_aug says how much a wall counts by its distance from the nearest encounter; its
                   intensity does not matter here
    window       : what a transform deviates from its sightings is taken off: half a squared standard
                   deviation costs ``config.evidence`` metres of wall
    robot_size   : so near to a place where a robot is known to have stood nothing speaks for or against;
                   metres
    """
    precision = np.asarray(np.linalg.inv(augmentation.covariance()), dtype=np.float64)
    far = REACH * sqrt(float(np.linalg.eigvalsh(augmentation.covariance())[-1]))
    x_ref = np.array([at.x_ref for at in encounters])
    x_mov = np.array([at.x_mov for at in encounters])
    # points lie within ``far`` of an encounter; a transform may be off by as much again
    ref_part, mov_part = _part_around(ref, x_ref, 2 * far), _part_around(mov, x_mov, 2 * far)
    sides, robots = [], robots_of(encounters, robot_size)
    for grid, (part, corner), stood, source, source_part, anchors, backward in (
        (ref, ref_part, robots.in_ref, mov, mov_part, x_mov, False),
        (mov, mov_part, robots.in_mov, ref, ref_part, x_ref, True),
    ):
        points, nearness = _weighted_surface(source, *source_part, anchors, precision, robot_size)
        table = wall_field(part.occupied, part.free, grid.resolution, config.blur, config.penalty)
        clear(table, grid, corner, stood, robot_size)
        side = Side(
            grid=grid,
            table=table,
            corner=corner,
            anchor=anchors[0],
            points=points - anchors[0],
            weights=nearness * source.resolution,  # a cell stands for so much wall
            backward=backward,
        )
        sides.append(side)
    return Objective(tuple(sides), lookup, window, config.evidence)


def _part_around(grid: GridMap, centres: FloatArray, radius: float) -> tuple[GridMap, FloatArray]:
    """The part of a map near (N, 2) places, and (2,) column and row of its first cell in the map; metres."""
    at = grid.grid_coordinates(centres)
    reach = ceil(radius / grid.resolution)
    size = np.array([grid.width, grid.height])
    low = np.clip(np.floor(at.min(axis=0)).astype(int) - reach, 0, size - 1)
    high = np.clip(np.floor(at.max(axis=0)).astype(int) + reach + 1, low + 1, size)
    cells = grid.cells[low[1] : high[1], low[0] : high[0]]
    origin = grid.origin @ Pose2(*(low * grid.resolution).tolist())
    return GridMap(cells, grid.resolution, origin, grid.name), low.astype(np.float64)


def wall_field(
    walls: BoolArray, free: BoolArray, cell: float, blur: float, penalty: float = 1.0
) -> Float32Array:
    """(H + 2·PAD, W + 2·PAD) what a wall of the other map is worth at every cell: 1 on a wall, −λ on free
    floor, 0 on the unknown.

    blur    : σ_d, standard deviation of the distance between two drawings of one wall; metres
    penalty : λ
    """
    near = np.exp(-0.5 * (distance_to_walls(walls) * np.float32(cell / blur)) ** 2)
    return np.pad(near - np.float32(penalty) * free * (1 - near), PAD).astype(np.float32)


def clear(table: Float32Array, grid: GridMap, corner: FloatArray, places: FloatArray, radius: float) -> None:
    """Make a ``wall_field`` say nothing around places: the maker of the map stood there, and what the
    other map shows there is the robot.

    corner : (2,) column and row of the table's first cell, its pads apart, in the map
    places : (N, 2) metres, the map's frame
    """
    reach = radius / grid.resolution
    for col, row in (grid.grid_coordinates(places) - corner + PAD).tolist():
        rows = np.arange(max(0, floor(row - reach)), min(len(table), ceil(row + reach)))
        cols = np.arange(max(0, floor(col - reach)), min(table.shape[1], ceil(col + reach)))
        within = np.hypot(rows[:, None] + 0.5 - row, cols + 0.5 - col) < reach
        table[np.ix_(rows, cols)] *= ~within


def _weighted_surface(
    grid: GridMap,
    part: GridMap,
    corner: FloatArray,
    centres: FloatArray,
    precision: FloatArray,
    robot_size: float,
) -> tuple[FloatArray, FloatArray]:
    """(N, 2) surface cells in the map's frame, metres, and (N,) how near they are to an encounter."""
    rows, cols = where(surface(part.occupied, part.free))
    points = grid.centres(rows + int(corner[1]), cols + int(corner[0]))
    nearness, clear = np.zeros(len(points)), np.ones(len(points), dtype=np.bool_)
    for centre in centres:
        offset = points - centre
        clear &= np.einsum("ni,ni->n", offset, offset) >= robot_size**2
        squared = np.einsum("ni,ij,nj->n", offset, precision, offset)
        np.maximum(nearness, np.exp(-0.5 * squared), out=nearness)
    counts = (nearness >= LEAST_NEARNESS) & clear
    return points[counts], nearness[counts]
