"""Camera images, calibrations and laser scans of a recording, as their files would give them."""

from __future__ import annotations

import json
from dataclasses import dataclass, replace
from math import acos, asin, atan2, degrees
from typing import Any

import cv2
import numpy as np

from algorithms.common.display_text import show_hidden
from algorithms.common.errors import InputFileError, SettingError
from algorithms.common.pose import FloatArray, Pose2
from algorithms.files.bags.bag_path import NANO
from algorithms.files.bags.bag_reader import BagReader, BagTopic
from algorithms.files.bags.frame_tree import frames_around, stamp_of
from algorithms.files.bags.message_types import CAMERA_INFO, IMAGES, SCAN
from algorithms.files.camera_file import camera_from_bytes
from algorithms.files.camera_picture import PictureArray, picture_from_bytes
from algorithms.files.scan_file import scan_from_bytes
from algorithms.sensors.camera import Camera, check_image_size
from algorithms.sensors.laser_scan import LaserScan

LONGEST_WAIT = NANO // 2  # nanoseconds from the time that is asked for to an image
LONGEST_OFF = NANO // 5  # nanoseconds from an image to the scan that is of the same moment
MOST_TILT = 5.0  # degrees, of a camera or a laser on its robot

# By encoding of ROS: bytes a pixel, and how OpenCV makes red, green, blue of them; None: they are that.
COLOURS: dict[str, tuple[int, int | None]] = {
    "rgb8": (3, None),
    "bgr8": (3, cv2.COLOR_BGR2RGB),
    "8UC3": (3, cv2.COLOR_BGR2RGB),
    "rgba8": (4, cv2.COLOR_RGBA2RGB),
    "bgra8": (4, cv2.COLOR_BGRA2RGB),
    "8UC4": (4, cv2.COLOR_BGRA2RGB),
    "mono8": (1, cv2.COLOR_GRAY2RGB),
    "8UC1": (1, cv2.COLOR_GRAY2RGB),
    "bayer_rggb8": (1, cv2.COLOR_BayerRGGB2RGB),
    "bayer_bggr8": (1, cv2.COLOR_BayerBGGR2RGB),
    "bayer_gbrg8": (1, cv2.COLOR_BayerGBRG2RGB),
    "bayer_grbg8": (1, cv2.COLOR_BayerGRBG2RGB),
    "yuv422": (2, cv2.COLOR_YUV2RGB_UYVY),
    "uyvy": (2, cv2.COLOR_YUV2RGB_UYVY),
    "yuv422_yuy2": (2, cv2.COLOR_YUV2RGB_YUYV),
    "yuyv": (2, cv2.COLOR_YUV2RGB_YUYV),
}


@dataclass(frozen=True)
class SensorChoice:
    """Which sensors of a robot are asked for.

    image, camera_info, scan : topics; an empty one is chosen where there is only one of its kind; None: not
                               wanted
    camera_mounting, laser_mounting : T_robot_camera, T_robot_laser where the recording does not say them
    map_frame, base_frame : of the robot's map, and of the robot
    """

    image: str = ""
    camera_info: str | None = ""
    scan: str | None = ""
    camera_mounting: Pose2 | None = None
    laser_mounting: Pose2 | None = None
    map_frame: str = "map"
    base_frame: str = "base_link"


@dataclass(frozen=True, eq=False)
class SensorView:
    """What a robot's sensors said at one moment.

    name    : of the recording and the topic of its images
    time    : of the image, by the robot's clock; nanoseconds
    picture : (H, W, 3) uint8 red, green, blue; row 0 at the top
    camera  : with its mounting; None where no calibration was recorded
    scan    : with its mounting; None where none was recorded
    robot   : T_map_robot; metres, radians
    """

    name: str
    time: int
    picture: PictureArray
    camera: Camera | None
    scan: LaserScan | None
    robot: Pose2


