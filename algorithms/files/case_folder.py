"""A case: the folder with two maps, the sightings between them and, where it is known, the truth."""

from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path

from algorithms.common.display_text import show_hidden
from algorithms.common.errors import InputFileError, unreadable
from algorithms.common.source_file import SourceFile
from algorithms.files.map_file import read_map
from algorithms.files.observation_file import OBSERVATION_FILE, ROUGH_OBSERVATION_FILE, read_known
from algorithms.files.truth_file import TRUTH_FILE, Truth, read_truth
from algorithms.maps.grid_map import GridMap
from algorithms.observations.observation import Observation
from algorithms.observations.pair_problem import Known
from algorithms.observations.priors import Prior

FIRST_MAP_FILE = "map1.yaml"
SECOND_MAP_FILE = "map2.yaml"


@dataclass(frozen=True, eq=False)
class Case:
    """A folder with two maps, one sighting or several, and, where it is known, the answer.

    ref, mov         : map1.yaml, the observer's, and map2.yaml, that of the robot it saw
    observation_file : name of the file that ``observations`` came from
    priors           : what else is known
    truth            : None where the folder holds no truth.yaml
    read_from        : that file itself; None where there is none
    """

    name: str
    ref: GridMap
    mov: GridMap
    observations: tuple[Observation, ...]
    observation_file: str
    truth: Truth | None
    priors: tuple[Prior, ...] = ()
    read_from: SourceFile | None = None

    @property
    def known(self) -> tuple[Known, ...]:
        """All that is known of how the maps lie."""
        return (*self.observations, *self.priors)


def read_case(folder: Path | str, rough: bool = False) -> Case:
    """Read the case in a folder: map1.yaml, map2.yaml, observation.yaml and, if it is there, truth.yaml.

    rough  : take the badly measured observations instead of the good ones
    raises : InputFileError, TooLargeError
    """
    folder = Path(folder)
    observation_file = ROUGH_OBSERVATION_FILE if rough else OBSERVATION_FILE
    known = read_known(folder / observation_file)
    truth_path = folder / TRUTH_FILE
    return Case(
        name=show_hidden(folder.resolve().name),
        ref=read_map(folder / FIRST_MAP_FILE),
        mov=read_map(folder / SECOND_MAP_FILE),
        observations=tuple(each for each in known if isinstance(each, Observation)),
        observation_file=observation_file,
        truth=read_truth(truth_path) if truth_path.exists() else None,
        priors=tuple(each for each in known if not isinstance(each, Observation)),
        read_from=SourceFile.at(folder / observation_file),
    )


def case_folders(root: Path) -> list[Path]:
    """The folders under root, and root itself, that hold a map1.yaml; sorted.

    raises : InputFileError where there is none, or a folder that cannot be looked into
    """
    root = Path(root)
    if not root.is_dir():
        raise InputFileError(root, "is not a folder", "give a folder of cases, or one case")

    def closed(error: OSError) -> None:  # a case that is passed over would be missing in every count
        raise unreadable(error.filename, error, "see that you may read it, or move it away") from error

    folders = sorted(
        Path(folder) for folder, _, files in os.walk(root, onerror=closed) if FIRST_MAP_FILE in files
    )
    if not folders:
        remedy = f"a case is a folder of {FIRST_MAP_FILE}, {SECOND_MAP_FILE} and {OBSERVATION_FILE}"
        raise InputFileError(root, f"no folder in it holds a {FIRST_MAP_FILE}", remedy)
    return folders


def name_in(root: Path, folder: Path) -> str:
    """What a case is called: its place under the root; the root's own name where it is the case."""
    inside = folder.relative_to(root).as_posix()
    return folder.resolve().name if inside == "." else inside


def group_of(name: str) -> str:
    """Name of a case up to its first "_"."""
    return name.rsplit("/", 1)[-1].split("_", 1)[0]
