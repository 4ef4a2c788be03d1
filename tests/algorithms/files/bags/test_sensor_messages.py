"""Images, calibrations and scans in recordings: the same as from files, and what is refused."""

from __future__ import annotations

from dataclasses import replace
from math import pi

import cv2
import numpy as np
import pytest
from bags import (
    BEGIN,
    SECOND,
    camera_message,
    image_message,
    robot_frames,
    scan_message,
    sensor_frames,
    transform_message,
    write_bag,
)

from algorithms.common.errors import InputFileError
from algorithms.common.pose import Pose2, pose_error
from algorithms.files.bags.bag_reader import open_bag
from algorithms.files.bags.sensor_messages import SensorChoice, sensor_view
from algorithms.files.camera_picture import picture_to_png
from algorithms.sensors.camera import Camera
from algorithms.sensors.laser_scan import LaserScan

STOOD = Pose2(12.5, -3.0, 2.5)
CAMERA = Camera(
    64, 48, (60.0, 61.0), (31.0, 24.5), (-0.1, 0.01, 0.0, 0.0, 0.0), mounting=Pose2(0.1, 0.02, 0.3)
)
SCAN = LaserScan(-1.0, 0.1, np.linspace(1, 3, 20), 0.1, 12.0, Pose2(-0.05, 0.0, 3.0))
PICTURE = np.random.default_rng(5).integers(0, 256, (48, 64, 3)).astype(np.uint8)
AT = 20.0


def messages(picture=None):
    """A robot that stands and looks, as its sensors and transforms tell."""
    return [
        *sensor_frames(CAMERA.mounting, SCAN.mounting),
        *robot_frames(STOOD, AT),
        picture or image_message(PICTURE, AT),
        camera_message(CAMERA, AT),
        scan_message(SCAN, AT + 0.05),
    ]


def view(folder, told, choice=None, kind="mcap", at=AT):
    with open_bag(write_bag(folder, "bag", kind, told)) as bag:
        return sensor_view(bag, BEGIN + round(at * SECOND), choice or SensorChoice())


def near(a, b):
    return pose_error(a, b, np.array([1.0, 1.0])) == pytest.approx((0, 0), abs=1e-6)


@pytest.mark.parametrize("kind", ["ros1", "db3", "mcap"])
def test_what_a_recording_holds_is_what_files_would_say(tmp_path, kind):
    seen = view(tmp_path, messages(), kind=kind)
    assert np.array_equal(seen.picture, PICTURE)
    assert near(seen.robot, STOOD)
    assert near(seen.camera.mounting, CAMERA.mounting)
    assert replace(seen.camera, mounting=CAMERA.mounting) == CAMERA
    assert near(seen.scan.mounting, SCAN.mounting)
    assert np.allclose(seen.scan.points(), SCAN.points(), atol=1e-5)
    assert seen.time == BEGIN + round(AT * SECOND)


def test_a_laser_that_hangs_upside_down_sees_the_same_points(tmp_path):
    """Its frame is turned by 180° about its axis ahead, and its beams go round the other way."""
    upside_down = transform_message("base_link", "laser", 0.0, (0, 0, 0.5), (1, 0, 0, 0), "/tf_static")
    hung = replace(SCAN, angle_min=-SCAN.angle_min, angle_increment=-SCAN.angle_increment)
    told = [each for each in messages() if each.type != scan_message(SCAN, 0.0).type]
    told[2] = upside_down
    seen = view(tmp_path, [*told, scan_message(hung, AT)])
    assert np.allclose(seen.scan.points(), replace(SCAN, mounting=Pose2()).points(), atol=1e-5)


def test_a_camera_whose_frame_is_that_of_its_body_looks_along_x(tmp_path):
    told = messages()
    told[1] = transform_message("camera", "camera_optical", 0.0, (0, 0, 0), (0, 0, 0, 1), "/tf_static")
    assert near(view(tmp_path, told).camera.mounting, CAMERA.mounting)


def test_a_camera_that_looks_up_is_refused_unless_its_mounting_is_given(tmp_path):
    told = messages()
    up = (0.0, -np.sin(pi / 12), 0.0, np.cos(pi / 12))
    told[0] = transform_message("base_link", "camera", 0.0, (0, 0, 0.3), up, "/tf_static")
    with pytest.raises(InputFileError, match=r"camera is tilted by 30°"):
        view(tmp_path, told)
    given = Pose2(0.2, 0.0, 0.0)
    (tmp_path / "again").mkdir()
    assert view(tmp_path / "again", told, SensorChoice(camera_mounting=given)).camera.mounting == given


def encoded(name, data, channels=1, **more):
    message = image_message(PICTURE, AT)
    step = 64 * channels
    return replace(
        message, fields={**message.fields, "encoding": name, "step": step, "data": data.ravel(), **more}
    )


def padded(picture):
    """Rows that are longer than what is used of them."""
    return np.concatenate([picture.reshape(48, -1), np.full((48, 13), 7, np.uint8)], axis=1)


GREY = PICTURE[..., 0]
SIXTEEN = GREY.astype(np.uint16) * 256 + 77


