"""Fleets are counted by robots: right, refused, loose and wrong, as their truth has it."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from algorithms.common.pose import Pose2
from algorithms.files.fleet_truth_file import FleetTruth
from algorithms.fleets.fleet_merge import merge_fleet
from algorithms.observations.fleet import Fleet, FleetSighting
from algorithms.simulator.buildings.floor_plan import Building
from algorithms.simulator.fleets.fleet_scenario import SimulatedFleet
from algorithms.simulator.fleets.sample_fleets import fleet_files
from app.cli.main import main
from app.evaluation.fleet_evaluation import judged


@pytest.fixture(scope="module")
def fleet(small_case, strangers) -> Fleet:
    """Ann saw Bob; of Dan, who is of another building, it is only said."""
    maps = {"ann": small_case.ref, "bob": small_case.mov, "dan": strangers.mov}
    seen = (("bob", small_case.observations[0]), ("dan", strangers.observations[0]))
    return Fleet(maps, tuple(FleetSighting("ann", name, o) for name, o in seen))


@pytest.fixture(scope="module")
def truth(small_case) -> FleetTruth:
    o, T = small_case.observations[0], small_case.truth.T_ref_mov
    at = {"bob": (o.observed_x, o.observed_y)}
    return FleetTruth({"bob": T, "dan": Pose2(9.0, 9.0, 1.0)}, at, (("dan",),), (1,))


def test_who_is_placed_right_and_who_stands_alone_is_counted(fleet, truth):
    found = judged("three", fleet, truth, merge_fleet(fleet))
    assert (found.right, found.loose, found.refused, found.wrong) == (("ann", "bob"), ("dan",), (), ())
    assert found.lies_used == found.truths_left_out == ()


def test_a_robot_that_is_placed_elsewhere_is_wrong(fleet, truth):
    T = truth.T_anchor_robot["bob"]
    moved = {**truth.T_anchor_robot, "bob": Pose2(T.x + 1.0, T.y, T.theta)}
    found = judged("three", fleet, replace(truth, T_anchor_robot=moved), merge_fleet(fleet))
    assert found.wrong == ("bob",)


def test_a_robot_that_true_sightings_tie_and_that_is_not_placed_is_refused(fleet, truth):
    found = judged("three", fleet, replace(truth, islands=(), lies=()), merge_fleet(fleet))
    assert found.refused == ("dan",)
    assert found.truths_left_out == (1,)


def test_the_command_prints_a_table_and_leaves_the_numbers(fleet, truth, tmp_path: Path, capsys):
    folder = tmp_path / "fleets" / "drawn_1"
    folder.mkdir(parents=True)
    tied = frozenset({"ann", "bob"})
    empty = Building("none", np.zeros((1, 1), np.uint8), 0.05, np.zeros((0, 2)))
    made = SimulatedFleet(fleet, truth.T_anchor_robot, truth.at, truth.lies, tied, empty, {}, ())
    for name, data in fleet_files(made).items():
        (folder / name).write_bytes(data)
    out = tmp_path / "out.json"
    assert main(["evaluate", str(tmp_path / "fleets"), "--json", str(out)]) == 0
    header, row, overall = capsys.readouterr().out.splitlines()
    assert header.split()[:4] == ["group", "fleets", "right", "refused"]
    assert row.split()[:6] == ["drawn", "1", "2", "0", "1", "0"]
    assert overall.split()[0] == "overall"
    assert json.loads(out.read_text())["totals"]["overall"]["wrong"] == 0
