"""``python -m algorithms.simulator [DIR]``: make the shipped sample maps again."""

from __future__ import annotations

import argparse
from pathlib import Path

from algorithms.simulator.samples import regenerate


def main() -> None:
    """Write all samples to the folder named on the command line, and say what they are."""
    parser = argparse.ArgumentParser(
        prog="python -m algorithms.simulator", description="Make the sample maps again, bit for bit."
    )
    parser.add_argument(
        "folder", nargs="?", type=Path, default=Path("sample_maps"), help="default: sample_maps"
    )
    folder = parser.parse_args().folder
    for case in regenerate(folder):
        print(f"{folder / case.name}: overlap {case.overlap:.0%}")  # noqa: T201


if __name__ == "__main__":
    main()
