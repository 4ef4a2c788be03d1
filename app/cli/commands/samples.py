"""``mapmeld samples``: simulated pairs with known truth, those that ship or any number of others."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from itertools import product
from pathlib import Path

from app.cli.argument_parser import Parser, whole_number

USAGE = "DIR [--building KIND[,KIND…] --seeds FIRST[-LAST] [--overlap SHARE] [--sightings N] [--fleet N] ...]"
DESCRIPTION = """\
Simulate pairs of maps whose true transform is known: buildings drawn in code, robots with a lidar.
Without --building those that ship with mapmeld: the same files, bit for bit.

Examples:
  mapmeld samples cases              a folder per pair, with maps, sighting and truth; in some a picture of
                                     the robot that was seen, and the laser scan
  mapmeld samples cases --building warehouse --seeds 0-19 --overlap 0.2
                                     forty pairs from twenty other warehouses, with pictures
  mapmeld samples cases --building office --sightings 3
                                     pairs whose robots met at up to three places
  mapmeld samples lies --building office,corridor --seeds 0-3 --wrong-pairs
                                     maps of different buildings: all to be refused
  mapmeld samples fleets --building office --seeds 0-3 --fleet 6
                                     four fleets of six robots, for mapmeld fleet and evaluate
  mapmeld evaluate cases             and how the method does on them"""


def add_arguments(parser: Parser, words: Sequence[str]) -> None:
    parser.add_argument("folder", type=Path, metavar="DIR", help="where the folders go; made where missing")
    parser.add_argument(
        "--building",
        metavar="KIND[,KIND…]",
        help="office, apartment, warehouse, corridor, home, university, or several; one of each per seed",
    )
    parser.add_argument("--seeds", metavar="FIRST[-LAST]", help="which buildings of that kind (default: 0)")
    parser.add_argument(
        "--overlap", type=float, metavar="SHARE", help="of the smaller map's walls, 0.05 … 0.6 (default: any)"
    )
    parser.add_argument(
        "--sightings",
        type=int,
        metavar="N",
        help="how often robot 1 sees robot 2, at most; less where they meet less often (default: 1)",
    )
    parser.add_argument(
        "--fleet",
        type=whole_number(2, 50),
        metavar="N",
        help="write fleets of N robots instead of pairs; one sighting in five is a lie",
    )
    parser.add_argument(
        "--wrong-pairs",
        action="store_true",
        help="pair every robot with those of the other buildings instead: what has to be refused",
    )


def run(args: argparse.Namespace, parser: Parser) -> int:
    """Write the cases and name them."""
    from algorithms.files.atomic_write import check_folder
    from algorithms.files.observation_file import MOST_OBSERVATIONS
    from algorithms.simulator.buildings.building_types import BUILDINGS
    from algorithms.simulator.samples import generate_cases, generate_fleets, generate_wrong_pairs, regenerate
    from app.cli.progress_bar import bar

    if args.building is None:
        asked = (args.seeds, args.overlap, args.sightings, args.fleet)
        if any(each is not None for each in asked) or args.wrong_pairs:
            parser.error(
                "--seeds, --overlap, --sightings, --fleet and --wrong-pairs need --building: "
                "the shipped samples are what they are"
            )
        check_folder(args.folder)
        for case in regenerate(args.folder):
            print(args.folder / case.name)
        return 0
    kinds = args.building.split(",")
    for kind in kinds:
        if kind not in BUILDINGS:
            parser.error(f"there is no building {kind!r}, but {', '.join(BUILDINGS)}")
    if args.overlap is not None and not 0.05 <= args.overlap <= 0.6:
        parser.error(f"--overlap is {args.overlap:g}; it must lie in [0.05, 0.6]")
    sightings = 1 if args.sightings is None else args.sightings
    if not 1 <= sightings <= MOST_OBSERVATIONS:
        parser.error(f"--sightings is {sightings}; it must lie in [1, {MOST_OBSERVATIONS}]")
    seeds = seeds_of(args.seeds or "0", parser)
    buildings = len(kinds) * len(seeds)
    if args.wrong_pairs and buildings < 2:
        parser.error("--wrong-pairs needs two buildings at least: name more kinds or more seeds")
    drawn = args.overlap is not None or args.sightings is not None or args.wrong_pairs
    if args.fleet is not None and drawn:
        parser.error("--fleet draws overlaps and sightings: leave out --overlap, --sightings, --wrong-pairs")
    check_folder(args.folder)
    if args.fleet is not None:
        with bar(total=buildings, unit="fleet") as shown:
            for kind in kinds:
                for folder in generate_fleets(kind, seeds, args.fleet, args.folder):
                    print(folder)
                    shown.update()
        return 0
    if args.wrong_pairs:
        pairs = generate_wrong_pairs(kinds, seeds, args.folder, args.overlap, sightings)
        with bar(total=4 * buildings * (buildings - 1), unit="pair") as shown:
            for folder in pairs:
                print(folder)
                shown.update()
        return 0
    with bar(total=buildings, unit="building") as shown:
        for kind, seed in product(kinds, seeds):
            for folder in generate_cases(kind, [seed], args.folder, args.overlap, sightings):
                print(folder)
            shown.update()
    return 0


def seeds_of(text: str, parser: Parser) -> range:
    """The seeds that "7" or "0-19" names; a usage error for anything else."""
    first, _, last = text.partition("-")
    if not (first.isdecimal() and (last or first).isdecimal()) or int(last or first) < int(first):
        parser.error(f"--seeds is {text!r}; give one number, or two with a dash between: 0-19")
    return range(int(first), int(last or first) + 1)
