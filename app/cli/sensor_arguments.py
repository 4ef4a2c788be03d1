"""Camera, laser, robot and detector as the command line names them."""

from __future__ import annotations

import argparse
from collections.abc import Callable
from contextlib import suppress
from dataclasses import replace
from math import isfinite, radians
from pathlib import Path

from algorithms.common.errors import InputFileError, SettingError
from algorithms.common.pose import Pose2
from algorithms.detection.detection import Detector, Picture
from algorithms.detection.footprint import Footprint
from algorithms.detection.model_file import read_model, shipped_model
from algorithms.detection.svm_detector import LEAST_PROBABILITY, SvmDetector
from algorithms.detection.tag_detector import FAMILIES, TagDetector
from algorithms.files.camera_file import read_camera
from algorithms.files.scan_file import read_scan
from algorithms.sensors.camera import Camera
from algorithms.sensors.laser_scan import LaserScan
from app.cli.argument_parser import Parser


def numbers(*counts: int, what: str) -> Callable[[str], tuple[float, ...]]:
    """The ``type`` of an argument of so many finite numbers with commas between."""

    def read(text: str) -> tuple[float, ...]:
        with suppress(ValueError):
            found = tuple(float(part) for part in text.split(","))
            if len(found) in counts and all(isfinite(number) for number in found):
                return found
        raise argparse.ArgumentTypeError(f"{text} is not {what}")

    return read


POSE = numbers(3, what="X,Y,YAW: three numbers, metres and radians")
PLACE = numbers(2, 3, what="X,Y or X,Y,YAW: metres and radians")
SIZE = numbers(2, what="LENGTH,WIDTH: two numbers of metres")


def add_sensors(parser: Parser) -> None:
    """Arguments of camera, laser, robot and detector."""
    sensors = parser.add_argument_group("sensors")
    sensors.add_argument("--camera", type=Path, metavar="FILE", help="calibration, as ROS's camera_info")
    sensors.add_argument(
        "--field-of-view-deg",
        type=float,
        metavar="DEGREES",
        help="of a camera without calibration, horizontally: bearings are counted in pixels from the middle",
    )
    sensors.add_argument(
        "--camera-mounting",
        type=POSE,
        metavar="X,Y,YAW",
        help="of the camera on robot 1; else the file's",
    )
    sensors.add_argument(
        "--laser-mounting", type=POSE, metavar="X,Y,YAW", help="of the laser on robot 1; else the file's"
    )
    robot = parser.add_argument_group("the robot that is seen")
    robot.add_argument(
        "--robot-size", type=SIZE, metavar="LENGTH,WIDTH", help="of a boxy robot (default: 0.46,0.40 m)"
    )
    robot.add_argument("--robot-radius", type=float, metavar="M", help="of a round robot instead; metres")
    robot.add_argument("--model", type=Path, metavar="FILE", help="detector that mapmeld detect train wrote")
    robot.add_argument(
        "--least-probability",
        type=float,
        metavar="P",
        default=LEAST_PROBABILITY,
        help=f"of a box that counts, 0 … 1 (default: {LEAST_PROBABILITY:g})",
    )
    robot.add_argument("--tags", metavar="FAMILY", help=f"find tags instead: {', '.join(FAMILIES)}")
    robot.add_argument(
        "--tag-size", type=float, metavar="M", help="side of a tag's black square; with it no scan is needed"
    )


def detector_of(args: argparse.Namespace) -> Detector:
    """The detector that is asked for; raises InputFileError, SettingError."""
    if args.tags is None and args.tag_size is not None:
        raise SettingError("--tag-size is given without --tags; give both")
    if args.tags is not None:
        if args.model is not None:
            raise SettingError("--model and --tags exclude one another: give one of them")
        return TagDetector(args.tags, args.tag_size)
    model = shipped_model() if args.model is None else read_model(args.model)
    return SvmDetector(model, args.least_probability)


def footprint_of(args: argparse.Namespace) -> Footprint:
    """The outline of the robot that is seen; raises SettingError."""
    if args.robot_radius is not None:
        if args.robot_size is not None:
            raise SettingError("--robot-size and --robot-radius exclude one another: give one of them")
        return Footprint.disc(args.robot_radius)
    return Footprint() if args.robot_size is None else Footprint(*args.robot_size)


def camera_of(
    args: argparse.Namespace, picture: Picture, name: object, fallback: Path | None, recorded: Camera | None
) -> Camera:
    """The camera that made a picture; raises InputFileError, SettingError.

    name     : of the picture's file
    fallback : a calibration that is taken where none is named
    recorded : the camera of a recording, taken likewise
    """
    height, width = picture.shape[:2]
    file = args.camera or fallback
    if args.field_of_view_deg is not None:
        if args.camera is not None:
            raise SettingError("--camera and --field-of-view-deg exclude one another: give one of them")
        camera = Camera.counting_pixels(width, height, radians(args.field_of_view_deg), Pose2())
    elif file is None and recorded is not None:
        camera = _fitting(recorded, picture, name, "the calibration")
    elif file is None:
        raise SettingError("no camera is given: give --camera FILE, or --field-of-view-deg DEGREES")
    else:
        camera = _fitting(read_camera(file), picture, name, file)
    mounting = args.camera_mounting
    return camera if mounting is None else replace(camera, mounting=Pose2.from_array(mounting))


def _fitting(camera: Camera, picture: Picture, name: object, source: object) -> Camera:
    height, width = picture.shape[:2]
    if (camera.width, camera.height) != (width, height):
        raise InputFileError(
            name,
            f"is {width} × {height} pixels, and {source} is for {camera.width} × {camera.height}",
            "give the calibration of this camera at this size",
        )
    return camera


def scan_of(args: argparse.Namespace, file: Path) -> LaserScan:
    """A scan with the laser's mounting; raises InputFileError."""
    scan = read_scan(file)
    mounting = args.laser_mounting
    return scan if mounting is None else replace(scan, mounting=Pose2.from_array(mounting))
