"""Arguments that name maps and cases, and reading what they name. Nothing heavy is loaded before."""

from __future__ import annotations

import argparse
import sys
from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from algorithms.common.errors import SettingError
from app.cli.argument_parser import Parser, did_you_mean, whole_number
from app.system.data_paths import samples

if TYPE_CHECKING:
    from algorithms.common.robot_names import RobotNames
    from algorithms.maps.grid_map import GridMap
    from algorithms.observations.pair_problem import Known
    from app.model.merge_inputs import MergeInputs


def add_reading(parser: Parser) -> None:
    """Add ``--resolution``, for images without a YAML file, and ``--unknown-grey``."""
    parser.add_argument(
        "--resolution",
        type=_resolutions,
        metavar="M[,M]",
        help="metres per pixel of maps given as plain images, whose lower-left corner is then the origin; "
        "two numbers where the maps differ; a YAML file says its own",
    )
    parser.add_argument(
        "--unknown-grey",
        type=whole_number(0, 255, "is no grey; give a whole number from 0 to 255"),
        metavar="G",
        help="a grey, 0 to 255, that stands for unknown in both maps, whatever their thresholds say",
    )


def add_names(parser: Parser) -> None:
    """Add ``--names``: what the two robots are called."""
    about = "what the robots of MAP1 and MAP2 are called: in verdicts, reports and the frames of their maps"
    parser.add_argument("--names", nargs=2, metavar=("NAME1", "NAME2"), help=about)


def names_from(args: argparse.Namespace) -> RobotNames:
    """What the robots are called; raises SettingError."""
    from algorithms.common.robot_names import RobotNames

    return RobotNames.of(*(args.names or ("", "")))


def add_known(parser: Parser) -> None:
    """Add what may be known of how the maps lie: a sighting, a pose, a turn, a place; all optional."""
    group = parser.add_argument_group("what is known", "Nothing of it is needed; the more, the surer.")
    group.add_argument("--observation", type=Path, metavar="FILE", help="what robot 1 saw")
    about = "where map 2's frame lies in map 1's, roughly; metres, metres, radians"
    group.add_argument("--initial", type=float, nargs=3, metavar=("X", "Y", "YAW"), help=about)
    about = "standard deviations of --initial: of X and Y, and of YAW (default: 1 m and 0.175)"
    group.add_argument("--sigma", type=float, nargs=2, metavar=("S_XY", "S_YAW"), help=about)
    about = "how far map 2's frame is turned in map 1's, roughly; radians, counter-clockwise"
    group.add_argument("--initial-yaw", type=float, metavar="YAW", help=about)
    about = "standard deviation of --initial-yaw (default: 0.175, which is 10°)"
    group.add_argument("--sigma-yaw", type=float, metavar="S", help=about)
    about = "a place in map 1, X1 Y1, that is about the place X2 Y2 in map 2; metres"
    group.add_argument("--near", type=float, nargs=4, metavar=("X1", "Y1", "X2", "Y2"), help=about)
    about = "how far apart the two of --near may be (default: 2 m)"
    group.add_argument("--near-radius", type=float, metavar="M", help=about)


KNOWN = ("observation", "initial", "sigma", "initial_yaw", "sigma_yaw", "near", "near_radius")


def any_known(args: argparse.Namespace) -> bool:
    """Whether the command line tells anything of how the maps lie."""
    return any(getattr(args, name) is not None for name in KNOWN)


def known_from(args: argparse.Namespace) -> tuple[Known, ...]:
    """All that the command line tells of how the maps lie."""
    from algorithms.common.pose import Pose2
    from algorithms.files.observation_file import read_known
    from algorithms.observations.priors import (
        NEAR_RADIUS,
        SIGMA_XY,
        SIGMA_YAW,
        InitialPose,
        NearPlace,
        TurnPrior,
    )

    for given, needs in (("sigma", "initial"), ("sigma_yaw", "initial_yaw"), ("near_radius", "near")):
        if getattr(args, given) is not None and getattr(args, needs) is None:
            flag, other = (f"--{name.replace('_', '-')}" for name in (given, needs))
            raise SettingError(f"{flag} is given without {other}; give both")
    known: list[Known] = [] if args.observation is None else [*read_known(args.observation)]
    if args.initial is not None:
        xy, yaw = args.sigma or (SIGMA_XY, SIGMA_YAW)
        known.append(InitialPose(Pose2(*args.initial), xy, xy, yaw))
    if args.initial_yaw is not None:
        known.append(TurnPrior(args.initial_yaw, SIGMA_YAW if args.sigma_yaw is None else args.sigma_yaw))
    if args.near is not None:
        known.append(NearPlace(*args.near, NEAR_RADIUS if args.near_radius is None else args.near_radius))
    return tuple(known)


def read_maps(args: argparse.Namespace) -> tuple[GridMap, GridMap]:
    """Both maps that the command line names."""
    from algorithms.files.images.thresholds import Shading
    from algorithms.files.map_file import IMAGE_SUFFIXES, read_image, read_map

    paths, given = (args.map1, args.map2), args.resolution or ()
    plain = [path.suffix.lower() in IMAGE_SUFFIXES for path in paths]
    # one number is for the plain images among the two, two numbers are for one map each
    if given and not (all(plain) or (len(given) == 1 and any(plain))):
        raise SettingError(
            f"--resolution is given, but {paths[plain.index(False)]} is no plain image: its YAML file says "
            "its own resolution; leave --resolution out, or correct the key resolution there"
        )
    ref, mov = (
        read_image(path, resolution, shading=Shading(unknown_grey=args.unknown_grey))
        if resolution is not None and image
        else read_map(path, args.unknown_grey)
        for path, resolution, image in zip(paths, (*given, *given, None, None), plain, strict=False)
    )
    return ref, mov


def pair_inputs(args: argparse.Namespace, parser: Parser) -> MergeInputs:
    """What ``first``, ``map2`` and what is known name: two maps, a sample, or the folder of a case.

    Doubts about how the maps are read go to stderr.
    """
    from algorithms.files.case_folder import read_case
    from app.model.merge_inputs import MergeInputs

    known = known_from(args)
    if args.map2 is not None:
        args.map1 = Path(args.first)
        ref, mov = read_maps(args)
        inputs = MergeInputs.pair(ref, mov, name=f"{args.map1.stem} + {args.map2.stem}").knowing(known)
    else:
        if args.resolution is not None or args.unknown_grey is not None:
            parser.error("--resolution and --unknown-grey say how MAP1 and MAP2 are read: give both maps")
        folder = case_folder(args.first, parser, "; for two maps give MAP1 and MAP2")
        inputs = MergeInputs.of(read_case(folder))
        inputs = inputs.knowing(known) if known else inputs
    inputs = replace(inputs, names=names_from(args))
    for warning in inputs.readings():
        sys.stderr.write(f"warning: {inputs.names.told(warning)}\n")
    return inputs


def case_folder(name: str, parser: Parser, remedy: str = "") -> Path:
    """The folder of a case, or of the sample of that name; else a usage error with ``remedy``."""
    known, folder = samples(), Path(name)
    if folder.is_dir():
        return folder
    if name not in known:
        parser.error(f"{name} is neither a folder nor a sample{did_you_mean(name, known)}{remedy}")
    return known[name]


def _resolutions(text: str) -> tuple[float, ...]:
    with suppress(ValueError):
        numbers = tuple(float(part) for part in text.split(","))
        if len(numbers) in (1, 2) and all(0 < number < float("inf") for number in numbers):
            return numbers
    raise argparse.ArgumentTypeError(f"{text} is neither one positive number nor two with a comma")
