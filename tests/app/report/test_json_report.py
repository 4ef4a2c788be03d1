"""What report.json says: what was found, of which files, when, and with which settings."""

import hashlib
import json
import math
from dataclasses import asdict, replace

import numpy as np
import pytest
from drawn import T_REF_MOV

from algorithms.common.robot_names import RobotNames
from algorithms.files.case_folder import read_case
from algorithms.maps.grid_map import UNKNOWN
from algorithms.methods.registry import METHODS, merge
from app.model.merge_inputs import MergeInputs
from app.report.export_frame import ExportFrame
from app.report.html_report import report_page
from app.report.json_report import proof_of, report_json, report_of
from app.report.result_rows import numbers


def test_the_report_has_the_keys_that_other_programs_read(result):
    told = report_of(result, METHODS[result.method].defaults, load_s=0.5)
    assert list(told)[:8] == [
        *("T_ref_mov", "covariance", "verdict", "objective"),
        *("proven_optimal", "method", "seed", "timings_s"),
    ]
    assert set(told["T_ref_mov"]) == {"x", "y", "theta"}
    assert np.shape(told["covariance"]) == (3, 3)
    assert {"accepted", "reason", "acceptance_index", "overlap_cells", "ambiguity"} <= set(told["verdict"])
    assert {"shared_wall", "contradiction", "rigid_contradiction", "rival"} <= set(told["verdict"])
    assert told["timings_s"]["load"] == 0.5
    assert {"augment", "spectra", "search", "refine", "fuse"} <= set(told["timings_s"])


def test_the_report_says_how_the_proof_ended(result):
    told = json.loads(report_json(report_of(result)))["proof"]
    assert set(told) == {"nodes", "gap", "proven", "stopped", "swarm_found_it", "rivals"}
    assert told["proven"] is result.proven_optimal is True
    assert told["nodes"] == result.proof.nodes > 0
    assert told["gap"] == 0
    assert told["swarm_found_it"] is True
    one = replace(result.proof, rivals=np.array([[1.0, 2.0, 3.0]]), rival_values=np.array([4.0]))
    (rival,) = proof_of(replace(result, proof=one))["rivals"]
    assert rival == {"T_ref_mov": {"x": 1.0, "y": 2.0, "theta": 3.0}, "value": 4.0}


def test_a_proof_that_met_nothing_has_no_gap_in_json(result):
    nothing = replace(result.proof, best=None, best_value=-math.inf, proven=False)
    told = report_json(report_of(replace(result, proof=nothing)))
    assert json.loads(told, parse_constant=pytest.fail)["proof"]["gap"] is None


def test_the_report_says_how_the_plane_was_searched_and_what_is_proven_of_it(small_case):
    inputs = MergeInputs.pair(small_case.ref, small_case.mov, (), "flat")
    searched = merge(small_case.ref, small_case.mov)
    proving = replace(METHODS["whole-plane"].defaults, prove=True)
    proven = merge(small_case.ref, small_case.mov, config=proving)
    assert report_of(searched)["scan"] == asdict(searched.scan)
    assert report_of(searched)["proof"] is None
    told = report_of(proven)
    assert told["proven_optimal"]
    assert told["proof"]["nodes"] == proven.proof.nodes > 0
    assert dict(numbers(searched, inputs))["optimum"].startswith("searched, not proven: turns in steps of 3°")
    rows = dict(numbers(proven, inputs))
    assert rows["optimum"].startswith("proven to a cell")
    assert rows["blocks bounded"] == f"{proven.proof.nodes:,}"
    page = report_page(proven, inputs, proving, told).decode()
    assert f"{proven.proof.nodes:,} blocks were bounded" in page


def test_a_method_without_a_proof_reports_none(small_case):
    unproven = merge(small_case.ref, small_case.mov, small_case.observations, "spectra-swarm")
    told = report_of(unproven)
    assert told["proof"] is None
    assert told["proven_optimal"] is False


def test_the_report_says_what_was_found(result):
    told = report_of(result)
    assert told["T_ref_mov"]["x"] == result.T_ref_mov.x
    assert told["T_ref_mov"]["x"] == pytest.approx(T_REF_MOV.x, abs=0.15)
    assert told["verdict"]["overlap_cells"] == result.fusion.overlap
    assert told["objective"] == result.value


