"""What a robot's own map says of its laser points: which are wall, and what would stand behind one."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from algorithms.common.pose import FloatArray, Pose2
from algorithms.detection.scan_clusters import Cluster
from algorithms.maps.grid_map import BoolArray, Float32Array, GridMap
from algorithms.maps.wall_distance import distance_to_walls
from algorithms.sensors.laser_scan import LaserScan

NEAR_CELLS = 1.5  # cells around a wall of the map, in which a laser point belongs to it
POSE = 0.05  # metres; how true a robot's pose in its own map is
THROUGH = 0.5  # share of the way's beams that cross a wall, from which the thing is behind it
BEFORE_IT = 0.3  # metres before a thing, in which a wall of the map is the thing itself
TURN = 0.01  # radians; how true its heading is


@dataclass(frozen=True, eq=False)
class MapWalls:
    """The walls of a robot's own map, seen from where it stands.

    grid  : the map
    robot : T_map_robot, where the robot stood in it
    """

    grid: GridMap
    robot: Pose2

    @cached_property
    def _distance(self) -> Float32Array:
        return distance_to_walls(self.grid.occupied)

    def explain(self, scan: LaserScan) -> BoolArray:
        """(N,) which beams end at a wall of the map."""
        off = self._off(self.robot.apply(scan.points()))
        ranges = np.where(scan.valid, scan.ranges, 0.0)
        return np.asarray(scan.valid & (off <= NEAR_CELLS * self.grid.resolution + POSE + TURN * ranges))

    def deny(self, cluster: Cluster, scan: LaserScan) -> str:
        """Why a thing cannot be there: a wall of the map lies before it. Empty where none does."""
        laser = (self.robot @ scan.mounting).xy
        step = self.grid.resolution / 2
        crossed = 0
        for point in self.robot.apply(scan.mounting.apply(cluster.points)):
            way = point - laser
            length = float(np.hypot(*way))
            along = np.arange(0.0, length - BEFORE_IT, step)[:, None] / max(length, step)
            crossed += bool((self._off(laser + way * along) < 0.5 * self.grid.resolution).any())
        if crossed < THROUGH * len(cluster.points):
            return ""
        return "the map has a wall before it: what is seen is a mirror's image or stands behind glass"

    def _off(self, points: FloatArray) -> FloatArray:
        """(N,) distance of (N, 2) points from the nearest wall, inf off the grid or for NaN; metres."""
        if not len(points):
            return np.zeros(0)
        at = np.nan_to_num(self.grid.grid_coordinates(points), nan=-1.0)
        cols, rows = np.floor(at).astype(np.int64).T
        inside = (cols >= 0) & (cols < self.grid.width) & (rows >= 0) & (rows < self.grid.height)
        off = np.full(len(points), np.inf)
        off[inside] = self._distance[rows[inside], cols[inside]] * self.grid.resolution
        return off
