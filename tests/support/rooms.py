"""A room drawn in code that shows which way up it is, and the files of a pair of maps."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from algorithms.files.map_file import map_to_bytes
from algorithms.files.observation_file import known_to_bytes
from algorithms.maps.grid_map import FREE, OCCUPIED, UNKNOWN, GridMap
from algorithms.observations.observation import Observation


def l_room() -> GridMap:
    """A room of 6 m x 4 m with a thick wall at its left and at its foot."""
    cells = np.full((40, 60), FREE, dtype=np.int8)
    cells[:, :5] = OCCUPIED
    cells[:5, :] = OCCUPIED
    cells[-5:, -5:] = UNKNOWN
    return GridMap(cells, 0.1)


def write_case(folder: Path, ref: GridMap, mov: GridMap, observation: Observation) -> list[Path]:
    """The files of both maps, then what is known."""
    paths = []
    for stem, grid in (("map1", ref), ("map2", mov)):
        files = map_to_bytes(grid, stem)
        for name in (f"{stem}.yaml", f"{stem}.pgm"):
            (folder / name).write_bytes(files[name])
            paths.append(folder / name)
    (folder / "observation.yaml").write_bytes(known_to_bytes([observation]))
    return [*paths, folder / "observation.yaml"]