@pytest.mark.parametrize(
    ("message", "expected"),
    [
        (encoded("bgr8", PICTURE[..., ::-1], 3), PICTURE),
        (encoded("rgba8", np.dstack([PICTURE, GREY]), 4), PICTURE),
        (encoded("bgra8", np.dstack([PICTURE[..., ::-1], GREY]), 4), PICTURE),
        (encoded("mono8", GREY), np.dstack([GREY] * 3)),
        (encoded("mono16", SIXTEEN.astype(">u2").view(np.uint8), 2, is_bigendian=1), np.dstack([GREY] * 3)),
        (encoded("mono16", SIXTEEN.astype("<u2").view(np.uint8), 2, is_bigendian=0), np.dstack([GREY] * 3)),
        (encoded("rgb8", padded(PICTURE), 3, step=3 * 64 + 13), PICTURE),
    ],
)
def test_every_encoding_gives_the_same_colours(tmp_path, message, expected):
    assert np.array_equal(view(tmp_path, messages(message)).picture, expected)


def test_a_bayer_pattern_of_one_colour_gives_that_colour(tmp_path):
    colour = {"R": 200, "G": 120, "B": 40}
    for name in ("rggb", "bggr", "gbrg", "grbg"):
        tile = np.array([colour[letter.upper()] for letter in name], np.uint8).reshape(2, 2)
        (tmp_path / name).mkdir()
        told = messages(encoded(f"bayer_{name}8", np.tile(tile, (24, 32))))
        inner = view(tmp_path / name, told).picture[4:-4, 4:-4]
        assert (inner == [200, 120, 40]).all(), name


def test_a_compressed_image_is_decoded_and_chosen_beside_the_depth_image(tmp_path):
    topic, kind = "/camera/image_raw/compressed", "sensor_msgs/msg/CompressedImage"
    head = image_message(PICTURE, AT).fields["header"]
    data = np.frombuffer(picture_to_png(PICTURE), np.uint8)
    packed = replace(
        image_message(PICTURE, AT),
        topic=topic,
        type=kind,
        fields={"header": head, "format": "png", "data": data},
    )
    depth = image_message(PICTURE // 2, AT, "/camera/depth/image_raw")
    assert np.array_equal(view(tmp_path, [*messages(packed), depth]).picture, PICTURE)


@pytest.mark.parametrize(
    ("message", "found"),
    [
        (encoded("32FC1", PICTURE, 3), "encoding 32FC1"),
        (encoded("rgb8", PICTURE[:10], 3), "1,920 bytes, 192 a row, for 48 rows"),
        (encoded("rgb8", PICTURE, 3, step=10), "10 a row, for 48 rows of 192"),
        (encoded("rgb8", PICTURE, 3, width=8), "8 × 48 pixels"),
    ],
)
def test_an_image_that_is_none_is_refused(tmp_path, message, found):
    with pytest.raises(InputFileError, match=found):
        view(tmp_path, messages(message))


def test_a_moment_without_an_image_names_the_nearest_and_two_cameras_ask_for_a_choice(tmp_path):
    with pytest.raises(InputFileError, match=r"within 0\.5 s of 25\.00 s .* one is at 20\.00 s"):
        view(tmp_path, messages(), at=25.0)
    (tmp_path / "two").mkdir()
    told = [*messages(), image_message(PICTURE, AT, "/back/image_raw")]
    with pytest.raises(InputFileError, match="/back/image_raw, /camera/image_raw; say which topic"):
        view(tmp_path / "two", told)
    (tmp_path / "chosen").mkdir()
    chosen = view(tmp_path / "chosen", told, SensorChoice(image="camera/image_raw"))
    assert np.array_equal(chosen.picture, PICTURE)


def test_a_calibration_that_was_sent_once_holds_and_a_scan_of_another_moment_does_not(tmp_path):
    image, info, scan = messages()[-3:]
    frames = messages()[:-3]
    once = replace(info, at=0.0)
    assert view(tmp_path, [*frames, image, once, scan]).camera.focal == CAMERA.focal
    (tmp_path / "late").mkdir()
    late = [*frames, image, info, replace(scan, at=AT + 0.3)]
    with pytest.raises(InputFileError, match=r"/scan within 0\.2 s of 20\.00 s .* one is at 20\.30 s"):
        view(tmp_path / "late", late)
    (tmp_path / "without").mkdir()
    assert view(tmp_path / "without", late, SensorChoice(scan=None)).scan is None


def test_the_scan_is_the_one_nearest_to_the_image_and_not_to_the_time_that_is_asked_for(tmp_path):
    other = replace(SCAN, ranges=SCAN.ranges + 1)
    told = [*messages(), scan_message(other, AT + 0.3)]
    assert np.allclose(view(tmp_path, told, at=AT + 0.4).scan.ranges, SCAN.ranges, atol=1e-5)


def test_the_calibration_beside_the_images_is_taken(tmp_path):
    other = replace(CAMERA, focal=(99.0, 99.0))
    told = [*messages(), camera_message(other, AT, "/back/camera_info")]
    assert view(tmp_path, told).camera.focal == CAMERA.focal


def test_opencv_is_asked_for_the_patterns_by_their_first_rows():
    """Its older names for them begin at the second row and column: a mistake that changes red and blue."""
    assert cv2.COLOR_BayerRGGB2RGB == cv2.COLOR_BayerBG2RGB
