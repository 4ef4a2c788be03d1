"""Maps drawn in code with a known pose between them: what the tests of the core merge."""

from __future__ import annotations

from dataclasses import dataclass
from math import atan2, hypot

import numpy as np
from hypothesis import strategies as st

from algorithms.common.pose import Pose2, rotation, wrap_angle
from algorithms.maps.grid_map import FREE, OCCUPIED, UNKNOWN, GridMap
from algorithms.observations.observation import Encounter, Observation
from algorithms.observations.search_window import CoupledWindow, WindowConfig, coupled_window
from algorithms.optimisation.likelihood_field import AgreementConfig, make_agreement
from algorithms.optimisation.objective import Lookup, Objective, make_objective
from algorithms.spectra.augmented_map import AugmentConfig, augment

finite = {"allow_nan": False, "allow_infinity": False}
angles = st.floats(-np.pi, np.pi, **finite)
lengths = st.floats(-50, 50, **finite)
poses = st.builds(Pose2, lengths, lengths, angles)

# Walls of a flat without any symmetry: (x0, y0, x1, y1) in metres.
WALLS = [
    (0, 0, 9, 0), (9, 0, 9, 4), (9, 4, 6.5, 4), (6.5, 4, 6.5, 7), (6.5, 7, 0, 7), (0, 7, 0, 0),
    (3, 0, 3, 2.2), (3, 3.4, 3, 7), (3, 4.5, 5, 4.5), (6, 4.5, 6.5, 4.5), (6, 0, 6, 1.2),
    (1, 5.5, 1.8, 6.3), (7.2, 1.5, 8.3, 2.4), (4.2, 1, 5, 1), (4.2, 1, 4.2, 1.6),
]  # fmt: skip


def drawn_map(
    T_map_world: Pose2,
    resolution: float = 0.05,
    seen: tuple[float, float, float, float] = (-1, -1, 10, 8),
    origin_yaw: float = 0.0,
    name: str = "map",
) -> GridMap:
    """The flat as a robot with its own frame would have drawn it.

    T_map_world : from the flat's frame to the robot's
    seen        : x0, y0, x1, y1 of the part of the flat that it saw; metres, the flat's frame
    origin_yaw  : of the raster in the robot's frame
    """
    ends = np.array([[-1, -1], [10, -1], [10, 8], [-1, 8]], dtype=float)
    T_yawed_map = Pose2(theta=-origin_yaw)
    corners = T_yawed_map.apply(T_map_world.apply(ends))
    low = np.floor(corners.min(axis=0) / resolution) * resolution
    width, height = np.ceil((corners.max(axis=0) - low) / resolution).astype(int)
    origin = Pose2(theta=origin_yaw) @ Pose2(*low.tolist())
    blank = GridMap(np.full((height, width), -1, np.int8), resolution, origin)
    rows, cols = np.indices((height, width))
    world = T_map_world.inverse().apply(blank.centres(rows.ravel(), cols.ravel()))
    x, y = world.T
    inside = (x > 0) & (x < 9) & (y > 0) & (y < 7) & ~((x > 6.5) & (y > 4))
    cells = np.where(inside, 0, -1)
    for x0, y0, x1, y1 in WALLS:
        along = np.array([x1 - x0, y1 - y0]) / hypot(x1 - x0, y1 - y0)
        offset = world - (x0, y0)
        at = offset @ along
        across = offset @ (-along[1], along[0])
        reach = hypot(x1 - x0, y1 - y0) + 0.05
        cells[(at > -0.05) & (at < reach) & (np.abs(across) < 0.06)] = 100
    outside = (x < seen[0]) | (x > seen[2]) | (y < seen[1]) | (y > seen[3])
    cells[outside] = -1
    return GridMap(cells.reshape(height, width).astype(np.int8), resolution, origin, name)


