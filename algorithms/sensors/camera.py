"""Which pixel of a camera looks where: with a calibration, or by counting pixels as the paper does."""

from __future__ import annotations

from dataclasses import dataclass, field
from math import atan, atan2, isfinite, pi

import cv2
import numpy as np

from algorithms.common.errors import SettingError
from algorithms.common.pose import FloatArray, Pose2

MOST_PIXELS = 16_000_000  # of one image
LEAST_SIDE = 32  # pixels; a robot has more
COEFFICIENTS = (0, 4, 5, 8)  # how many a distortion may have, in the order of OpenCV and ROS
ROUNDS = 40  # of undoing distortion, at most
EXACT = 1e-6  # of the plane one metre ahead: less than a thousandth of a pixel
UNDONE = 0.5  # pixels, to which the edges must come back
MARGIN = 1.1  # times the half width of the field of view: further off the axis distortion may fold back


def check_image_size(width: int, height: int, what: str) -> None:
    """Raise SettingError for an image in which nothing could be found, or that is too large."""
    if min(width, height) < LEAST_SIDE or width * height > MOST_PIXELS:
        raise SettingError(
            f"{what} is {width} × {height} pixels; give an image of at least {LEAST_SIDE} pixels a side "
            f"and at most {MOST_PIXELS:,} in all"
        )


@dataclass(frozen=True)
class Camera:
    """A camera that looks horizontally from a robot.

    width, height  : of its images; pixels
    focal          : f_x, f_y; pixels. None: no calibration, bearings are counted in pixels from the middle
    centre         : c_x, c_y, where the axis meets the image; pixels
    distortion     : k_1, k_2, p_1, p_2, k_3 …, none, 4, 5 or 8 of them (ROS: plumb_bob, rational_polynomial)
    field_of_view  : horizontal, where there is no calibration; radians
    mounting       : T_robot_camera, x along the camera's axis, y to its left; metres, radians
    raises         : SettingError
    """

    width: int
    height: int
    focal: tuple[float, float] | None
    centre: tuple[float, float]
    distortion: tuple[float, ...] = ()
    field_of_view: float = 0.0
    mounting: Pose2 = field(default_factory=Pose2)

    def __post_init__(self) -> None:
        check_image_size(self.width, self.height, "the camera's image")
        if len(self.distortion) not in COEFFICIENTS:
            raise SettingError(
                f"the distortion has {len(self.distortion)} coefficients; give 4, 5 or 8, or none"
            )
        numbers = [*(self.focal or ()), *self.centre, *self.distortion, self.field_of_view]
        if not all(isfinite(number) for number in [*numbers, *self.mounting.array().tolist()]):
            raise SettingError("the camera's calibration must be finite numbers")
        if self.focal is None:
            if not 0 < self.field_of_view < pi:
                raise SettingError(
                    f"the field of view is {self.field_of_view:g} rad; it must lie between 0 and {pi:.4g}"
                )
        elif min(self.focal) <= 0:
            raise SettingError(f"the focal length is {min(self.focal):g} pixels; it must be positive")
        elif not all(
            -size < at < 2 * size for at, size in zip(self.centre, (self.width, self.height), strict=True)
        ):
            raise SettingError(f"the camera's axis meets the image at {self.centre}, far outside of it")
        else:
            self._check_edges()

    def _check_edges(self) -> None:
        """Raise SettingError where distortion folds the horizon within the image: nothing undoes that."""
        edges = np.array([[0.0, self.centre[1]], [self.width - 1.0, self.centre[1]]])
        with np.errstate(all="ignore"):
            plane = self.rays(edges)
            seen = self._distorted(plane) * np.array(self.focal) + np.array(self.centre)
            undone = np.abs(seen - edges).max() < UNDONE
        if not undone:
            raise SettingError(
                f"the distortion {list(self.distortion)} cannot be undone at the image's edges; "
                "calibrate with boards near the edges, too"
            )

    @staticmethod
    def counting_pixels(width: int, height: int, field_of_view: float, mounting: Pose2) -> Camera:
        """A camera of which only the field of view is known (horizontal, radians), section III-A."""
        middle = ((width - 1) / 2, (height - 1) / 2)
        return Camera(width, height, None, middle, (), field_of_view, mounting)

    @property
    def calibrated(self) -> bool:
        return self.focal is not None

    def matrix(self) -> FloatArray:
        """(3, 3) K of a calibrated camera; pixels."""
        assert self.focal is not None
        return np.array(
            [[self.focal[0], 0.0, self.centre[0]], [0.0, self.focal[1], self.centre[1]], [0.0, 0.0, 1.0]]
        )

    def rays(self, pixels: FloatArray) -> FloatArray:
        """(N, 2) pixels (column, row) of a calibrated camera as (N, 2) points of the plane one metre ahead:
        to the right and down, without distortion.
        """
        pixels = np.asarray(pixels, dtype=np.float64)
        plane = np.asarray((pixels - np.array(self.centre)) / np.array(self.focal))
        if not self.distortion:
            return plane
        target = plane
        for _ in range(ROUNDS):  # a fixed point: what is seen there, put back where it should be
            missed = target - self._distorted(plane)
            plane = plane + missed
            if float(np.abs(missed).max()) < EXACT:
                break
        return plane

    def _distorted(self, plane: FloatArray) -> FloatArray:
        """(N, 2) points of the plane one metre ahead, where the lens seems to show them."""
        points = np.ones((len(plane), 3))
        points[:, :2] = plane
        coefficients = np.array(self.distortion) if self.distortion else None
        seen, _ = cv2.projectPoints(points, np.zeros(3), np.zeros(3), np.eye(3), coefficients)
        return np.asarray(seen[:, 0], dtype=np.float64)

    def bearings(self, columns: FloatArray, row: float | None = None) -> FloatArray:
        """(N,) bearings of columns; radians, counter-clockwise from the camera's axis.

        row : at which they are taken; the middle unless given
        """
        columns = np.asarray(columns, dtype=np.float64)
        if self.focal is None:
            return np.asarray((self.centre[0] - columns) * (self.field_of_view / self.width))
        rows = np.full(len(columns), self.centre[1] if row is None else row)
        return np.asarray(-np.arctan(self.rays(np.stack([columns, rows], axis=1))[:, 0]))

    def columns(self, bearings: FloatArray) -> FloatArray:
        """(N,) columns in which bearings lie on the camera's horizon; NaN for what is not before it.

        bearings : (N,) radians, counter-clockwise from the camera's axis
        """
        bearings = np.asarray(bearings, dtype=np.float64)
        if self.focal is None:
            seen = np.abs(bearings) <= MARGIN * self.field_of_view / 2
            return np.where(seen, self.centre[0] - bearings * (self.width / self.field_of_view), np.nan)
        half = MARGIN * max(abs(ray) for ray in self._edges())
        seen = np.abs(bearings) < min(atan(half), 0.49 * pi)
        plane = np.stack([-np.tan(np.where(seen, bearings, 0.0)), np.zeros(len(bearings))], axis=1)
        return np.where(seen, self.centre[0] + self.focal[0] * self._distorted(plane)[:, 0], np.nan)

    def _edges(self) -> list[float]:
        """The first and the last column of the middle row on the plane one metre ahead."""
        row = self.centre[1]
        return [float(x) for x in self.rays(np.array([[0.0, row], [self.width - 1.0, row]]))[:, 0]]

    def degrees_wide(self) -> float:
        """Horizontal field of view; degrees."""
        if self.focal is None:
            return self.field_of_view * 180 / pi
        left, right = self._edges()
        return (atan2(right, 1.0) - atan2(left, 1.0)) * 180 / pi
