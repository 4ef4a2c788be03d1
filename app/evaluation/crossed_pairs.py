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
    """A wrong pair: map 1 and the observer of one case, map 2 and the seen robot of another building's."""

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
    """The case of a pair, its badly measured observation where ``rough``; raises InputFileError."""
    if isinstance(pair, Path):
        return read_case(pair, rough)
    a, b = read_case(pair.observer, rough), read_case(pair.observed, rough)
    observations = tuple(map(crossed, a.observations, b.observations))
    truth = Truth(None, expected="refuse")
    return Case(f"{a.name} x {b.name}", a.ref, b.mov, observations, a.observation_file, truth)


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
        found, remedy = "holds cases of one building only", "wrong pairs need two buildings or more"
        raise InputFileError(root, found, remedy)
    return random.Random(seed).sample(pairs, min(count, len(pairs)))


def building_of(group: str, truth: Truth | None) -> str:
    """The building of a case: its truth's source without the numbers of surveys (HIH_01), or its group."""
    words = [] if truth is None else truth.source.split()
    return " ".join(word for word in words if word != "+" and not re.fullmatch(r"\w+_\d+", word)) or group
