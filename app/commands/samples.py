"""``mapmeld samples``: simulated pairs with known truth, those that ship or any number of others."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path

from app.usage import Parser

USAGE = "DIR [--building KIND --seeds FIRST[-LAST] [--overlap SHARE]]"
DESCRIPTION = """\
Simulate pairs of maps whose true transform is known: buildings drawn in code, robots with a lidar.
Without --building those that ship with mapmeld: the same files, bit for bit.

Examples:
  mapmeld samples cases              a folder per pair, with maps, sighting and truth
  mapmeld samples cases --building warehouse --seeds 0-19 --overlap 0.2
                                     forty pairs from twenty other warehouses
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


def run(args: argparse.Namespace, parser: Parser) -> int:
    """Write the cases and name them."""
    from algorithms.simulator.buildings import BUILDINGS
    from algorithms.simulator.samples import generate_cases, regenerate
    from app.progress import bar

    if args.building is None:
        if args.seeds or args.overlap is not None:
            parser.error("--seeds and --overlap need --building: the shipped samples are what they are")
        for case in regenerate(args.folder):
            print(args.folder / case.name)
        return 0
    if args.building not in BUILDINGS:
        parser.error(f"there is no building {args.building!r}, but {', '.join(BUILDINGS)}")
    if args.overlap is not None and not 0.05 <= args.overlap <= 0.6:
        parser.error(f"--overlap is {args.overlap:g}; it must lie in [0.05, 0.6]")
    with bar(total=len(seeds := seeds_of(args.seeds or "0", parser)), unit="building") as shown:
        for seed in seeds:
            for folder in generate_cases(args.building, [seed], args.folder, args.overlap):
                print(folder)
            shown.update()
    return 0


def seeds_of(text: str, parser: Parser) -> range:
    """The seeds that "7" or "0-19" names; a usage error for anything else."""
    first, _, last = text.partition("-")
    if not (first.isdecimal() and (last or first).isdecimal()) or int(last or first) < int(first):
        parser.error(f"--seeds is {text!r}; give one number, or two with a dash between: 0-19")
    return range(int(first), int(last or first) + 1)