def bent(grid: GridMap, curvature: float = 0.025) -> GridMap:
    """The map of a robot whose heading has drifted: the farther right, the more turned."""
    rows, cols = np.indices(grid.cells.shape)
    at = grid.origin.inverse().apply(grid.centres(rows.ravel(), cols.ravel()))
    swung = at.copy()
    swung[:, 1] += curvature * (at[:, 0] - at[:, 0].mean()) ** 2
    col, row = np.floor(swung / grid.resolution).astype(int).T
    inside = (row >= 0) & (row < grid.height) & (col >= 0) & (col < grid.width)
    cells = np.full(grid.cells.size, UNKNOWN, dtype=np.int8)
    cells[inside] = grid.cells[row[inside], col[inside]]
    return GridMap(cells.reshape(grid.cells.shape), grid.resolution, grid.origin, grid.name)


def sighting(
    T_ref_world: Pose2, T_mov_world: Pose2, observer: Pose2, observed: Pose2, **noise: float
) -> Observation:
    """The observation of two robots that stand at ``observer`` and ``observed`` in the flat."""
    dx, dy = observed.x - observer.x, observed.y - observer.y
    at_ref, at_mov = T_ref_world @ observer, T_mov_world @ observed
    return Observation(
        observer=at_ref,
        observed_x=at_mov.x,
        observed_y=at_mov.y,
        observed_heading=at_mov.theta,
        range=hypot(dx, dy) + noise.get("range", 0.0),
        bearing=wrap_angle(atan2(dy, dx) - observer.theta + noise.get("bearing", 0.0)),
        bearing_back=wrap_angle(atan2(-dy, -dx) - observed.theta),
    )


OBSERVER, OBSERVED = Pose2(1.5, 2.5, 0.4), Pose2(4.6, 3.2, 2.0)
T_REF_WORLD, T_MOV_WORLD = Pose2(3.0, -4.0, 0.3), Pose2(-12.0, 5.0, -1.7)
T_REF_MOV = T_REF_WORLD @ T_MOV_WORLD.inverse()


def flat_pair(
    T_ref_world: Pose2 = T_REF_WORLD, T_mov_world: Pose2 = T_MOV_WORLD, mov_resolution: float = 0.05
) -> tuple[GridMap, GridMap, Observation, Pose2]:
    """Two maps of the flat that overlap in its middle, the sighting, and T_ref_mov."""
    ref = drawn_map(T_ref_world, seen=(-1, -1, 6.7, 8), name="ref")
    mov = drawn_map(T_mov_world, mov_resolution, seen=(2.5, -1, 10, 8), name="mov")
    seen = sighting(T_ref_world, T_mov_world, OBSERVER, OBSERVED)
    return ref, mov, seen, T_ref_world @ T_mov_world.inverse()


seeds = st.integers(0, 2**32 - 1)


@st.composite
def small_maps(draw: st.DrawFn, side: int = 24) -> GridMap:
    """Floors with walls and blocks strewn over them, on a raster that lies anywhere, anyhow."""
    rng = np.random.default_rng(draw(seeds))
    height, width = draw(st.integers(1, side)), draw(st.integers(1, side))
    cells = np.full((height, width), draw(st.sampled_from([FREE, UNKNOWN])), dtype=np.int8)
    for _ in range(draw(st.integers(0, 4))):
        row, col, tall, wide = rng.integers(0, side, 4)
        cells[row : row + tall, col : col + wide] = rng.choice([FREE, FREE, OCCUPIED, 45, UNKNOWN])
    longest = draw(st.sampled_from([2, side]))
    for _ in range(draw(st.integers(1, 9))):
        row, col, length = rng.integers((0, 0, 1), (height, width, longest))
        tall, wide = (length, 1) if rng.random() < 0.5 else (1, length)
        cells[row : row + tall, col : col + wide] = OCCUPIED
    return GridMap(cells, draw(st.sampled_from([0.05, 0.08, 0.1, 0.2])), draw(poses))


