"""``mapmeld samples``: the sample maps that ship, made again."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path

from app.usage import Parser

USAGE = "DIR"
DESCRIPTION = """\
Simulate the sample pairs that ship with mapmeld again: the same files, bit for bit.

Example:
  mapmeld samples cases              a folder per pair, with maps, sighting and truth
  mapmeld evaluate cases             and how the method does on them"""


def add_arguments(parser: Parser, words: Sequence[str]) -> None:
    """Tell the parser what the command takes."""
    parser.add_argument("folder", type=Path, metavar="DIR", help="where the folders go; made where missing")


def run(args: argparse.Namespace, parser: Parser) -> int:
    """Write the samples and name them."""
    from algorithms.simulator.samples import regenerate

    for case in regenerate(args.folder):
        print(args.folder / case.name)
    return 0
