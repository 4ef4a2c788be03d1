"""Pictures of robots with tags, and the other files of a sighting, drawn without a simulator."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import cv2
import numpy as np
from robot_scans import scan_of

from algorithms.common.pose import Pose2
from algorithms.detection.footprint import Footprint
from algorithms.detection.tag_detector import FAMILIES
from algorithms.files.camera_file import camera_to_bytes
from algorithms.files.camera_picture import picture_to_png
from algorithms.files.scan_file import scan_to_bytes
from algorithms.sensors.camera import Camera

CAMERA = Camera(640, 480, (520.0, 520.0), (319.5, 239.5))
SIZE = 0.2  # metres; a tag's side
NEAR, ASIDE = (2.5, 0.3), (2.2, -0.7)  # middles of robots before the camera, which a box each shows
Tag = tuple[int, float, float, float]


def picture_of(tags: Sequence[Tag], camera: Camera = CAMERA, family: str = "36h11") -> np.ndarray:
    """Tags, each (number, x ahead, y to the left, turn), at the height of the camera."""
    picture = np.full((camera.height, camera.width, 3), 150, np.uint8)
    dictionary = cv2.aruco.getPredefinedDictionary(FAMILIES[family])
    for number, x, y, turn in tags:
        marker = cv2.aruco.generateImageMarker(dictionary, number, 200)
        board = np.full((280, 280), 255, np.uint8)
        board[40:240, 40:240] = marker
        half = SIZE * 0.7
        corners = np.array([[-half, half], [half, half], [half, -half], [-half, -half]])
        c, s = np.cos(turn), np.sin(turn)
        # to the right in the image is y less
        space = [(x + s * u, y - c * u, v) for u, v in corners]
        pixels = [
            (camera.centre[0] - camera.focal[0] * b / a, camera.centre[1] - camera.focal[1] * h / a)
            for a, b, h in space
        ]
        source = np.array([[0, 0], [279, 0], [279, 279], [0, 279]], np.float32)
        warp = cv2.getPerspectiveTransform(source, np.array(pixels, np.float32))
        size = (camera.width, camera.height)
        drawn = cv2.warpPerspective(board, warp, size, flags=cv2.INTER_AREA)
        mask = cv2.warpPerspective(np.full_like(board, 255), warp, size)
        picture[mask > 127] = drawn[mask > 127][:, None]
    return cv2.GaussianBlur(picture, (0, 0), 0.6)


def sighting_files(*robots: tuple[float, float], on_wall: bool = False) -> dict[str, bytes]:
    """An image, a calibration and a scan of robots that show their front; tags 0, 1 … in their order.

    on_wall : they are pictures on a round wall, and stand nowhere
    """
    body = Footprint()
    front = body.length / 2
    tags = [(number, x - front, y, 0.0) for number, (x, y) in enumerate(robots)]
    stand = () if on_wall else tuple(Pose2(x, y) for x, y in robots)
    scan = scan_of(body, *stand, wall=2.3 if on_wall else 8.0, noise=0.01)
    return {
        "seen.png": picture_to_png(picture_of(tags)),
        "camera.yaml": camera_to_bytes(CAMERA),
        "scan.yaml": scan_to_bytes(scan),
    }


def laid_down(files: dict[str, bytes], folder: Path) -> list[Path]:
    """The files in a folder."""
    paths = [folder / name for name in files]
    for path, content in zip(paths, files.values(), strict=True):
        path.write_bytes(content)
    return paths
