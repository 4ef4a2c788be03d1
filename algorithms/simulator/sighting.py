"""The encounter: where one robot sees another, what it measures, and how the two frames truly lie."""

from __future__ import annotations

from dataclasses import dataclass
from math import atan2, cos, sin, sqrt

import numpy as np
import scipy  # its parts are loaded where they are first used

from algorithms.common.pose import FloatArray, Pose2, wrap_angle
from algorithms.maps.grid_map import GridMap
from algorithms.observations.observation import Observation
from algorithms.simulator.buildings.floor_plan import Building
from algorithms.simulator.lidar import sees
from algorithms.simulator.path_planning import Track
from algorithms.simulator.portable_random import Ticks, cosine, normals, radians, sine

NEAREST, FURTHEST = 1.2, 5.5  # metres between two robots that see one another
SURROUNDINGS = 4.0  # metres around the seen robot that both maps should know
APART = 3.0  # metres between the places of two meetings, at least: nearer ones tell the same twice
ROUGH_RANGE, ROUGH_BEARING = 0.3, 0.10472  # metres, radians (6°): the same encounter measured badly
SAME_WALL = 0.1  # metres; two cells of the usual map


@dataclass(frozen=True)
class RobotSighting:
    """Which scan of the observer's and which of the observed robot's drive fall together."""

    observer: int
    observed: int


def find_meetings(
    building: Building, observer: Track, observed: Track, walls: FloatArray, most: int = 1
) -> tuple[RobotSighting, ...]:
    """Pairs of poses in sight of one another, the first where both robots know most walls around.

    Every further one is as far from those before as it can be. Which of them came first is not asked:
    the drives have no clock.

    observer, observed : true drives; world frame
    walls   : (M, 2) walls both have seen; metres, world frame
    most    : how many; the first ones are the same for any number
    returns : fewer, or none, where the two do not come into sight at a fit distance that often
    """
    # Every second scan and every wall in small buildings; large ones are thinned out.
    i = np.arange(0, len(observer), max(2, len(observer) // 500))
    j = np.arange(0, len(observed), max(2, len(observed) // 500))
    walls = walls[:: max(1, len(walls) // 2000)]
    delta = observed.xy[j][None, :, :] - observer.xy[i][:, None, :]
    squared = delta[..., 0] * delta[..., 0] + delta[..., 1] * delta[..., 1]
    near = np.argwhere((squared >= NEAREST * NEAREST) & (squared <= FURTHEST * FURTHEST))
    known = _walls_around(observed.xy[j], walls)
    order = np.lexsort((near[:, 0], near[:, 1], -known[near[:, 1]]))
    near = near[order][:: max(1, len(near) // 4000)]
    scans = np.column_stack([i[near[:, 0]], j[near[:, 1]]])  # (K, 2) of observer and observed
    places = observed.xy[scans[:, 1]]
    apart = np.full(len(scans), np.inf)  # m², of each place from the nearest meeting
    found: list[RobotSighting] = []
    while len(found) < most:
        far = np.argsort(-apart, kind="stable")  # of equally far ones, most walls first
        for a, b in scans[far[apart[far] >= APART * APART]].tolist():
            if sees(building, observer.xy[a], observed.xy[b]):
                break
        else:
            break
        found.append(RobotSighting(a, b))
        dx, dy = (places - observed.xy[b]).T
        apart = np.minimum(apart, dx * dx + dy * dy)
    return tuple(found)


def _walls_around(xy: FloatArray, walls: FloatArray) -> Ticks:
    """(N,) how many of the shared walls lie in the surroundings of each point."""
    delta = xy[:, None, :] - walls[None, :, :]
    squared = delta[..., 0] * delta[..., 0] + delta[..., 1] * delta[..., 1]
    return np.asarray((squared <= SURROUNDINGS**2).sum(axis=1), dtype=np.int64)


def observe(
    true: tuple[Track, Track],
    believed: tuple[Track, Track],
    at: RobotSighting,
    rng: np.random.Generator,
    sigma: tuple[float, float],
    both_ways: bool,
) -> Observation:
    """What is written down of an encounter.

    true, believed : drives of observer and observed, in the world and each in its own frame
    sigma          : standard deviations of range (metres) and bearing (radians)
    both_ways      : the observed robot saw the observer too
    """
    i, j = at.observer, at.observed
    dx, dy = (true[1].xy[j] - true[0].xy[i]).tolist()
    kicks = normals(rng, 3).tolist()
    bearing = atan2(dy, dx) - radians(int(true[0].heading[i])) + sigma[1] * kicks[1]
    back = atan2(-dy, -dx) - radians(int(true[1].heading[j])) + sigma[1] * kicks[2]
    x1, y1 = believed[0].xy[i].tolist()
    x2, y2 = believed[1].xy[j].tolist()
    return Observation(
        observer=Pose2(round(x1, 6), round(y1, 6), round(radians(int(believed[0].heading[i])), 6)),
        observed_x=round(x2, 6),
        observed_y=round(y2, 6),
        observed_heading=round(radians(int(believed[1].heading[j])), 6),
        range=round(max(0.1, sqrt(dx * dx + dy * dy) + sigma[0] * kicks[0]), 6),
        bearing=round(wrap_angle(bearing), 6),
        sigma_range=sigma[0],
        sigma_bearing=sigma[1],
        bearing_back=round(wrap_angle(back), 6) if both_ways else None,
    )


def in_belief(true: Track, believed: Track, walls: FloatArray) -> FloatArray:
    """Where a robot's map puts walls it saw: by the error of the scan it was nearest at.

    walls   : (M, 2) metres, world frame
    returns : (M, 2) metres, the robot's frame
    """
    _, nearest = scipy.spatial.cKDTree(true.xy).query(walls)
    turn = believed.heading[nearest] - true.heading[nearest]
    c, s = cosine(turn), sine(turn)
    x, y = (walls - true.xy[nearest]).T
    return np.asarray(np.stack([x * c - y * s, x * s + y * c], axis=-1) + believed.xy[nearest])


def fit(points_ref: FloatArray, points_mov: FloatArray) -> tuple[Pose2, float]:
    """The least-squares T_ref_mov between paired (N, 2) points, and what remains (rms, metres)."""
    mean_ref, mean_mov = points_ref.mean(axis=0), points_mov.mean(axis=0)
    a, b = points_mov - mean_mov, points_ref - mean_ref
    dot = float((a[:, 0] * b[:, 0] + a[:, 1] * b[:, 1]).sum())
    cross = float((a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]).sum())
    theta = round(atan2(cross, dot), 6)
    c, s = cos(theta), sin(theta)
    mx, my = mean_mov.tolist()
    rx, ry = mean_ref.tolist()
    T_ref_mov = Pose2(round(rx - c * mx + s * my, 6), round(ry - s * mx - c * my, 6), theta)
    rest = points_ref - T_ref_mov.apply(points_mov)
    return T_ref_mov, sqrt(float((rest * rest).sum(axis=1).mean()))


def measured_overlap(ref: GridMap, mov: GridMap, T_ref_mov: Pose2) -> float:
    """Share of the occupied cells of the map with fewer that the other map has within 0.1 m."""
    few, many = T_ref_mov.apply(mov.points), ref.points
    if len(few) > len(many):
        few, many = many, few
    distance, _ = scipy.spatial.cKDTree(many).query(few, distance_upper_bound=SAME_WALL)
    return float(np.isfinite(distance).mean())
