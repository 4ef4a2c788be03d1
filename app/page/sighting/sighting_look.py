"""One look at an image and a scan: what another process is asked for, and what it answers.

Whoever looks loads more than the page does, which is not to wait for it either.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import cv2
import numpy as np

from algorithms.common.pose import Pose2
from algorithms.detection.detection import Detection, Detector, Picture
from algorithms.detection.hog_grid import WindowShape
from algorithms.detection.map_walls import MapWalls
from algorithms.detection.model_file import shipped_model
from algorithms.detection.robot_sighting import LaserView, SightedRobots, sight, sight_by_tags
from algorithms.detection.svm_detector import DetectorModel, SvmDetector
from algorithms.detection.tag_detector import TagDetector
from algorithms.files.camera_picture import picture_from_bytes, picture_to_jpeg
from algorithms.maps.grid_map import GridMap
from algorithms.sensors.camera import Camera
from algorithms.sensors.laser_scan import LaserScan
from app.drawing.hog_picture import hog_picture
from app.model.merge_inputs import Upload
from app.model.sighting.look_settings import LookSettings

WIDEST = 960  # pixels of the picture that is shown
MOST_BOXES = 24  # that are looked at further: a person is to choose among them


@dataclass(frozen=True, eq=False)
class LookOrder:
    """What is to be looked at.

    camera   : None: the settings' field of view is all that is known of it
    scan     : None: the tag's size tells the distance
    model    : one's own detector
    grid     : map 1, whose walls are no robots; None: it is not asked
    observer : robot 1 in map 1, where that is known
    """

    picture: Upload
    camera: Camera | None
    scan: LaserScan | None
    model: DetectorModel | None
    settings: LookSettings
    grid: GridMap | None = None
    observer: Pose2 | None = None

    def same_as(self, other: LookOrder) -> bool:
        """Whether both would show the same."""
        same = all(
            getattr(self, name) is getattr(other, name)
            for name in ("picture", "camera", "scan", "model", "grid")
        )
        return same and self.settings == other.settings and self.observer == other.observer


@dataclass(frozen=True, eq=False)
class Look:
    """What was found.

    photo     : (h, w, 3) the image, made smaller where it is large
    width, height : of the image itself, in whose pixels boxes are
    view      : the laser in the camera's eyes; None without a scan
    gradients : of each box the detector's view and its gradients, two JPEGs of one size; none of tags
    more      : boxes that are less likely still, and were left out
    """

    photo: Picture
    width: int
    height: int
    camera: Camera
    view: LaserView | None
    seen: SightedRobots
    gradients: tuple[tuple[bytes, bytes], ...] = ()
    more: int = 0

    def choosing(self, number: int) -> Look:
        """The same with another box as the one that counts; by its number, from 0."""
        return replace(self, seen=self.seen.choosing(number))


def look(_: None, order: LookOrder) -> Look:
    """Find the robot; raises InputFileError, SettingError. Called in another process."""
    picture = picture_from_bytes(order.picture.name, order.picture.content)
    height, width = picture.shape[:2]
    camera = order.camera or Camera.counting_pixels(width, height, order.settings.field_of_view, Pose2())
    detector, shape = _detector(order)
    every = detector.detect(picture, camera)
    found = every[:MOST_BOXES]
    if order.scan is None:
        seen, view = sight_by_tags(found, camera, order.settings.body), None
    else:
        known = order.grid is not None and order.observer is not None
        walls = MapWalls(order.grid, order.observer) if known else None  # type: ignore[arg-type]
        seen = sight(found, order.scan, camera, order.settings.body, walls)
        view = LaserView.of(order.scan, camera, walls)
    drawn = () if shape is None else tuple(_gradients(picture, one, shape) for one in found)
    return Look(_smaller(picture), width, height, camera, view, seen, drawn, len(every) - len(found))


def _detector(order: LookOrder) -> tuple[Detector, WindowShape | None]:
    """Who finds robots, and the window that it slides; tags have none."""
    settings = order.settings
    if settings.finder == "tags":
        return TagDetector(settings.family, settings.tag_size or None), None
    own = order.model if settings.finder == "own" else None
    model = own or shipped_model()
    return SvmDetector(model, settings.least_probability), model.shape


def _gradients(picture: Picture, one: Detection, shape: WindowShape) -> tuple[bytes, bytes]:
    view, edges = hog_picture(picture, one, shape)
    return picture_to_jpeg(view), picture_to_jpeg(edges)


def _smaller(picture: Picture) -> Picture:
    height, width = picture.shape[:2]
    if width <= WIDEST:
        return picture
    size = (WIDEST, max(1, round(height * WIDEST / width)))
    return np.asarray(cv2.resize(picture, size, interpolation=cv2.INTER_AREA), np.uint8)