def sensor_view(bag: BagReader, at: int, choice: SensorChoice) -> SensorView:
    """What was recorded nearest to a time of the recorder's clock, and where the robot was then; nanoseconds.

    raises : InputFileError
    """
    topic = _image_topic(bag, choice.image)
    seen, image = _nearest(bag, topic, at, LONGEST_WAIT)
    name, time = f"{bag.path}#{topic.name}", stamp_of(image.header)
    frames = frames_around(bag, time)
    camera = scan = None
    info_topic = _camera_info_topic(bag, choice.camera_info, topic)
    if info_topic is not None:
        info = _standing(bag, info_topic, seen)
        on_robot = choice.camera_mounting
        if on_robot is None:
            on_robot = _of_camera(bag, frames.transform(choice.base_frame, info.header.frame_id, time))
        camera = replace(camera_of(f"{bag.path}#{info_topic.name}", info), mounting=on_robot)
    scan_topic = _topic(bag, choice.scan, (SCAN,), "laser scans")
    if scan_topic is not None:
        _, message = _nearest(bag, scan_topic, seen, LONGEST_OFF)
        scan = scan_of(f"{bag.path}#{scan_topic.name}", message)
        if choice.laser_mounting is None:
            measured, frame = stamp_of(message.header), message.header.frame_id
            scan = _mounted(bag, scan, frames.transform(choice.base_frame, frame, measured))
        else:
            scan = replace(scan, mounting=choice.laser_mounting)
    robot = frames.pose(choice.map_frame, choice.base_frame, time)
    return SensorView(name, time, picture_of(name, image), camera, scan, robot)


def _image_topic(bag: BagReader, name: str) -> BagTopic:
    """That of the camera's images; depth images show no robot, and a compressed one is the same image."""
    if not name:
        colours = [topic for topic in bag.of_type(*IMAGES) if "depth" not in topic.name.lower()]
        cameras = {topic.name.removesuffix("/compressed") for topic in colours}
        if colours and len(cameras) == 1:
            return colours[0]
    topic = _topic(bag, name, IMAGES, "camera images")
    if topic is None:
        raise InputFileError(bag.path, "holds no camera images", "record them, or give --image FILE")
    return topic


def _camera_info_topic(bag: BagReader, name: str | None, image: BagTopic) -> BagTopic | None:
    """That beside the images, where there are several."""
    beside = f"{image.name.removesuffix('/compressed').rpartition('/')[0]}/camera_info"
    if name == "" and any(topic.name == beside for topic in bag.of_type(CAMERA_INFO)):
        name = beside
    return _topic(bag, name, (CAMERA_INFO,), "calibrations of cameras")


def _topic(bag: BagReader, name: str | None, types: tuple[str, ...], what: str) -> BagTopic | None:
    """The topic of this name, or the only one of these types; None where there is none, or none is wanted."""
    if name is None:
        return None
    found = bag.of_type(*types)
    listed = ", ".join(topic.name for topic in found)
    if name:
        for topic in found:
            if topic.name.strip("/") == name.strip("/"):
                return topic
        raise InputFileError(bag.path, f"has no {what} on {name}", f"they are on: {listed or 'no topic'}")
    if len(found) > 1:
        raise InputFileError(bag.path, f"has {what} on {listed}", "say which topic")
    return found[0] if found else None


def _nearest(bag: BagReader, topic: BagTopic, at: int, most: int) -> tuple[int, Any]:
    """Time and message of the one nearest to a time, at most so far from it; nanoseconds."""
    found: tuple[int, Any] | None = None
    for _, time, message in bag.messages([topic], at - most, at + most + 1):
        if found is None or abs(time - at) < abs(found[0] - at):
            found = time, message
    if found is not None:
        return found
    before = bag.last(topic, at) or bag.first(topic)
    hint = "" if before is None else f"; one is at {bag.seconds(before[0]):.2f} s"
    when = f"within {most / NANO:g} s of {bag.seconds(at):.2f} s after the recording began"
    raise InputFileError(bag.path, f"has nothing on {topic.name} {when}{hint}", "ask for another time")


def _standing(bag: BagReader, topic: BagTopic, at: int) -> Any:
    """The message that holds at a time, of a topic on which they hold until the next: of a calibration."""
    found = bag.last(topic, at) or bag.first(topic)
    assert found is not None, "a topic that is chosen has a message"
    return found[1]


