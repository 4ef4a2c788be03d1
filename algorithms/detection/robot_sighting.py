"""Boxes in an image and a laser scan together: which robot is seen, and where it is. Section III-A."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import nan, radians

import numpy as np

from algorithms.common.pose import FloatArray, Pose2
from algorithms.detection.detection import Detection
from algorithms.detection.footprint import Footprint
from algorithms.detection.map_walls import MapWalls
from algorithms.detection.mirror_images import is_mirror_image
from algorithms.detection.range_bearing import RobotPosition, position_of
from algorithms.detection.scan_clusters import BEFORE, Cluster, clusters_of
from algorithms.detection.tag_detector import position_by_tag
from algorithms.maps.grid_map import BoolArray
from algorithms.observations.observation import Observation
from algorithms.sensors.camera import Camera
from algorithms.sensors.laser_scan import LaserScan

LEAST_POINTS = 3  # of a robot; two say nothing of its width
LEAST_SHARE = 0.4  # of the cluster's width that lies in the box, or the other way round: it may be meant
LEAST_FIT = 0.4  # shared over joint width of cluster and box: a robot fills its box
SLACK = 0.25  # of a box's width, by which it may lie beside the robot: windows lie on a grid
RIVAL = 0.5  # times the best fit of a cluster and a box, from which another one could be meant as well
HIDDEN = 0.45  # of the narrowest width: what shows less of itself could be anything
MISFIT = 0.25  # share of the beams that a robot's outline may leave unexplained


@dataclass(frozen=True, eq=False)
class Sighted:
    """What became of one box.

    detection : the box
    cluster   : the laser points in its direction that stand before the background, if any do
    position  : where the robot is; None where the box is refused
    why_not   : the reason of the refusal, a clause; empty where it is none
    """

    detection: Detection
    cluster: Cluster | None
    position: RobotPosition | None
    why_not: str = ""


@dataclass(frozen=True, eq=False)
class SightedRobots:
    """All boxes of one image, and the one that is the sighting.

    sighted : every box, the likeliest first
    chosen  : index of the one that counts; None where there is none
    reason  : why there is none, and what would help; empty where there is one
    """

    sighted: tuple[Sighted, ...]
    chosen: int | None
    reason: str = ""

    @property
    def position(self) -> RobotPosition | None:
        return None if self.chosen is None else self.sighted[self.chosen].position

    def choosing(self, number: int) -> SightedRobots:
        """The same boxes with the one of this index as the one that counts, unless it is refused."""
        one = self.sighted[number]
        return SightedRobots(self.sighted, number if one.position is not None else None, one.why_not)


@dataclass(frozen=True, eq=False)
class LaserView:
    """A laser scan in the eyes of a camera on the same robot.

    columns   : (N,) columns in which each beam's point lies, NaN outside the view; pixels
    explained : (N,) beams that hit a wall of the robot's map
    """

    scan: LaserScan
    columns: FloatArray
    explained: BoolArray
    clusters: tuple[Cluster, ...]

    @staticmethod
    def of(scan: LaserScan, camera: Camera, walls: MapWalls | None) -> LaserView:
        in_camera = camera.mounting.inverse().apply(scan.points())
        columns = camera.columns(np.arctan2(in_camera[:, 1], in_camera[:, 0]))
        none = np.zeros(len(columns), dtype=bool)
        explained = none if walls is None else walls.explain(scan)
        return LaserView(scan, columns, explained, tuple(clusters_of(scan, explained)))


def sight(
    found: Sequence[Detection],
    scan: LaserScan,
    camera: Camera,
    body: Footprint,
    walls: MapWalls | None = None,
    pick: int | None = None,
) -> SightedRobots:
    """Find the robot that a detector's boxes and a scan show together.

    walls : of the observer's own map: its points are taken out, and what lies behind them is refused
    pick  : index of the box that is the robot; the only one that laser and map confirm unless given
    """
    view = LaserView.of(scan, camera, walls)
    sighted = tuple(_sighted(one, view, camera, body, walls) for one in found)
    if pick is not None:
        return SightedRobots(sighted, None).choosing(pick)
    good = [k for k, one in enumerate(sighted) if one.position is not None]
    if not good:
        return SightedRobots(sighted, None, _nothing(sighted))
    first = sighted[good[0]].cluster
    others = [k for k in good[1:] if sighted[k].cluster is not first]
    if others:
        count = 1 + len({id(sighted[k].cluster) for k in others})
        reason = f"{count} robots are in view; choose the box of the one that is meant"
        return SightedRobots(sighted, None, reason)
    return SightedRobots(sighted, good[0])


def sight_by_tags(
    found: Sequence[Detection], camera: Camera, body: Footprint, pick: int | None = None
) -> SightedRobots:
    """Find the robot whose tag is seen, without a laser: the size of the tag gives the distance."""
    sighted = []
    for one in found:
        position = position_by_tag(one, camera, body)
        why_not = "" if position else "its distance is not known: give the laser's scan, or the tag's size"
        sighted.append(Sighted(one, None, position, why_not))
    good = [k for k, one in enumerate(sighted) if one.position is not None]
    if pick is not None:
        return SightedRobots(tuple(sighted), None).choosing(pick)
    if not good:
        return SightedRobots(tuple(sighted), None, _nothing(sighted))
    first = sighted[good[0]].position
    assert first is not None
    places = [one.position.point() for one in sighted if one.position is not None]
    if any(float(np.hypot(*(place - first.point()))) > body.widest for place in places):
        return SightedRobots(
            tuple(sighted), None, "several robots are in view; choose the box of the one meant"
        )
    return SightedRobots(tuple(sighted), good[0])


def observation_of(
    seen: RobotPosition, observer: Pose2, observed: FloatArray, observed_heading: float | None = None
) -> Observation:
    """The observation that a sighting makes, with where both robots stood in their own maps.

    observer : of the robot that saw, in its map; observed : (2,) of the one that was seen, in its own; metres
    """
    x, y = (float(value) for value in observed)
    numbers = seen.range, seen.bearing, seen.sigma_range, seen.sigma_bearing
    distance, bearing, sigma_range, sigma_bearing = (round(number, 6) for number in numbers)
    return Observation(observer, x, y, distance, bearing, observed_heading, sigma_range, sigma_bearing)


def _nothing(sighted: Sequence[Sighted]) -> str:
    if not sighted:
        return "no robot is found in the image; come nearer, make light, or train the detector on your robot"
    best = sighted[0]
    return f"the likeliest box ({min(best.detection.probability, 0.999):.1%}) is refused: {best.why_not}"


def _sighted(
    one: Detection, view: LaserView, camera: Camera, body: Footprint, walls: MapWalls | None
) -> Sighted:
    """What laser and map say of one box."""
    if one.is_mirrored:
        return Sighted(one, None, None, "the tag on the robot reads backwards: a mirror shows it")
    candidates = [cluster for cluster in view.clusters if _in_box(cluster, one, view, camera)]
    if not candidates:
        return Sighted(one, None, None, _no_cluster(one, view))
    refused: list[Sighted] = []
    taken: list[Sighted] = []
    for cluster in candidates:
        why_not = shape_fault(cluster, view.scan, body)
        if not why_not and _fit(Sighted(one, cluster, None), view, camera) < LEAST_FIT:
            why_not = "what the laser sees there is not as wide as the box, or lies beside it"
        position = None if why_not else position_of(cluster, view.scan, body)
        if position is not None and position.unexplained > MISFIT:
            share = f"{position.unexplained:.0%} of the beams do not fit"
            why_not = f"what the laser sees there does not have the shape of the robot ({share})"
        if not why_not:
            why_not = _mirrored(cluster, view.scan) if walls is None else walls.deny(cluster, view.scan)
        if why_not or position is None:
            refused.append(Sighted(one, cluster, None, why_not))
        else:
            taken.append(Sighted(one, cluster, position))
    if not taken:
        return max(refused, key=lambda seen: _fit(seen, view, camera))
    best, *others = sorted(taken, key=lambda seen: -_fit(seen, view, camera))
    if others and _fit(others[0], view, camera) > RIVAL * _fit(best, view, camera):
        why_not = f"the laser sees {len(taken)} things of a robot's size in the direction of the box"
        return Sighted(one, None, None, why_not)
    return best


def _mirrored(cluster: Cluster, scan: LaserScan) -> str:
    """Why a cluster may be a mirror image, told without a map; empty where nothing says so."""
    if not is_mirror_image(cluster, scan):
        return ""
    return "the laser sees the same things before the wall there: a mirror shows it, or give the robot's map"


def _no_cluster(one: Detection, view: LaserView) -> str:
    """Why no cluster lies in a box."""
    with np.errstate(invalid="ignore"):
        inside = (view.columns >= one.left) & (view.columns <= one.right)
    if not inside.any():
        return "the laser has no points in its direction"
    if view.explained[inside].mean() > 0.5:
        return "the map has a wall there, and the laser sees nothing before it"
    return (
        "the laser sees no step in depth there: a picture on a wall, or a robot that stands against something"
    )


def _in_box(cluster: Cluster, one: Detection, view: LaserView, camera: Camera) -> bool:
    """Whether a cluster and a box lie in one direction."""
    low, high = _columns(cluster, view, camera)
    slack = SLACK * one.width
    shared = min(high, one.right + slack) - max(low, one.left - slack)
    return shared >= LEAST_SHARE * min(high - low, one.width)


def _fit(seen: Sighted, view: LaserView, camera: Camera) -> float:
    """How well the columns of a cluster and a box cover one another: shared over joint, of a box that frames
    a part alone, over its own; 0 … 1.
    """
    assert seen.cluster is not None
    low, high = _columns(seen.cluster, view, camera)
    left, right = seen.detection.left, seen.detection.right
    shared = max(0.0, min(high, right) - max(low, left))
    return shared / (right - left if seen.detection.is_part else max(high, right) - min(low, left))


def _columns(cluster: Cluster, view: LaserView, camera: Camera) -> tuple[float, float]:
    """First and last column of a cluster, half a beam added on both sides; NaN outside the view; pixels."""
    columns = view.columns[cluster.beams]
    columns = columns[np.isfinite(columns)]
    if not len(columns):
        return nan, nan
    half_beam = 0.5 * abs(view.scan.angle_increment) * camera.width / radians(camera.degrees_wide())
    return float(columns.min()) - half_beam, float(columns.max()) + half_beam


def shape_fault(cluster: Cluster, scan: LaserScan, body: Footprint) -> str:
    """Why a cluster cannot be a robot of this size; empty where it can be."""
    points = cluster.points
    if len(points) < LEAST_POINTS:
        return f"the laser has {len(points)} points there, too few to measure a robot"
    spacing = float(np.hypot(*points.T).min()) * abs(scan.angle_increment)
    wide = float(np.hypot(*(points - points[0]).T).max()) + spacing
    if wide > body.widest + 2 * spacing + 6 * scan.noise():
        return (
            f"the laser sees no step in depth around it, but something {wide:.2f} m wide: a picture on a "
            f"wall, or a robot that touches something (a robot is at most {body.widest:.2f} m)"
        )
    if cluster.first == cluster.last == BEFORE:
        return "what the laser sees there lies behind other things on both sides"
    if wide < HIDDEN * body.narrowest:
        return f"only {wide:.2f} m of a thing are seen there; the rest, if there is one, is hidden"
    return ""
