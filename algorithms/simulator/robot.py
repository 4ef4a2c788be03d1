"""One simulated robot: its scanner, its frame, its drive and the map it makes."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from algorithms.common.pose import FloatArray
from algorithms.maps.grid_map import GridMap
from algorithms.simulator.buildings.floor_plan import Building
from algorithms.simulator.changes import rearranged
from algorithms.simulator.lidar import Lidar, scan
from algorithms.simulator.log_odds_mapping import build_map
from algorithms.simulator.odometry_drift import OdometryDrift, believe
from algorithms.simulator.path_planning import STEP, PathPlanner, Track
from algorithms.simulator.portable_random import TURN, pick, snap, stream, uniform, whole
from algorithms.simulator.room_tours import Tour
from algorithms.simulator.wear import Wear, worn


@dataclass(frozen=True)
class Conditions:
    """What makes a robot's map differ from the floor plan, beside the noise of its scanner.

    drift      : how far it goes astray
    changed    : doors are shut and furniture is moved since the floor plan was drawn
    wear       : what happens to the finished map
    resolution : of the map, metres per cell; None draws 0.05, seldom 0.04 or 0.06
    """

    drift: OdometryDrift = field(default_factory=OdometryDrift)
    changed: bool = False
    wear: Wear = field(default_factory=Wear)
    resolution: float | None = None


@dataclass(frozen=True, eq=False)
class RobotModel:
    """What a robot is before it drives.

    purpose     : words that name its stream of random numbers
    turn, shift : its frame, T_robot_world without drift; ticks and (2,) metres
    resolution  : of its map; metres per cell
    """

    name: str
    seed: int
    purpose: tuple[str, ...]
    lidar: Lidar
    turn: int
    shift: FloatArray
    resolution: float
    conditions: Conditions


@dataclass(frozen=True, eq=False)
class Robot:
    """One robot's drive and its map.

    body     : its scanner and its frame
    tour     : the stops it visited and the walls in view of them
    true     : (N) poses; world frame
    believed : (N) poses; the robot's own frame, the frame of ``grid``
    ranges   : (N, beams) what its scanner returned at these poses, as ``scan`` returns it; metres
    grid     : the map it made
    """

    body: RobotModel
    tour: Tour
    true: Track
    believed: Track
    ranges: FloatArray
    grid: GridMap


def make_body(name: str, seed: int, kind: str, reach: float, conditions: Conditions) -> RobotModel:
    """A robot with a scanner, of ``reach`` metres, and a frame of its own."""
    rng = stream(seed, kind, name, "body")
    beams, field = pick(rng, ((540, 270.0), (540, 270.0), (720, 360.0), (360, 360.0)))
    lidar = Lidar(beams=beams, field=field, reach=reach, noise=uniform(rng, 0.012, 0.03))
    drawn = pick(rng, (0.05,) * 8 + (0.04, 0.06))
    turn = whole(rng, 0, TURN - 1)
    shift = snap(np.array([uniform(rng, -40.0, 40.0), uniform(rng, -40.0, 40.0)]))
    resolution = conditions.resolution or drawn
    return RobotModel(name, seed, (kind, name, "drive"), lidar, turn, shift, resolution, conditions)


def drive(
    building: Building, planner: PathPlanner, tour: Tour, body: RobotModel, step: float = STEP
) -> Robot:
    """Send a robot on a tour: scan every ``step`` metres, and map what came back."""
    rng, conditions = stream(body.seed, *body.purpose), body.conditions
    true = planner.drive(list(tour.stops), step)
    if conditions.changed:
        building = rearranged(building, true.xy, stream(body.seed, *body.purpose, "another day"))
    believed = believe(true, body.turn, body.shift, conditions.drift, rng)
    ranges = scan(building, true.xy, true.heading, body.lidar, rng)
    grid = build_map(believed, ranges, body.lidar, body.resolution, body.name)
    return Robot(body, tour, true, believed, ranges, worn(grid, conditions.wear, rng))
