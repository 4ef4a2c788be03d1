"""The robots of the sample pairs, one by one: a fleet may take any of them."""

from __future__ import annotations

from pathlib import Path

from algorithms.files.case_folder import FIRST_MAP_FILE, SECOND_MAP_FILE
from app.system import data_paths as paths


def sample_robots() -> dict[str, Path]:
    """The YAML file of every robot's map, by what a person reads in the menu; each robot once."""
    found: dict[str, Path] = {}
    for name, folder in paths.samples().items():
        building, *robots = name.rsplit("_", 2)  # the first one saw the second
        for robot, file in zip(robots, (FIRST_MAP_FILE, SECOND_MAP_FILE), strict=True):
            found.setdefault(f"{building}, {robot}", folder / file)
    return dict(sorted(found.items()))
