"""A fleet file names robots, maps and sightings; what is wrong in it is told with its place and a remedy."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from algorithms.common.errors import InputFileError
from algorithms.common.pose import Pose2
from algorithms.files.atomic_write import write_files
from algorithms.files.fleet_file import FLEET_FILE, fleet_to_bytes, read_fleet
from algorithms.files.fleet_truth_file import FleetTruth, fleet_truth_to_bytes, read_fleet_truth
from algorithms.files.map_file import map_to_bytes
from algorithms.observations.fleet import Fleet, FleetSighting
from algorithms.observations.priors import InitialPose

SIGHTING = """\
  - observer: {robot: r1, pose: [2.0, 2.0, 0.0]}
    observed: {robot: r2, pose: [3.0, 2.0]}
    measurement: {range: 1.0, bearing: 0.0}
"""
ROBOTS = "robots:\n  r1: {map: r1.yaml}\n  r2: {map: r2.yaml}\n"


@pytest.fixture
def folder(tmp_path: Path, small_case) -> Path:
    """A folder with the maps of two robots."""
    files = {**map_to_bytes(small_case.ref, "r1"), **map_to_bytes(small_case.mov, "r2")}
    write_files({tmp_path / name: data for name, data in files.items()})
    return tmp_path


def fleet_of(folder: Path, text: str):
    (folder / FLEET_FILE).write_text(text)
    return read_fleet(folder)


def test_robots_maps_and_sightings_are_read(folder, small_case):
    known = "{pose: [1, 2, 0.5], sigma: [0.5, 0.5, 0.1]}"
    robots = f"robots:\n  r1: {{map: r1.yaml}}\n  r2: {{map: r2.yaml, known: {known}}}\n"
    fleet = fleet_of(folder, f"anchor: r2\n{robots}sightings:\n{SIGHTING}{SIGHTING}")
    assert list(fleet.maps) == ["r1", "r2"]
    assert (fleet.maps["r1"].cells == small_case.ref.cells).all()
    assert fleet.anchor == "r2"
    assert [(seen.observer, seen.observed) for seen in fleet.sightings] == [("r1", "r2")] * 2
    assert fleet.sightings[0].observation.range == 1.0
    assert fleet.known["r2"].sigma_yaw == 0.1


@pytest.mark.parametrize("more", ["", "sightings:\n", "sightings: []\n"])
def test_a_fleet_may_have_no_sighting_and_the_first_robot_is_the_anchor(folder, more):
    fleet = fleet_of(folder, ROBOTS + more)
    assert fleet.sightings == ()
    assert fleet.anchor == "r1"


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("", "is empty"),
        ("robots: 3\n", "robots is '3'"),
        ("robots:\n  r1: {map: r1.yaml}\n", "2 to 50 robots, not 1"),
        ("robots:\n  r1: {map: r1.yaml}\n  r1: {map: r2.yaml}\n", "r1 stands there twice"),
        ("robots:\n" + "".join(f"  r{k}: {{map: m.yaml}}\n" for k in range(10_000)), "10,000 robots"),
        (ROBOTS.replace("r2.yaml", "r3.yaml"), "r3.yaml"),
        (ROBOTS.replace("map: r2.yaml", "mop: r2.yaml"), "robots.r2.mop is not a known key"),
        (ROBOTS + "anchor: r9\n", "anchor names 'r9'"),
        (ROBOTS + "sightings: 7\n", "sightings is '7'"),
        (ROBOTS + "sightings:\n  - 7\n", "sighting 1 is '7', not a mapping"),
        (ROBOTS + "sightings:\n" + SIGHTING.replace("robot: r2", "robot: r7"), "observed.robot is 'r7'"),
        (ROBOTS + "sightings:\n" + SIGHTING.replace("robot: r2", "robot: r1"), "seen itself"),
        (ROBOTS + "sightings:\n" + SIGHTING.replace("range: 1.0", "range: .nan"), "range is '.nan'"),
        (ROBOTS + "sightings:\n" + SIGHTING.replace("robot: r1, ", ""), "robot is missing"),
    ],
)
def test_what_is_wrong_is_told_with_its_place(folder, text, said):
    with pytest.raises(InputFileError) as told:
        fleet_of(folder, text)
    assert said in str(told.value)
    assert "\n" not in str(told.value)


def test_a_fleet_that_was_written_reads_back_equal(folder, small_case):
    (o,) = small_case.observations
    maps = {"r1": small_case.ref, "r 2": small_case.mov}
    known = {"r 2": InitialPose(Pose2(1.0, -2.0, 0.3), 0.5, 0.25, 0.1)}
    seen = (FleetSighting("r1", "r 2", o), FleetSighting("r 2", "r1", replace(o, bearing_back=None)))
    data = fleet_to_bytes(Fleet(maps, seen, known, "r 2"), {"r1": "r1.yaml", "r 2": "r2.yaml"})
    back = fleet_of(folder, data.decode())
    assert list(back.maps) == list(maps)
    assert (back.sightings, back.known, back.anchor) == (seen, known, "r 2")


def test_a_truth_that_was_written_reads_back_equal(tmp_path):
    truth = FleetTruth(
        {"r2": Pose2(1.0, 2.0, -0.5), "r 3": Pose2(0.1, 1e-7, 3.0)},
        {"r1": (1.0, 2.0), "r2": (-3.0, 0.5)},
        (("r 3",), ("r4", "r5")),
        (0, 7),
        0.25,
        0.1,
    )
    (tmp_path / "truth.yaml").write_bytes(fleet_truth_to_bytes(truth))
    assert read_fleet_truth(tmp_path / "truth.yaml") == truth
    assert truth.loose == {"r 3", "r4", "r5"}


@pytest.mark.parametrize(
    ("line", "said"),
    [
        ("lies: [a]", "lies is"),
        ("islands: [r4]", "islands is"),
        ("at: {r2: [1]}", "at.r2 is"),
        ("tolerance: {x_m: -1}", "tolerance.x_m is -1 m"),
    ],
)
def test_what_is_wrong_in_a_truth_is_told_with_its_place(tmp_path, line, said):
    (tmp_path / "truth.yaml").write_text(f"T_anchor_robot: {{r2: {{x: 1, y: 2, theta: 0}}}}\n{line}\n")
    with pytest.raises(InputFileError, match=said):
        read_fleet_truth(tmp_path / "truth.yaml")