def picture_of(name: str, message: Any) -> PictureArray:
    """(H, W, 3) uint8 red, green, blue; row 0 at the top."""
    data = np.asarray(message.data, dtype=np.uint8)
    if hasattr(message, "format"):
        return picture_from_bytes(name, data.tobytes())
    width, height, step = int(message.width), int(message.height), int(message.step)
    try:
        check_image_size(width, height, "its image")
    except SettingError as error:
        raise InputFileError(name, *str(error).split("; ", 1)) from error
    encoding = str(message.encoding)
    if encoding == "mono16":  # the upper byte of each grey
        first = 0 if message.is_bigendian else 1
        return np.repeat(_rows(name, data, height, step, 2 * width)[:, first::2, None], 3, axis=2)
    if encoding not in COLOURS:
        found = f"its images are of the encoding {show_hidden(encoding)[:40]}"
        raise InputFileError(name, found, f"give one of {', '.join(COLOURS)}, mono16")
    channels, conversion = COLOURS[encoding]
    pixels = _rows(name, data, height, step, width * channels).reshape(height, width, channels)
    if conversion is None:
        return pixels
    return np.asarray(
        cv2.cvtColor(np.ascontiguousarray(pixels if channels > 1 else pixels[..., 0]), conversion)
    )


def _rows(name: str, data: PictureArray, height: int, step: int, used: int) -> PictureArray:
    """(height, used) bytes of rows that are ``step`` apart."""
    if step < used or data.size < height * step:
        found = f"its image has {data.size:,} bytes, {step:,} a row, for {height} rows of {used:,}"
        raise InputFileError(name, found, "the message is damaged; record it again")
    return np.ascontiguousarray(data[: height * step].reshape(height, step)[:, :used])


def camera_of(name: str, info: Any) -> Camera:
    """A calibration without its mounting, by the checks that files have."""
    k, d = (getattr(info, key, None) if hasattr(info, key) else getattr(info, key.upper()) for key in "kd")
    text = (
        f"width: {int(info.width)}\nheight: {int(info.height)}\n"
        f"distortion_model: {json.dumps(str(info.distortion_model))}\n"
        f"d: {_listed(d)}\nk: {_listed(k)}\n"
    )
    return camera_from_bytes(name, text.encode())


def scan_of(name: str, message: Any) -> LaserScan:
    """A scan without its mounting, by the checks that files have."""
    keys = ("angle_min", "angle_max", "angle_increment", "range_min", "range_max")
    lines = [f"{key}: {float(getattr(message, key))!r}" for key in keys]
    return scan_from_bytes(name, "\n".join([*lines, f"ranges: {_listed(message.ranges)}"]).encode())


def _listed(numbers: Any) -> str:
    with np.errstate(invalid="ignore"):  # a NaN of any kind is a NaN
        return f"[{', '.join(map(repr, np.asarray(numbers, dtype=float).tolist()))}]"


def _of_camera(bag: BagReader, T_robot_camera: FloatArray) -> Pose2:
    """Where a camera is on its robot: x along its axis.

    By ROS's rule the frame of an image has z along the axis and y down (*optical*); some drivers give the
    frame of the camera's body, with x along the axis and z up. Which of the two is upright tells.
    """
    x, y, z = T_robot_camera[:3, :3].T
    along, right = (z, x) if abs(y[2]) > abs(z[2]) else (x, -y)
    tilt = degrees(asin(min(1.0, max(abs(along[2]), abs(right[2])))))
    if tilt > MOST_TILT:
        raise InputFileError(
            bag.path, f"its camera is tilted by {tilt:.0f}°", "bearings need a camera that looks level"
        )
    return Pose2(float(T_robot_camera[0, 3]), float(T_robot_camera[1, 3]), atan2(along[1], along[0]))


def _mounted(bag: BagReader, scan: LaserScan, T_robot_laser: FloatArray) -> LaserScan:
    """A scan with the laser's mounting; one that hangs upside down counts its angles the other way."""
    ahead, _, above = T_robot_laser[:3, :3].T
    tilt = degrees(acos(min(1.0, abs(above[2]))))
    if tilt > MOST_TILT:
        raise InputFileError(
            bag.path, f"its laser is tilted by {tilt:.0f}°", "give a level one with --scan-topic"
        )
    mounting = Pose2(float(T_robot_laser[0, 3]), float(T_robot_laser[1, 3]), atan2(ahead[1], ahead[0]))
    way = 1.0 if above[2] > 0 else -1.0
    return replace(
        scan, angle_min=way * scan.angle_min, angle_increment=way * scan.angle_increment, mounting=mounting
    )
