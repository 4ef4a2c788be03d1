"""Arguments that name maps and cases, and reading what they name. Nothing heavy is loaded before."""

from __future__ import annotations

import argparse
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING

from algorithms.common.errors import SettingError
from app.cli.argument_parser import Parser, did_you_mean, whole_number
from app.system.data_paths import samples

if TYPE_CHECKING:
    from algorithms.maps.grid_map import GridMap
    from algorithms.observations.observation import Observation


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


def read_inputs(args: argparse.Namespace) -> tuple[GridMap, GridMap, tuple[Observation, ...]]:
    """Both maps and the observations that the command line names."""
    from algorithms.files.map_file import IMAGE_SUFFIXES, read_image, read_map
    from algorithms.files.observation_file import read_observations
    from algorithms.files.thresholds import Shading

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
    return ref, mov, read_observations(args.observation)


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