@st.composite
def encounters_in(
    draw: st.DrawFn, ref: GridMap, mov: GridMap, T_ref_mov: Pose2 | None = None
) -> list[Encounter]:
    """One or two meetings on both maps that one transform explains up to their own errors."""

    def place(grid: GridMap) -> np.ndarray:
        share = np.array([draw(st.floats(0, 1)), draw(st.floats(0, 1))])
        return grid.origin.apply(share * (grid.width, grid.height) * grid.resolution)

    x_mov = place(mov)
    if T_ref_mov is None:
        turn = draw(angles)
        T_ref_mov = Pose2(*(place(ref) - rotation(turn) @ x_mov).tolist(), turn)
    found: list[Encounter] = []
    for x in (x_mov, place(mov))[: draw(st.integers(1, 2))]:
        sigma = np.array([draw(st.sampled_from([0.01, 0.05, 0.2])), draw(st.sampled_from([0.01, 0.1]))])
        axes = rotation(draw(angles))
        error = axes @ (sigma * (draw(st.floats(-1, 1)), draw(st.floats(-1, 1))))
        found.append(Encounter(T_ref_mov.apply(x) + error, x, axes @ np.diag(sigma**2) @ axes.T))
    return found


@dataclass(frozen=True, eq=False)
class Problem:
    """What a search is given."""

    ref: GridMap
    mov: GridMap
    encounters: list[Encounter]
    window: CoupledWindow
    objective: Objective


@st.composite
def problems(draw: st.DrawFn, side: int = 24, deviations: tuple[float, ...] = (1.0, 2.0, 3.5)) -> Problem:
    """Two small maps, of one place or of two, their meetings, and one of the objectives, as the paper's
    raster reads it.
    """
    ref, mov, truth = draw(small_maps(side)), draw(small_maps(side)), None
    if draw(st.booleans()):
        mov = GridMap(ref.cells, ref.resolution, mov.origin)
        truth = ref.origin @ mov.origin.inverse()
    met = draw(encounters_in(ref, mov, truth))
    margin = draw(st.sampled_from([0.02, 0.1]))
    window = coupled_window(met, WindowConfig("coupled", margin, draw(st.sampled_from(deviations))))
    lift = AugmentConfig(
        spread=draw(st.sampled_from([0.5, 1.0, 4.0])), aspect=draw(st.sampled_from([1.0, 3.0])), tilt=30.0
    )
    if draw(st.booleans()):
        sigma = lift.covariance()
        pair = augment(ref, met[0].x_ref, sigma, 100.0), augment(mov, met[0].x_mov, sigma, 100.0)
        return Problem(ref, mov, met, window, make_objective(*pair, Lookup.NEAREST))
    config = AgreementConfig(
        blur=draw(st.sampled_from([0.02, 0.1, 0.5])), penalty=draw(st.sampled_from([0.0, 0.3, 1.0, 3.0]))
    )
    counted = window if draw(st.booleans()) else None
    return Problem(
        ref, mov, met, window, make_agreement(ref, mov, met, lift, config, counted, Lookup.NEAREST)
    )


def symmetric_hall() -> tuple[GridMap, list[Observation]]:
    """A hall that looks alike turned by 180°, and two sightings in it, the first in its middle."""
    cells = np.full((160, 240), FREE, dtype=np.int8)
    cells[:3], cells[-3:], cells[:, :3], cells[:, -3:] = (OCCUPIED,) * 4
    for row, col in ((40, 60), (118, 178), (100, 40), (58, 198)):
        cells[row : row + 2, col : col + 2] = OCCUPIED
    grid = GridMap(cells, 0.05)
    middle, aside = Pose2(6.0, 4.0), Pose2(8.5, 3.0)
    observer = Pose2(4.0, 4.0)
    return grid, [sighting(Pose2(), Pose2(), observer, robot) for robot in (middle, aside)]