def test_the_report_holds_every_setting_that_was_used(result):
    settings = report_of(result, METHODS["paper-argmax"].defaults)["settings"]
    assert settings["candidates"] == {"peaks": 1, "twins": False}
    assert settings["conflict"] == "occupied-wins"


@pytest.mark.parametrize("nothing", [math.nan, math.inf, -math.inf])
def test_a_number_that_is_not_finite_is_null_in_json(result, nothing):
    covariance = np.full((3, 3), nothing)
    broken = replace(result, covariance=covariance, value=nothing)
    told = json.loads(report_json(report_of(broken)), parse_constant=pytest.fail)
    assert told["covariance"][0][0] is None
    assert told["objective"] is None


def test_the_performance_index_counts_agreement_in_the_area_known_to_both(result):
    fusion = result.fusion
    known = (fusion.ref_cells != UNKNOWN) & (fusion.mov_cells != UNKNOWN)
    same = (fusion.ref_cells == fusion.mov_cells) & known
    index = report_of(result)["performance_index_at_estimate"]
    assert index == pytest.approx(same.sum() / known.sum())  # the drawn maps are free or wall, no more


def test_maps_that_share_no_cell_have_no_performance_index(result):
    nothing = np.full_like(result.fusion.mov_cells, UNKNOWN)
    apart = replace(result, fusion=replace(result.fusion, layers=(result.fusion.ref_cells, nothing)))
    assert report_of(apart)["performance_index_at_estimate"] is None


def test_a_map_that_was_resampled_stands_in_the_report(result, inputs):
    coarse = replace(result, fusion=replace(result.fusion, resolutions=(0.1, 0.05)))
    assert report_of(coarse)["resampled"] == {"map1": 0.1}
    assert report_of(result)["resampled"] == {}
    assert ("resampled", "map 1 from cells of 0.1 m to 0.05 m") in numbers(coarse, inputs)


def test_the_report_tells_the_files_by_their_bytes_when_it_was_made_and_what_is_no_default(
    case_folder, result, monkeypatch
):
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "0")
    pair, defaults = MergeInputs.of(read_case(case_folder)), METHODS[result.method].defaults
    config = replace(defaults, augment=replace(defaults.augment, spread=2.5))
    told = report_of(result, config, pair=pair)
    assert told["made"] == "1970-01-01T00:00:00Z"
    assert told["changed_settings"] == {"augment.spread": {"value": 2.5, "default": defaults.augment.spread}}
    read = {"map1": ["map1.yaml", "map1.pgm"], "map2": ["map2.yaml", "map2.pgm"]}
    assert told["files"] == {
        what: [
            {"name": name, "sha256": hashlib.sha256((case_folder / name).read_bytes()).hexdigest()}
            for name in names
        ]
        for what, names in (read | {"observation": ["observation.yaml"]}).items()
    }
    assert report_of(result, defaults)["changed_settings"] == {}


def test_a_sighting_that_was_changed_by_hand_is_no_longer_that_of_its_file(case_folder):
    pair = MergeInputs.of(read_case(case_folder))
    assert "observation" in pair.files
    assert "observation" in pair.knowing(pair.pool, "nothing").files  # it is only not used
    moved = replace(pair, observations=(replace(pair.observations[0], range=1.0),))
    assert set(moved.files) == {"map1", "map2"}


def test_the_report_calls_the_robots_by_their_names(result, inputs):
    bent = replace(result, verdict=replace(result.verdict, reason="Merged: map 2 lies in map 1."))
    pair = replace(inputs, names=RobotNames("Bob", "Alice"))
    exported = ExportFrame("mov").given(result.fusion.merged, result.T_ref_mov)
    told = report_of(bent, inputs={"pair": "a"}, pair=pair, exported=exported)
    assert told["verdict"]["reason"] == "Merged: Alice's map lies in Bob's map."
    assert told["inputs"] == {"pair": "a", "robot1": "Bob", "robot2": "Alice"}
    assert told["merged_map"]["frame"] == "alice/map"
    assert report_of(bent, pair=inputs)["verdict"]["reason"] == bent.verdict.reason
