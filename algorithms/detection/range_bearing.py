"""From the laser points of a robot to the range and bearing of its centre, with what they leave open."""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import atan2, hypot, log, pi, sqrt

import numpy as np

from algorithms.common.pose import FloatArray, wrap_angle, wrap_angles
from algorithms.detection.footprint import Footprint
from algorithms.detection.footprint_fit import ON_ROBOT, PAST_ROBOT, UNLIKELY, BeamsAround
from algorithms.detection.scan_clusters import Cluster
from algorithms.sensors.laser_scan import LaserScan

OUTLINE = 0.005  # metres; how true a robot's outline is: boards, corners, a beam as wide as a finger
COARSE, COARSE_TURN = 0.03, 0.175  # metres, radians (10°): spacing of the first poses that are tried
REACH = 5  # of them to each side of where the robot is expected
LEVELS = 4  # of halving that spacing: 2 mm and 0.6° in the end
ENOUGH = 3000  # poses that matter: about two per standard deviation each way, halving them adds nothing
NEGLIGIBLE = 8.0  # log-likelihood below the best: 1/3000 of its weight


@dataclass(frozen=True)
class RobotPosition:
    """Where another robot's centre is, as one robot measured it.

    range, bearing             : from the robot's own frame; metres and radians, counter-clockwise
    sigma_range, sigma_bearing : one standard deviation
    unexplained                : share of the beams around that a robot there does not explain, 0 … 1
    turn                       : of the outline that explains them best, from the robot's own heading; a half
                                 turn more is as good, and a disc has none; radians
    """

    range: float
    bearing: float
    sigma_range: float
    sigma_bearing: float
    unexplained: float
    turn: float = 0.0

    def point(self) -> FloatArray:
        """(2,) metres, the robot's frame."""
        return np.array([self.range * np.cos(self.bearing), self.range * np.sin(self.bearing)])


def mean_of_points(cluster: Cluster) -> FloatArray:
    """(2,) the mean of the salient points, as section III-A has it; metres, the laser's frame."""
    return np.asarray(cluster.points.mean(axis=0))


def position_of(cluster: Cluster, scan: LaserScan, body: Footprint) -> RobotPosition:
    """The centre of the robot that a cluster belongs to.

    Section III-A takes the mean of the salient points. That is a point of the surface, and which one depends
    on how the robot is turned. So the robot's outline is put to every place and turn near by, and weighed by
    how well it explains the beams: those that ended on it, and those that went past it. Mean and standard
    deviation of all that is left are the measurement; a part that is hidden leaves more.
    """
    beams = _beams_around(cluster, scan, body)
    poses, spacing, turn = _first_poses(cluster, body), COARSE, COARSE_TURN
    across_beams = hypot(*mean_of_points(cluster)) * abs(scan.angle_increment)  # from one to the next
    for _ in range(LEVELS):
        swing = 0.0 if body.round else turn * body.widest / 2  # of a corner, from one turn to the next
        values = beams.likelihoods(poses, body, slack=hypot(spacing, swing) / 2)
        order = np.argsort(-values, kind="stable")
        below = values[order[0]] - values[order]
        if (below < NEGLIGIBLE).sum() > ENOUGH:
            poses = poses[order[below < NEGLIGIBLE]]
            break
        # a place that is half a spacing off has beams at both edges that it does not explain
        edges = -log(UNLIKELY) * spacing / across_beams
        poses = poses[order[below < NEGLIGIBLE + edges][:ENOUGH]]
        spacing, turn = spacing / 2, turn / 2
        poses = _halved(poses, spacing, 0.0 if body.round else turn)
    values = beams.likelihoods(poses, body)
    weights = np.exp(values - values.max())
    weights /= weights.sum()
    likeliest = poses[int(np.argmax(values))]
    seen = _summary(scan, poses[:, :2], weights, spacing, beams.unexplained(likeliest, body))
    return replace(seen, turn=wrap_angle(float(likeliest[2]) + scan.mounting.theta))


def _beams_around(cluster: Cluster, scan: LaserScan, body: Footprint) -> BeamsAround:
    """The beams that a robot near the cluster could be met by; lost ones, and those that something nearer
    stopped, say nothing.
    """
    mean = mean_of_points(cluster)
    distance, bearing = hypot(*mean), atan2(mean[1], mean[0])
    reach = body.widest + COARSE * REACH
    half = pi if distance <= reach else float(np.arcsin(reach / distance))
    angles = scan.angles
    near = np.abs(wrap_angles(angles - bearing)) <= half
    on = np.zeros(len(angles), dtype=bool)
    on[cluster.beams] = True
    past = near & ~on & (np.isposinf(scan.ranges) | (scan.ranges >= scan.range_max) | scan.valid)
    used = on | past
    ranges = np.where(scan.valid, scan.ranges, np.inf)[used]
    kinds = np.where(on[used], ON_ROBOT, PAST_ROBOT).astype(np.uint8)
    directions = np.stack([np.cos(angles[used]), np.sin(angles[used])], axis=1)
    return BeamsAround(directions, ranges, kinds, hypot(scan.noise(), OUTLINE))


def _first_poses(cluster: Cluster, body: Footprint) -> FloatArray:
    """(K, 3) poses on a coarse grid around the mean of the points, moved behind the surface."""
    mean = mean_of_points(cluster)
    ahead = mean / hypot(*mean)
    centre = mean + ahead * body.depth((body.narrowest + body.widest) / 2)
    steps = np.arange(-REACH, REACH + 1) * COARSE
    turns = np.zeros(1) if body.round else np.arange(0.0, pi, COARSE_TURN)
    along, aside, turn = (part.ravel() for part in np.meshgrid(steps, steps, turns, indexing="ij"))
    x, y = centre[0] + along * ahead[0] - aside * ahead[1], centre[1] + along * ahead[1] + aside * ahead[0]
    return np.stack([x, y, turn], axis=1)


def _halved(poses: FloatArray, spacing: float, turn: float) -> FloatArray:
    """Each of (K, 3) poses as those in the middle of its halves, both ways along each axis."""
    moves = [(-0.5, 0.5)] * 2 + [(-0.5, 0.5) if turn else (0.0,)]
    parts = np.stack(np.meshgrid(*moves, indexing="ij"), axis=-1).reshape(-1, 3)
    return np.asarray((poses[:, None] + parts * [spacing, spacing, turn]).reshape(-1, 3))


def _summary(
    scan: LaserScan, centres: FloatArray, weights: FloatArray, spacing: float, unexplained: float
) -> RobotPosition:
    """Mean and deviation of (K, 2) weighted places in the laser's frame, as the robot sees them."""
    places = scan.mounting.apply(centres)
    mean = weights @ places
    away = places - mean
    covariance = (away * weights[:, None]).T @ away + np.eye(2) * spacing**2 / 12
    distance = hypot(*mean)
    along = mean / distance
    across = np.array([-along[1], along[0]])
    return RobotPosition(
        distance,
        atan2(mean[1], mean[0]),
        sqrt(float(along @ covariance @ along)),
        sqrt(float(across @ covariance @ across)) / distance,
        unexplained,
    )
