"""A fleet as a zip: it reads back to equal values, and what is wrong with one is told in a line."""

from __future__ import annotations

import re

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from repository import ROOT

from algorithms.common.errors import InputFileError, MapMergeError, TooLargeError
from algorithms.files import fleet_archive
from algorithms.files.fleet_archive import files_of_zip, fleet_from_files, fleet_to_files
from algorithms.files.fleet_file import FLEET_FILE, read_fleet
from algorithms.maps.grid_map import GridMap
from algorithms.observations.fleet import Fleet
from app.report.result_files import zip_bytes


@pytest.fixture(scope="module")
def fleet() -> Fleet:
    return read_fleet(ROOT / "sample_maps" / "home_fleet_island")


@pytest.fixture(scope="module")
def files(fleet: Fleet) -> dict[str, bytes]:
    return fleet_to_files(fleet)


def same(a: Fleet, b: Fleet) -> bool:
    maps = all(np.array_equal(a.maps[name].cells, b.maps[name].cells) for name in a.maps)
    told = a.sightings == b.sightings and a.priors == b.priors and a.anchor == b.anchor
    return list(a.maps) == list(b.maps) and maps and told


def from_zip(content: bytes, folder: str = "") -> Fleet:
    return fleet_from_files(files_of_zip("mine.zip", content), f"{folder}{FLEET_FILE}")


@pytest.mark.parametrize("folder", ["", "fleet/", "a/b/c/"])
def test_a_fleet_reads_back_from_its_zip_in_whatever_folder(fleet, files, folder):
    content = zip_bytes({f"{folder}{name}": data for name, data in files.items()})
    assert same(from_zip(content, folder), fleet)


def test_maps_in_other_folders_are_found_by_their_names_unless_two_have_the_same(fleet, files):
    apart = {name if name == FLEET_FILE else f"maps/{name}": data for name, data in files.items()}
    assert same(from_zip(zip_bytes(apart)), fleet)
    with pytest.raises(InputFileError, match=r"names robot_1\.yaml, of which there are several"):
        from_zip(zip_bytes({**apart, "old/robot_1.yaml": b""}))


@pytest.mark.parametrize("path", ["../fleet.yaml", "/etc/fleet.yaml", "a/../../fleet.yaml", "..\\fleet.yaml"])
def test_a_zip_that_names_a_file_outside_of_itself_is_refused(path):
    with pytest.raises(InputFileError, match="outside of itself"):
        files_of_zip("mine.zip", zip_bytes({path: b"robots:"}))


@pytest.mark.parametrize(
    ("gone", "said"),
    [
        ("robot_2.yaml", r"names robot_2\.yaml, which is not there"),
        ("robot_3.pgm", r"names robot_3\.pgm, which is not there"),
    ],
)
def test_a_file_that_is_missing_is_named(files, gone, said):
    left = {name: data for name, data in files.items() if name != gone}
    with pytest.raises(InputFileError, match=said):
        fleet_from_files(left, FLEET_FILE)


def test_what_would_unpack_to_too_much_is_refused_before_it_is_unpacked(files, monkeypatch):
    monkeypatch.setattr(fleet_archive, "MOST_UNPACKED", 10_000)
    with pytest.raises(InputFileError, match="give at most"):
        files_of_zip("mine.zip", zip_bytes(files))


def test_one_map_for_many_robots_is_refused_before_it_fills_the_memory(monkeypatch):
    grid = GridMap(np.zeros((50, 50), dtype=np.int8), 0.1)
    files = fleet_to_files(Fleet({"r1": grid, "r2": grid}))
    robots = ", ".join(f"r{number}: {{map: ./robot_1.yaml}}" for number in range(50))
    files = {**files, FLEET_FILE: f"robots: {{{robots}}}".encode()}
    assert len(fleet_from_files(files, FLEET_FILE).maps) == 50
    monkeypatch.setattr(fleet_archive, "MOST_CELLS", 49 * 2500)
    with pytest.raises(TooLargeError, match=r"fleet\.yaml: its maps have more than"):
        fleet_from_files(files, FLEET_FILE)


@settings(max_examples=60, deadline=None)
@given(st.data())
def test_a_damaged_zip_is_a_fleet_or_one_line_on_what_is_wrong(files, data):
    content = bytearray(zip_bytes(files))
    for _ in range(data.draw(st.integers(1, 6))):
        content[data.draw(st.integers(0, len(content) - 1))] = data.draw(st.integers(0, 255))
    cut = data.draw(st.integers(0, len(content)))
    said = "fleet.yaml"
    try:
        unpacked = files_of_zip("mine.zip", bytes(content[:cut]))
        if FLEET_FILE in unpacked:
            fleet_from_files(unpacked, FLEET_FILE)
    except MapMergeError as error:
        said = str(error)
    assert re.match(r"mine\.zip|fleet\.yaml|robot_\d\.(yaml|pgm)", said)
    assert "\n" not in said
