"""``mapmeld samples``: simulated pairs with known truth, those that ship or any number of others."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path

from app.usage import Parser

USAGE = "DIR [--building KIND --seeds FIRST[-LAST] [--overlap SHARE] [--sightings N]]"
DESCRIPTION = """\
Simulate pairs of maps whose true transform is known: buildings drawn in code, robots with a lidar.
Without --building those that ship with mapmeld: the same files, bit for bit.

Examples:
  mapmeld samples cases              a folder per pair, with maps, sighting and truth
  mapmeld samples cases --building warehouse --seeds 0-19 --overlap 0.2
                                     forty pairs from twenty other warehouses
  mapmeld samples cases --building office --sightings 3
                                     pairs whose robots met at up to three places
  mapmeld evaluate cases             and how the method does on them"""


def add_arguments(parser: Parser, words: Sequence[str]) -> None:
    """Tell the parser what the command takes."""
    parser.add_argument("folder", type=Path, metavar="DIR", help="where the folders go; made where missing")
    parser.add_argument(
        "--building", metavar="KIND", help="office, apartment, warehouse or corridor, one per seed"
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


def run(args: argparse.Namespace, parser: Parser) -> int:
    """Write the cases and name them."""
    from algorithms.casefiles import MOST_OBSERVATIONS
    from algorithms.simulator.buildings import BUILDINGS
    from algorithms.simulator.samples import generate_cases, regenerate
    from app.progress import bar

    if args.building is None:
        if args.seeds or args.overlap is not None or args.sightings is not None:
            parser.error(
                "--seeds, --overlap and --sightings need --building: the shipped samples are what they are"
            )
        for case in regenerate(args.folder):
            print(args.folder / case.name)
        return 0
    if args.building not in BUILDINGS:
        parser.error(f"there is no building {args.building!r}, but {', '.join(BUILDINGS)}")
    if args.overlap is not None and not 0.05 <= args.overlap <= 0.6:
        parser.error(f"--overlap is {args.overlap:g}; it must lie in [0.05, 0.6]")
    sightings = 1 if args.sightings is None else args.sightings
    if not 1 <= sightings <= MOST_OBSERVATIONS:
        parser.error(f"--sightings is {sightings}; it must lie in [1, {MOST_OBSERVATIONS}]")
    with bar(total=len(seeds := seeds_of(args.seeds or "0", parser)), unit="building") as shown:
        for seed in seeds:
            for folder in generate_cases(args.building, [seed], args.folder, args.overlap, sightings):
                print(folder)
            shown.update()
    return 0


def seeds_of(text: str, parser: Parser) -> range:
    """The seeds that "7" or "0-19" names; a usage error for anything else."""
    first, _, last = text.partition("-")
    if not (first.isdecimal() and (last or first).isdecimal()) or int(last or first) < int(first):
        parser.error(f"--seeds is {text!r}; give one number, or two with a dash between: 0-19")
    return range(int(first), int(last or first) + 1)
