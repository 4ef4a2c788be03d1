"""Whether the tags on a robot read backwards in an image: then a mirror shows the robot."""

from __future__ import annotations

import cv2
import numpy as np
from numpy.typing import NDArray

from algorithms.detection.detection import Picture

FAMILIES = (
    cv2.aruco.DICT_APRILTAG_36h11,
    cv2.aruco.DICT_APRILTAG_25h9,
    cv2.aruco.DICT_5X5_100,
    cv2.aruco.DICT_6X6_250,
    cv2.aruco.DICT_7X7_1000,
)  # whose tags have enough cells that nothing else is taken for one; few of 4 × 4 tell left from right surely
AROUND = 0.15  # of the box's width: the box may cut a tag's white edge off
FINER = 2  # a tag's cells are three pixels wide at 5 m; the reader wants more


def tags_read_backwards(picture: Picture, box: tuple[float, float, float, float]) -> bool:
    """Whether tags in a box can be read only after the image is flipped.

    box : left, top, right, bottom; pixels
    """
    height, width = picture.shape[:2]
    pad = AROUND * (box[2] - box[0])
    left, right = max(0, int(box[0] - pad)), min(width, int(box[2] + pad) + 1)
    top, bottom = max(0, int(box[1] - pad)), min(height, int(box[3] + pad) + 1)
    if right - left < 2 or bottom - top < 2:
        return False
    cut = cv2.cvtColor(np.ascontiguousarray(picture[top:bottom, left:right]), cv2.COLOR_RGB2GRAY)
    cut = cv2.resize(cut, None, fx=FINER, fy=FINER, interpolation=cv2.INTER_CUBIC)
    image = np.asarray(cut, dtype=np.uint8)
    return not _has_tags(image) and _has_tags(np.ascontiguousarray(image[:, ::-1]))


def _has_tags(image: NDArray[np.uint8]) -> bool:
    """Whether tags of any family are read in an (H, W) grey image."""
    parameters = cv2.aruco.DetectorParameters()
    # tags are small here, and a robot that is seen from the side has narrow ones
    parameters.adaptiveThreshWinSizeMax = 53
    parameters.adaptiveThreshWinSizeStep = 4
    parameters.polygonalApproxAccuracyRate = 0.06
    parameters.perspectiveRemovePixelPerCell = 8
    for family in FAMILIES:
        dictionary = cv2.aruco.getPredefinedDictionary(family)
        if cv2.aruco.ArucoDetector(dictionary, parameters).detectMarkers(image)[1] is not None:
            return True
    return False
