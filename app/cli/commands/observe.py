"""``mapmeld observe``: an image and a laser scan in, a sighting out."""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from algorithms.common.errors import InputFileError, SettingError
from algorithms.common.pose import Pose2
from algorithms.detection.detection import Detector, Picture
from algorithms.detection.map_walls import MapWalls
from algorithms.detection.robot_sighting import (
    LaserView,
    SightedRobots,
    observation_of,
    sight,
    sight_by_tags,
)
from algorithms.files.atomic_write import check_folder, write_files
from algorithms.files.bags.sensor_messages import SensorView
from algorithms.files.camera_file import CAMERA_FILE
from algorithms.files.camera_picture import picture_to_jpeg, picture_to_png, read_picture
from algorithms.files.case_folder import FIRST_MAP_FILE
from algorithms.files.encounter_table import ENCOUNTER_TABLE, EncounterRow, read_encounters
from algorithms.files.map_file import read_map
from algorithms.files.observation_file import known_to_bytes
from algorithms.maps.grid_map import GridMap
from algorithms.observations.observation import Observation
from app.cli.argument_parser import Parser, whole_number
from app.cli.bag_arguments import add_bags, check_bags, recorded_map, recorded_place, recorded_view
from app.cli.sensor_arguments import (
    PLACE,
    POSE,
    add_sensors,
    camera_of,
    detector_of,
    footprint_of,
    scan_of,
)
from app.drawing.sighting_picture import sighting_picture
from app.model.sighting.sighting_text import as_data, box_text, outcome_text

USAGE = (
    "[TABLE | --image IMAGE --scan SCAN --observer-pose X,Y,YAW --observed-pose X,Y[,YAW] | "
    "--bag BAG --at TIME --observed-bag BAG] --camera FILE --out FILE [options]"
)
DESCRIPTION = f"""\
Find robot 2 in an image of robot 1's camera, measure it with robot 1's laser, and write the sighting that
mapmeld merge takes. The detector is a histogram of oriented gradients with a support vector machine, or
reads tags; range and bearing come from the laser points in the direction of the box.

Examples:
  mapmeld observe --image seen.jpg --camera camera.yaml --scan scan.yaml \\
          --observer-pose 31.25,2.71,2.964 --observed-pose 24.83,34.58 --out observation.yaml
  mapmeld observe … --tags 36h11 --tag-size 0.16        tags instead of the detector; no scan is needed
  mapmeld observe … --map map1.yaml                     what robot 1's map shows as wall is no robot
  mapmeld observe {ENCOUNTER_TABLE} --camera camera.yaml --out observation.yaml
                                     several images, each a line: image, scan, observer_x, observer_y,
                                     observer_yaw, observed_x, observed_y and observed_yaw
  mapmeld observe sample_maps/office_r2_r1 --out observation.yaml
                                     a folder with {ENCOUNTER_TABLE} and {CAMERA_FILE}; its
                                     {FIRST_MAP_FILE} counts as --map

  mapmeld observe --bag robot1_bag --at 61.5 --observed-bag robot2_bag --out observation.yaml
                                     all of it from recordings of ROS 1 or ROS 2

--camera is a calibration as ROS's camera_info, --scan a LaserScan as "ros2 topic echo --once /scan" prints
it. Poses are metres and radians: robot 1 in map 1, robot 2 in map 2. The standard deviations are those of
this measurement: the laser's noise, the spacing of its beams, the points on the robot, what is hidden of it.

A robot beside a wall, two robots in view, or a picture of one are refused with the reason.
Exit status: 0 found (of several images: in one at least), 1 nothing found or refused, 2 bad input,
130 interrupted."""


@dataclass(frozen=True, eq=False)
class _Encounter:
    """One image with its scan, and where the robots stood."""

    image: Path
    scan: Path | None
    observer: Pose2
    observed: tuple[float, ...]
    recorded: SensorView | None = None


def add_arguments(parser: Parser, words: Sequence[str]) -> None:
    parser.add_argument(
        "table",
        type=Path,
        nargs="?",
        metavar="TABLE",
        help=f"several encounters: {ENCOUNTER_TABLE}, or its folder",
    )
    parser.add_argument("--image", type=Path, metavar="IMAGE", help="what robot 1's camera saw")
    parser.add_argument("--scan", type=Path, metavar="SCAN", help="what robot 1's laser measured then")
    parser.add_argument("--observer-pose", type=POSE, metavar="X,Y,YAW", help="of robot 1 in map 1")
    parser.add_argument("--observed-pose", type=PLACE, metavar="X,Y[,YAW]", help="of robot 2 in map 2")
    parser.add_argument("--out", type=Path, required=True, metavar="FILE", help="the observation to write")
    parser.add_argument("--map", type=Path, metavar="MAP", help="robot 1's map: its walls are no robots")
    parser.add_argument(
        "--box", type=whole_number(1, 1000), metavar="N", help="the box that is the robot, by its number"
    )
    parser.add_argument(
        "--picture", type=Path, metavar="FILE", help="draw boxes and laser points (.png, .jpg)"
    )
    parser.add_argument("--json", action="store_true", help="print what was found as JSON and nothing else")
    add_sensors(parser)
    add_bags(parser)


