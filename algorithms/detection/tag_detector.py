"""Fiducial tags (AprilTag, ArUco) on robots: a second detector behind the same interface."""

from __future__ import annotations

from math import acos, atan2, cos, hypot, sin, sqrt

import cv2
import numpy as np

from algorithms.common.errors import SettingError
from algorithms.common.pose import FloatArray
from algorithms.detection.detection import Detection, Picture, TagDistance
from algorithms.detection.footprint import Footprint
from algorithms.detection.range_bearing import RobotPosition
from algorithms.sensors.camera import Camera, check_image_size

FAMILIES = {
    "36h11": cv2.aruco.DICT_APRILTAG_36h11,
    "25h9": cv2.aruco.DICT_APRILTAG_25h9,
    "16h5": cv2.aruco.DICT_APRILTAG_16h5,
    "aruco-4x4": cv2.aruco.DICT_4X4_50,
    "aruco-5x5": cv2.aruco.DICT_5X5_100,
    "aruco-6x6": cv2.aruco.DICT_6X6_250,
    "aruco-7x7": cv2.aruco.DICT_7X7_1000,
    "aruco-original": cv2.aruco.DICT_ARUCO_ORIGINAL,
}
CORNER = 0.5  # pixels; standard deviation of a corner
TAG_SIZES = (0.005, 5.0)  # metres; what a tag's side may be
CERTAIN = 0.999  # probability that a decoded tag is one: its bits carry a check of their own


class TagDetector:
    """Finds tags of one family.

    family : a key of FAMILIES
    size   : side of a tag's black square; metres. With it, and a calibrated camera, the distance is known
    raises : SettingError
    """

    def __init__(self, family: str, size: float | None = None) -> None:
        if family not in FAMILIES:
            raise SettingError(f"there is no family of tags {family!r}, but {', '.join(FAMILIES)}")
        if size is not None and not TAG_SIZES[0] <= size <= TAG_SIZES[1]:
            raise SettingError(
                f"the tag's size is {size:g} m; it must be {TAG_SIZES[0]:g} to {TAG_SIZES[1]:g} m"
            )
        self.family = family
        self.size = size

    def detect(self, picture: Picture, camera: Camera | None = None) -> tuple[Detection, ...]:
        """Every tag, the largest first; its label is "tag 7" for number 7."""
        check_image_size(picture.shape[1], picture.shape[0], "the image")
        parameters = cv2.aruco.DetectorParameters()
        parameters.cornerRefinementMethod = cv2.aruco.CORNER_REFINE_SUBPIX
        dictionary = cv2.aruco.getPredefinedDictionary(FAMILIES[self.family])
        grey = cv2.cvtColor(picture, cv2.COLOR_RGB2GRAY)
        corners, numbers, _ = cv2.aruco.ArucoDetector(dictionary, parameters).detectMarkers(grey)
        if numbers is None:
            return ()
        found = []
        for quad, number in zip(corners, np.ravel(numbers).tolist(), strict=True):
            points = np.asarray(quad, dtype=np.float64).reshape(4, 2)
            (left, top), (right, bottom) = points.min(axis=0).tolist(), points.max(axis=0).tolist()
            far = self._distance(points, camera)
            found.append(Detection(left, top, right, bottom, CERTAIN, f"tag {number}", far, is_part=True))
        return tuple(sorted(found, key=lambda one: (-one.width, one.box())))

    def _distance(self, corners: FloatArray, camera: Camera | None) -> TagDistance | None:
        """Distance along the floor to a tag whose (4, 2) corners are known; pixels."""
        if self.size is None or camera is None or camera.focal is None:
            return None
        rays = camera.rays(corners)
        half = self.size / 2
        square = np.array([[-half, half, 0.0], [half, half, 0.0], [half, -half, 0.0], [-half, -half, 0.0]])
        points = rays.reshape(-1, 1, 2)
        good, turn, place = cv2.solvePnP(square, points, np.eye(3), None, flags=cv2.SOLVEPNP_IPPE_SQUARE)
        if not good or not np.isfinite(place).all():  # it has no answer for some tags that are seen squarely
            good, turn, place = cv2.solvePnP(square, points, np.eye(3), None, flags=cv2.SOLVEPNP_ITERATIVE)
        if not good or not np.isfinite(place).all():
            return None
        x, _, z = (float(value) for value in np.ravel(place))
        normal = cv2.Rodrigues(turn)[0][:, 2]
        facing = acos(min(1.0, abs(float(normal @ np.ravel(place))) / float(np.linalg.norm(place))))
        # of a square of so many pixels, each of two opposite edges lies a corner's σ off
        side = float(np.mean([hypot(*(corners[k] - corners[k - 1])) for k in range(4)]))
        distance = hypot(x, z)
        return TagDistance(distance, distance * CORNER / side / max(cos(facing), 0.2), facing)


def position_by_tag(one: Detection, camera: Camera, body: Footprint) -> RobotPosition | None:
    """Where the robot is that carries a tag of known size, from the image alone; None without a distance.

    The tag is on a board, and the centre behind it: half a side along the board's normal. To which side that
    points cannot be told of a tag that is seen almost squarely, so what it moves the centre sideways is σ.
    """
    if one.tag is None:
        return None
    column, row = one.middle
    bearing, beside = camera.bearings(np.array([column, column + CORNER]), row).tolist()
    behind = (body.length + body.width) / 4  # half of either side
    distance = one.tag.distance + behind * cos(one.tag.facing)
    sigma_range = hypot(one.tag.sigma, (body.widest - body.narrowest) / 2 / sqrt(12))
    aside = behind * sin(one.tag.facing) / sqrt(3)  # anywhere between both signs
    sigma_bearing = hypot(beside - bearing, aside / distance)
    centre = camera.mounting.apply(distance * np.array([cos(bearing), sin(bearing)]))
    away = hypot(*centre)
    return RobotPosition(
        away, atan2(centre[1], centre[0]), sigma_range, sigma_bearing * distance / away, unexplained=0.0
    )
