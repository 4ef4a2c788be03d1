"""Arguments that name recordings, and what two robots' recordings say of one moment."""

from __future__ import annotations

import argparse
from contextlib import suppress
from dataclasses import replace
from math import isfinite
from pathlib import Path

from algorithms.common.errors import InputFileError, SettingError
from algorithms.common.pose import Pose2
from algorithms.files.bags.bag_path import BagPath, bag_path, nanoseconds
from algorithms.files.bags.bag_reader import open_bag
from algorithms.files.bags.frame_tree import frames_around
from algorithms.files.bags.map_messages import read_bag_map
from algorithms.files.bags.sensor_messages import SensorChoice, SensorView, sensor_view
from algorithms.maps.grid_map import GridMap
from app.cli.argument_parser import Parser

FRAMES = "map,base_link"
KINDS = "give a .bag, .db3 or .mcap file, or the folder of a bag, with its metadata.yaml"
TOPICS = ("image_topic", "camera_info_topic", "scan_topic")
NEEDS_BAG = ("at", "observed_bag", "frames", "observed_frames", *TOPICS)


def add_bags(parser: Parser) -> None:
    """Add ``--bag``, ``--at`` and what goes with them."""
    group = parser.add_argument_group(
        "recordings",
        "Instead of --image, --camera, --scan and poses; each of these given beside counts more.",
    )
    about = "robot 1's recording: its camera, laser and transforms (.bag, .db3, .mcap, or a folder)"
    group.add_argument("--bag", metavar="BAG", help=about)
    about = "when robot 1 saw robot 2; seconds since the recording began, before its end, or since 1970"
    group.add_argument("--at", type=_time, metavar="TIME", help=about)
    about = "robot 2's recording, for its pose at that time (default: the same recording)"
    group.add_argument("--observed-bag", metavar="BAG", help=about)
    about = f"frames of robot 1's map and of robot 1 (default: {FRAMES})"
    group.add_argument("--frames", type=_frames, metavar="MAP,BASE", help=about)
    about = f"frames of robot 2's map and of robot 2 (default: {FRAMES} of --observed-bag)"
    group.add_argument("--observed-frames", type=_frames, metavar="MAP,BASE", help=about)
    for name in TOPICS:
        about = "where there are several"
        group.add_argument(f"--{name.replace('_', '-')}", metavar="TOPIC", help=about)


def check_bags(args: argparse.Namespace) -> None:
    """Raise SettingError where what goes with a recording is given without one, or not enough of it."""
    if args.bag is None:
        for name in NEEDS_BAG:
            if getattr(args, name) is not None:
                raise SettingError(f"--{name.replace('_', '-')} is given without --bag; give both")
        return
    if args.at is None:
        raise SettingError("--at is missing: when robot 1 saw robot 2, in seconds since the recording began")
    if args.observed_pose is None and args.observed_bag is None and args.observed_frames is None:
        raise SettingError(
            "where robot 2 was is missing; give --observed-bag, or --observed-pose, or --observed-frames "
            "where its transforms are in the same recording"
        )


def recorded_view(args: argparse.Namespace) -> SensorView:
    """What robot 1's recording says; raises InputFileError."""
    map_frame, base_frame = args.frames or tuple(FRAMES.split(","))
    choice = SensorChoice(
        args.image_topic or "",
        None if args.camera or args.field_of_view_deg else args.camera_info_topic or "",
        None if args.scan else args.scan_topic or "",
        None if args.camera_mounting is None else Pose2.from_array(args.camera_mounting),
        None if args.laser_mounting is None else Pose2.from_array(args.laser_mounting),
        map_frame,
        base_frame,
    )
    with open_bag(recording(args.bag).path) as bag:
        return sensor_view(bag, nanoseconds(args.at, bag.begin, bag.end), choice)


def recorded_place(args: argparse.Namespace, time: int) -> tuple[float, ...]:
    """Robot 2's pose in its map at a time of the robots' clocks (nanoseconds); metres, radians.

    raises : InputFileError
    """
    map_frame, base_frame = args.observed_frames or tuple(FRAMES.split(","))
    with open_bag(recording(args.observed_bag or args.bag).path) as bag:
        return tuple(frames_around(bag, time).pose(map_frame, base_frame, time).array().tolist())


def recorded_map(args: argparse.Namespace) -> GridMap:
    """Robot 1's map at that time; raises InputFileError where its recording holds none, or several."""
    return read_bag_map(replace(recording(args.bag), time=args.at))


def recording(text: str) -> BagPath:
    """The recording that is named, with topic and time where they are; raises InputFileError."""
    found = bag_path(text)
    if found is None:
        there = Path(text.partition("#")[0].partition("@")[0]).exists()
        what = "is no recording of ROS (a bag)" if there else "no such file"
        raise InputFileError(text, what, KINDS)
    return found


def _time(text: str) -> float:
    with suppress(ValueError):
        number = float(text)
        if isfinite(number):
            return number
    raise argparse.ArgumentTypeError(f"{text} is no number of seconds")


def _frames(text: str) -> tuple[str, str]:
    names = tuple(name.strip() for name in text.split(","))
    if len(names) == 2 and all(names):
        return names[0], names[1]
    raise argparse.ArgumentTypeError(f"{text} is not MAP,BASE: the names of two frames")
