"""Wrong pairs: of different buildings, the same ones every time, and told apart in what is written."""

import json
from dataclasses import replace

import pytest

from algorithms.common.pose import Pose2
from algorithms.files.truth_file import Truth
from app.cli.main import main
from app.evaluation.crossed_pairs import building_of, crossings


@pytest.mark.parametrize(
    ("source", "building"),
    [
        ("MIT_Stata B2_03 + B2_04", "MIT_Stata"),
        ("MIT_Stata B2_05", "MIT_Stata"),
        ("Intel Lab", "Intel Lab"),
        ("", "flat"),
    ],
)
def test_two_surveys_of_one_building_are_no_wrong_pair(source, building):
    assert building_of("flat", Truth(Pose2(), source=source)) == building


@pytest.fixture
def two_buildings(case_maker, small_case, strangers, tmp_path):
    """Two cases of a flat, one of a hall, and one that must be refused."""
    case_maker(small_case, "flat_1")
    case_maker(small_case, "flat_2")
    seen = replace(strangers.observations[0], observer=Pose2(1.0, -2.0, 0.3))
    case_maker(replace(strangers, ref=strangers.mov, observations=(seen,), truth=Truth(Pose2())), "hall_1")
    case_maker(strangers, "neg_1")
    return tmp_path / "cases"


def test_wrong_pairs_are_of_different_buildings_and_the_same_ones_every_time(two_buildings):
    found = crossings(two_buildings, 700)
    pairs = {(each.observer.name, each.observed.name) for each in found}
    flats = ("flat_1", "flat_2")
    assert pairs == {(flat, "hall_1") for flat in flats} | {("hall_1", flat) for flat in flats}
    assert crossings(two_buildings, 2) == crossings(two_buildings, 2)
    assert len(crossings(two_buildings, 2)) == 2


def test_a_folder_of_one_building_has_no_wrong_pairs(case_folder, capsys):
    assert main(["evaluate", str(case_folder), "--wrong-pairs", "3"]) == 2
    assert "wrong pairs need two buildings" in capsys.readouterr().err


def test_evaluate_tells_how_true_the_probabilities_are_and_what_became_of_wrong_pairs(
    two_buildings, tmp_path, capsys
):
    words = ["--wrong-pairs", "3", "--json", str(tmp_path / "out.json")]
    assert main(["evaluate", str(two_buildings), *words]) == 0
    told = json.loads((tmp_path / "out.json").read_text())
    assert [entry["truth"]["expected"] for entry in told["wrong_pairs"]] == ["refuse"] * 3
    assert all(" x " in entry["case"] for entry in told["wrong_pairs"])
    assert told["calibration"]["n"] == 4 + 3
    assert all(entry["report"]["verdict"]["quantities"] for entry in told["cases"])
    said = capsys.readouterr().out
    assert "wrong pairs: 3, accepted 0, failed 0" in said
    assert f"ECE {told['calibration']['ece']:.3f}" in said
    assert told["totals"]["flat"]["right_accepted"] == 2


def test_the_same_wrong_pairs_are_run_with_each_kind_of_knowledge(two_buildings, tmp_path, capsys):
    words = [
        "--knowledge",
        "initial,none",
        "--method",
        "harris",
        "--wrong-pairs",
        "2",
        "--json",
        str(tmp_path / "out.json"),
    ]
    assert main(["evaluate", str(two_buildings), *words]) == 0
    told = json.loads((tmp_path / "out.json").read_text())
    pairs = {
        kind: [each for each in told["wrong_pairs"] if each["knowledge"] == kind]
        for kind in ("initial", "none")
    }
    assert [each["case"] for each in pairs["initial"]] == [each["case"] for each in pairs["none"]]
    assert all(each["drawn"] for each in pairs["initial"])
    assert told["by_knowledge"]["none"]["calibration"]["n"] == 4 + 2
    assert capsys.readouterr().out.count("wrong pairs: 2, accepted 0, failed 0") == 2
