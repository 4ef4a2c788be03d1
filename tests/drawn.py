"""Maps drawn in code with a known pose between them: what the tests of the core merge."""

from __future__ import annotations

from math import atan2, hypot

import numpy as np
from hypothesis import strategies as st

from algorithms.gridmap import GridMap
from algorithms.observation import Observation
from algorithms.pose import Pose2, wrap_angle

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