def run(args: argparse.Namespace, parser: Parser) -> int:
    """Look, write and tell; the exit status."""
    encounters = _encounters(args, parser)
    for file in (args.out, args.picture):
        if file is not None:
            check_folder(file.parent)
    detector = detector_of(args)
    grid = _map_of(args)
    files: dict[Path, bytes] = {}
    found: list[Observation] = []
    told: list[dict[str, Any]] = []
    for number, at in enumerate(encounters, 1):
        seen, picture = _look(args, detector, grid, at)
        told.append({"image": str(at.image), **as_data(seen)})
        if not args.json:
            print(*_lines(at, seen, len(encounters) > 1), sep="\n")
        if picture is not None:
            file = _picture_file(args.picture, number, len(encounters))
            files[file] = (picture_to_png if file.suffix.lower() == ".png" else picture_to_jpeg)(picture)
        if seen.position is not None:
            heading = at.observed[2] if len(at.observed) == 3 else None
            place = np.array(at.observed[:2])
            found.append(observation_of(seen.position, at.observer, place, heading))
    if found:
        files[args.out] = known_to_bytes(found)
    write_files(files)
    if args.json:
        data = told[0] if args.table is None else {"encounters": told}
        print(json.dumps(data, indent=2))
    elif found:
        print(f"written to {args.out}: {_count(len(found))}")
    return 0 if found else 1


def _map_of(args: argparse.Namespace) -> GridMap | None:
    """Robot 1's map, where it is named or lies in the folder or recording; if not in that, this is said."""
    file = args.map or _map_beside(args.table)
    if file is not None:
        return read_map(file)
    if args.bag is None:
        return None
    try:
        return recorded_map(args)
    except InputFileError as error:
        print(f"mapmeld: without robot 1's map ({error})", file=sys.stderr)
        return None


def _encounters(args: argparse.Namespace, parser: Parser) -> list[_Encounter]:
    """What the command line, its table or its recording names."""
    check_bags(args)
    single = {
        name: getattr(args, name.replace("-", "_")) for name in ("image", "observer-pose", "observed-pose")
    }
    if args.table is not None:
        for name, value in {**single, "scan": args.scan, "box": args.box}.items():
            if value is not None:
                parser.error(f"--{name} is given beside {args.table}, which names its own; leave one out")
        return list(_from_table(args))
    if args.bag is not None:
        return [_from_bag(args)]
    missing = [f"--{name}" for name, value in single.items() if value is None]
    if missing:
        parser.error(f"{', '.join(missing)} missing; or give a table of encounters")
    if args.scan is None and (args.tags is None or args.tag_size is None):
        parser.error(
            "--scan is missing; only tags of known size (--tags, --tag-size) tell the distance without"
        )
    return [_Encounter(args.image, args.scan, Pose2.from_array(args.observer_pose), args.observed_pose)]


def _from_bag(args: argparse.Namespace) -> _Encounter:
    seen = recorded_view(args)
    observer = seen.robot if args.observer_pose is None else Pose2.from_array(args.observer_pose)
    observed = args.observed_pose or recorded_place(args, seen.time)
    return _Encounter(args.image or Path(seen.name), args.scan, observer, observed, seen)


def _from_table(args: argparse.Namespace) -> Iterator[_Encounter]:
    file = args.table / ENCOUNTER_TABLE if args.table.is_dir() else args.table
    for row in read_encounters(file):
        scan = file.parent / row.scan if row.scan else None
        yield _Encounter(file.parent / row.image, scan, row.observer, _place(row))


def _map_beside(table: Path | None) -> Path | None:
    """Robot 1's map in a folder of encounters, where there is one."""
    beside = None if table is None or not table.is_dir() else table / FIRST_MAP_FILE
    return beside if beside is not None and beside.exists() else None


def _place(row: EncounterRow) -> tuple[float, ...]:
    place = (row.observed_x, row.observed_y)
    return place if row.observed_heading is None else (*place, row.observed_heading)


def _look(
    args: argparse.Namespace, detector: Detector, grid: GridMap | None, at: _Encounter
) -> tuple[SightedRobots, Picture | None]:
    """What one image shows, and the picture of it where one is asked for."""
    told = at.recorded
    picture = read_picture(at.image) if told is None or args.image is not None else told.picture
    beside = at.image.parent / CAMERA_FILE
    fallback = beside if args.table is not None and beside.exists() else None
    camera = camera_of(args, picture, at.image, fallback, None if told is None else told.camera)
    body = footprint_of(args)
    found = detector.detect(picture, camera)
    pick = None if args.box is None else args.box - 1
    if pick is not None and pick >= len(found):
        raise SettingError(f"--box is {args.box}, but there are {len(found)} boxes in {at.image}")
    scan = told.scan if at.scan is None and told is not None else None
    if at.scan is not None:
        scan = scan_of(args, at.scan)
    if scan is None:
        if told is not None and not (args.tags and args.tag_size):
            raise InputFileError(args.bag, "holds no laser scan", "record one, or give --scan FILE")
        seen, view = sight_by_tags(found, camera, body, pick), None
    else:
        walls = None if grid is None else MapWalls(grid, at.observer)
        seen = sight(found, scan, camera, body, walls, pick)
        view = LaserView.of(scan, camera, walls)
    return seen, sighting_picture(picture, seen, view) if args.picture is not None else None


def _picture_file(asked: Path, number: int, count: int) -> Path:
    """seen.png, or seen_1.png, seen_2.png where there are several images."""
    if asked.suffix.lower() not in (".png", ".jpg", ".jpeg"):
        raise InputFileError(asked, "is not a name of a picture", "let it end in .png or .jpg")
    return asked if count == 1 else asked.with_stem(f"{asked.stem}_{number}")


def _lines(at: _Encounter, seen: SightedRobots, several: bool) -> list[str]:
    lines = [f"{at.image}: {outcome_text(seen)}" if several else outcome_text(seen)]
    return lines + [f"  {box_text(number, one)}" for number, one in enumerate(seen.sighted, 1)]


def _count(count: int) -> str:
    return "one sighting" if count == 1 else f"{count} sightings"
