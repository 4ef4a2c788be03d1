"""Which pixel of a camera looks where."""

from __future__ import annotations

from math import atan, pi, radians

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from algorithms.common.errors import SettingError
from algorithms.common.pose import Pose2
from algorithms.sensors.camera import Camera, check_image_size

cameras = st.builds(
    lambda focal, cx, k1, k2: Camera(640, 480, (focal, focal * 1.01), (cx, 241.0), (k1, k2, 0.0, 0.0)),
    st.floats(500, 900),
    st.floats(290, 350),
    st.floats(-0.25, 0.1),
    st.floats(0.02, 0.1),
)


@given(cameras, st.lists(st.floats(0, 639), min_size=1, max_size=9))
def test_columns_undo_bearings(camera, columns):
    columns = np.array(columns)
    assert camera.columns(camera.bearings(columns)) == pytest.approx(columns, abs=0.01)


@given(cameras)
def test_further_to_the_right_is_further_clockwise(camera):
    assert (np.diff(camera.bearings(np.arange(0.0, 640.0, 8.0))) < 0).all()


@given(cameras, st.floats(0, 639), st.floats(120, 360))
def test_a_ray_goes_through_the_pixel_it_is_taken_from(camera, column, row):
    """What distortion does to a ray, written out as the pinhole model has it."""
    x, y = camera.rays(np.array([[column, row]]))[0]
    k1, k2, *_ = camera.distortion
    r2 = x * x + y * y
    grown = 1 + k1 * r2 + k2 * r2 * r2
    assert camera.focal[0] * x * grown + camera.centre[0] == pytest.approx(column, abs=0.01)
    assert camera.focal[1] * y * grown + camera.centre[1] == pytest.approx(row, abs=0.01)


def test_the_axis_is_bearing_zero_and_the_left_edge_is_positive():
    camera = Camera(640, 480, (320.0, 320.0), (320.0, 240.0))
    assert camera.bearings(np.array([320.0, 0.0])) == pytest.approx([0.0, pi / 4])
    assert camera.degrees_wide() == pytest.approx(np.degrees(pi / 4 + atan(319 / 320)))


def test_without_calibration_pixels_are_counted_from_the_middle():
    camera = Camera.counting_pixels(640, 480, radians(64), Pose2())
    assert not camera.calibrated
    assert np.degrees(camera.bearings(np.array([319.5, 219.5, 419.5]))) == pytest.approx([0.0, 10.0, -10.0])
    assert camera.columns(np.radians([0.0, 10.0])) == pytest.approx([319.5, 219.5])


def test_what_is_beside_or_behind_the_camera_has_no_column():
    for camera in (
        Camera(640, 480, (500.0, 500.0), (320.0, 240.0), (-0.3, 0.1, 0.0, 0.0)),
        Camera.counting_pixels(640, 480, 1.1, Pose2()),
    ):
        assert np.isnan(camera.columns(np.array([1.2, -1.2, pi, 3.0, -2.0]))).all()


@pytest.mark.parametrize(
    ("fault", "said"),
    [
        ({"focal": (0.0, 500.0)}, "must be positive"),
        ({"focal": (np.nan, 500.0)}, "finite"),
        ({"focal": None}, "field of view"),
        ({"centre": (5000.0, 240.0)}, "far outside"),
        ({"distortion": (0.1, 0.2, 0.3)}, "3 coefficients"),
        ({"distortion": (-3.0, 0.0, 0.0, 0.0)}, "cannot be undone"),
        ({"width": 4}, "at least"),
        ({"width": 100_000}, "at most"),
    ],
)
def test_a_calibration_that_cannot_be_is_refused(fault, said):
    good = {"width": 640, "height": 480, "focal": (500.0, 500.0), "centre": (320.0, 240.0)}
    with pytest.raises(SettingError, match=said):
        Camera(**{**good, **fault})


def test_an_image_of_usual_size_is_taken():
    check_image_size(1920, 1080, "the image")
