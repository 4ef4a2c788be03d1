"""A fleet file names robots, maps and sightings; what is wrong in it is told with its place and a remedy."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from algorithms.common.errors import InputFileError
from algorithms.common.pose import Pose2
from algorithms.common.robot_names import LONGEST_NAME, is_name
from algorithms.files.atomic_write import write_files
from algorithms.files.fleet_file import FLEET_FILE, fleet_from_bytes, fleet_to_bytes, read_fleet
from algorithms.files.fleet_truth_file import FleetTruth, fleet_truth_to_bytes, read_fleet_truth
from algorithms.files.map_file import map_to_bytes
from algorithms.maps.grid_map import GridMap
from algorithms.observations.fleet import (
    MOST_PRIORS,
    MOST_ROBOTS,
    MOST_SIGHTINGS,
    Fleet,
    FleetPrior,
    FleetSighting,
)
from algorithms.observations.observation import Observation
from algorithms.observations.priors import InitialPose, NearPlace, Prior, TurnPrior

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
    fleet = fleet_of(folder, f"anchor: r2\n{ROBOTS}sightings:\n{SIGHTING}{SIGHTING}")
    assert list(fleet.maps) == ["r1", "r2"]
    assert (fleet.maps["r1"].cells == small_case.ref.cells).all()
    assert fleet.anchor == "r2"
    assert [(seen.observer, seen.observed) for seen in fleet.sightings] == [("r1", "r2")] * 2
    assert fleet.sightings[0].observation.range == 1.0
    assert fleet.priors == ()


def test_what_else_is_known_of_two_robots_is_read(folder):
    known = """\
known:
  - {of: r2, in: r1, turn: {yaw: 0.3}}
  - {of: r1, in: r2, near: {in: [1, 2], of: [3, 4], radius: 0.5}, initial: {pose: [1, 2, 0.5]}}
"""
    assert fleet_of(folder, ROBOTS + known).priors == (
        FleetPrior("r1", "r2", TurnPrior(0.3)),
        FleetPrior("r2", "r1", InitialPose(Pose2(1.0, 2.0, 0.5))),
        FleetPrior("r2", "r1", NearPlace(1.0, 2.0, 3.0, 4.0, 0.5)),
    )


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
        (ROBOTS.replace("r2:", '" r2":'), "is no name for a robot"),
        (ROBOTS + "known: {of: r2, in: r1, turn: {yaw: 0}}\n", "give a list of at most 200"),
        (ROBOTS + "known: [7]\n", "known 1 is '7', not a mapping"),
        (ROBOTS + "known: [{of: r2, in: r1}]\n", "known 1: initial or turn or near is missing"),
        (ROBOTS + "known: [{of: r7, in: r1, turn: {yaw: 0}}]\n", "known 1: of is 'r7'"),
        (ROBOTS + "known: [{of: r2, turn: {yaw: 0}}]\n", "known 1: in is missing"),
        (ROBOTS + "known: [{of: r2, in: r2, turn: {yaw: 0}}]\n", "known 1: r2 is named twice"),
        (ROBOTS + "known: [{of: r2, in: r1, tern: {yaw: 0}}]\n", "known 1: tern is not a known key"),
        (
            ROBOTS + "known: [{of: r2, in: r1, turn: {yaw: 0, sd: 1}}]\n",
            "known 1: turn.sd is not a known key",
        ),
        (ROBOTS + "known: [{of: r2, in: r1, turn: {yaw: 90}}]\n", "known 1: turn: yaw is 90 rad"),
        (ROBOTS + "sightings:\n" + SIGHTING.replace("[2.0, 2.0, 0.0]", "[2.0]"), "of r1 in r1's map; m"),
        (ROBOTS + "sightings:\n" + SIGHTING.replace("range: 1.0", "range: x"), "of r2 from r1 in metres"),
        (ROBOTS + "known: [{of: r2, in: r1, turn: {}}]\n", "how far r2's frame is turned in r1's"),
        (
            ROBOTS + "known: [{of: r2, in: r1, near: {map1: [0, 0]}}]\n",
            "known 1: near.map1 is not a known key",
        ),
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
    rough = InitialPose(Pose2(1.0, -2.0, 0.3), 0.5, 0.25, 0.1, 7.0, -1e-7), TurnPrior(-0.1, 0.2)
    priors = *(FleetPrior("r1", "r 2", one) for one in rough), FleetPrior("r 2", "r1", NearPlace(1, 2, 3, 4))
    seen = (FleetSighting("r1", "r 2", o), FleetSighting("r 2", "r1", replace(o, bearing_back=None)))
    data = fleet_to_bytes(Fleet(maps, seen, priors, "r 2"), {"r1": "r1.yaml", "r 2": "r2.yaml"})
    back = fleet_of(folder, data.decode())
    assert list(back.maps) == list(maps)
    assert (back.sightings, back.priors, back.anchor) == (seen, priors, "r 2")


NUMBER = st.floats(-1e4, 1e4)
TURN = st.floats(-6.28, 6.28)
DEVIATION = st.floats(1e-3, 3.0)
PRIORS: st.SearchStrategy[Prior] = st.one_of(
    st.builds(TurnPrior, TURN, DEVIATION),
    st.builds(NearPlace, NUMBER, NUMBER, NUMBER, NUMBER, DEVIATION),
    st.builds(
        InitialPose, st.builds(Pose2, NUMBER, NUMBER, TURN), DEVIATION, DEVIATION, DEVIATION, NUMBER, NUMBER
    ),
)
GRID = GridMap(np.zeros((3, 3), dtype=np.int8), 0.1)


@given(st.lists(st.text(max_size=70).filter(is_name), min_size=2, max_size=5, unique=True), st.data())
def test_whatever_the_robots_are_called_and_is_known_of_them_reads_back_equal(called, data):
    pairs = st.permutations(called)
    priors = tuple(
        FleetPrior(*data.draw(pairs)[:2], prior) for prior in data.draw(st.lists(PRIORS, max_size=4))
    )
    fleet = Fleet(dict.fromkeys(called, GRID), (), priors, data.draw(st.sampled_from(called)))
    data = fleet_to_bytes(fleet, {name: f"{number}.yaml" for number, name in enumerate(called)})
    back = fleet_from_bytes(FLEET_FILE, data, lambda file: GRID)
    assert (list(back.maps), back.priors, back.anchor) == (called, priors, fleet.anchor)


def test_the_largest_fleet_with_the_longest_names_and_numbers_reads_back():
    called = [f"{number:0{LONGEST_NAME}d}" for number in range(MOST_ROBOTS)]
    long, third = -1234.5678901234567, 1 / 3
    o = Observation(Pose2(long, long, -third), long, long, -long, -third, -third, third, third, -third)
    rough = InitialPose(Pose2(long, long, -third), third, third, third, long, long)
    fleet = Fleet(
        dict.fromkeys(called, GRID),
        tuple(FleetSighting(*called[-2:], o) for _ in range(MOST_SIGHTINGS)),
        tuple(FleetPrior(*called[-2:], rough) for _ in range(MOST_PRIORS)),
    )
    data = fleet_to_bytes(fleet, {name: f"{name}.yaml" for name in called})
    back = fleet_from_bytes(FLEET_FILE, data, lambda file: GRID)
    assert (back.sightings, back.priors) == (fleet.sightings, fleet.priors)


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
