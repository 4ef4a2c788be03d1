"""Wrong pairs: two maps of different buildings, made of the cases in a folder."""

from __future__ import annotations

import random
import re
from dataclasses import dataclass
from itertools import permutations
from pathlib import Path

from algorithms.common.errors import InputFileError
from algorithms.files.case_folder import Case, case_folders, group_of, name_in, read_case
from algorithms.files.truth_file import TRUTH_FILE, Truth, read_truth
from algorithms.simulator.wrong_pairs import crossed


@dataclass(frozen=True)
class Crossing:
    """A wrong pair: map 1 and the observer of one case, map 2 and the seen robot of another building's.

    buildings : of both
    """

    observer: Path
    observed: Path
    buildings: tuple[str, str]


Pair = Path | Crossing
"""The folder of a case, or what two cases make."""


def name_of_pair(root: Path, pair: Pair) -> str:
    """What a pair is called among those in ``root``."""
    folders = [pair] if isinstance(pair, Path) else [pair.observer, pair.observed]
    return " x ".join(name_in(root, folder) for folder in folders)


def read_pair(pair: Pair, rough: bool = False) -> Case:
    """The case of a pair; raises InputFileError.

    rough : take the badly measured observation of each case
    """
    if isinstance(pair, Path):
        return read_case(pair, rough)
    return crossed_case(read_case(pair.observer, rough), read_case(pair.observed, rough))


def crossings(root: Path, count: int, seed: int = 0) -> list[Crossing]:
    """So many wrong pairs of the cases in a folder, different ones, by chance; fewer where there are not so
    many pairs of different buildings.

    raises : InputFileError for a case that cannot be read, or where all are of one building
    """
    known: dict[Path, str] = {}
    for folder in case_folders(root):
        path = folder / TRUTH_FILE
        truth = read_truth(path) if path.exists() else None
        if truth is None or truth.expected == "merge":
            known[folder] = building_of(group_of(name_in(root, folder)), truth)
    pairs = [Crossing(a, b, (known[a], known[b])) for a, b in permutations(known, 2) if known[a] != known[b]]
    if not pairs:
        raise InputFileError(
            root, "holds cases of one building only", "wrong pairs need two buildings or more"
        )
    return random.Random(seed).sample(pairs, min(count, len(pairs)))


def building_of(group: str, truth: Truth | None) -> str:
    """Which building a case is of: what its truth names as source, without the numbers of surveys (HIH_01);
    the group of its name where nothing is named.
    """
    words = [] if truth is None else truth.source.split()
    kept = [word for word in words if word != "+" and not re.fullmatch(r"\w+_\d+", word)]
    return " ".join(kept) or group


def crossed_case(a: Case, b: Case) -> Case:
    """The wrong pair that two cases of different buildings make."""
    return Case(
        name=f"{a.name} x {b.name}",
        ref=a.ref,
        mov=b.mov,
        observations=tuple(map(crossed, a.observations, b.observations)),
        observation_file=a.observation_file,
        truth=Truth(None, expected="refuse"),
    )
