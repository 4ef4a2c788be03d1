"""What a merge leaves behind: the report, the transform, the picture."""

import io
import json
import math
from dataclasses import asdict, replace

import numpy as np
import pytest
import yaml
from drawn import T_REF_MOV
from PIL import Image

from algorithms.common.pose import Pose2
from algorithms.maps.grid_map import OCCUPIED_FROM, UNKNOWN
from algorithms.methods.registry import METHODS, merge
from app.drawing.palette import LIGHT
from app.model.merge_inputs import MergeInputs
from app.report import result_files as report
from app.report.html_report import report_page
from app.report.result_rows import numbers


def test_the_report_has_the_keys_that_other_programs_read(result):
    told = report.report_of(result, METHODS[result.method].defaults, load_s=0.5)
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
    told = json.loads(report.report_json(report.report_of(result)))["proof"]
    assert set(told) == {"nodes", "gap", "proven", "stopped", "swarm_found_it", "rivals"}
    assert told["proven"] is result.proven_optimal is True
    assert told["nodes"] == result.proof.nodes > 0
    assert told["gap"] == 0
    assert told["swarm_found_it"] is True
    one = replace(result.proof, rivals=np.array([[1.0, 2.0, 3.0]]), rival_values=np.array([4.0]))
    (rival,) = report.proof_of(replace(result, proof=one))["rivals"]
    assert rival == {"T_ref_mov": {"x": 1.0, "y": 2.0, "theta": 3.0}, "value": 4.0}


def test_a_proof_that_met_nothing_has_no_gap_in_json(result):
    nothing = replace(result.proof, best=None, best_value=-math.inf, proven=False)
    told = report.report_json(report.report_of(replace(result, proof=nothing)))
    assert json.loads(told, parse_constant=pytest.fail)["proof"]["gap"] is None


def test_the_report_says_how_the_plane_was_searched_and_what_is_proven_of_it(small_case):
    inputs = MergeInputs.pair(small_case.ref, small_case.mov, (), "flat")
    searched = merge(small_case.ref, small_case.mov)
    proving = replace(METHODS["whole-plane"].defaults, prove=True)
    proven = merge(small_case.ref, small_case.mov, config=proving)
    assert report.report_of(searched)["scan"] == asdict(searched.scan)
    assert report.report_of(searched)["proof"] is None
    told = report.report_of(proven)
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
    told = report.report_of(unproven)
    assert told["proof"] is None
    assert told["proven_optimal"] is False


def test_the_report_says_what_was_found(result):
    told = report.report_of(result)
    assert told["T_ref_mov"]["x"] == result.T_ref_mov.x
    assert told["T_ref_mov"]["x"] == pytest.approx(T_REF_MOV.x, abs=0.15)
    assert told["verdict"]["overlap_cells"] == result.fusion.overlap
    assert told["objective"] == result.value


def test_the_report_holds_every_setting_that_was_used(result):
    settings = report.report_of(result, METHODS["paper-argmax"].defaults)["settings"]
    assert settings["candidates"] == {"peaks": 1, "twins": False}
    assert settings["conflict"] == "occupied-wins"


@pytest.mark.parametrize("nothing", [math.nan, math.inf, -math.inf])
def test_a_number_that_is_not_finite_is_null_in_json(result, nothing):
    covariance = np.full((3, 3), nothing)
    broken = replace(result, covariance=covariance, value=nothing)
    told = json.loads(report.report_json(report.report_of(broken)), parse_constant=pytest.fail)
    assert told["covariance"][0][0] is None
    assert told["objective"] is None


def test_the_performance_index_counts_agreement_in_the_area_known_to_both(result):
    fusion = result.fusion
    known = (fusion.ref_cells != UNKNOWN) & (fusion.mov_cells != UNKNOWN)
    same = (fusion.ref_cells == fusion.mov_cells) & known
    index = report.report_of(result)["performance_index_at_estimate"]
    assert index == pytest.approx(same.sum() / known.sum())  # the drawn maps are free or wall, no more


def test_maps_that_share_no_cell_have_no_performance_index(result):
    nothing = np.full_like(result.fusion.mov_cells, UNKNOWN)
    apart = replace(result, fusion=replace(result.fusion, layers=(result.fusion.ref_cells, nothing)))
    assert report.report_of(apart)["performance_index_at_estimate"] is None


def test_a_map_that_was_resampled_stands_in_the_report(result, inputs):
    coarse = replace(result, fusion=replace(result.fusion, resolutions=(0.1, 0.05)))
    assert report.report_of(coarse)["resampled"] == {"map1": 0.1}
    assert report.report_of(result)["resampled"] == {}
    assert ("resampled", "map 1 from cells of 0.1 m to 0.05 m") in numbers(coarse, inputs)


def test_transform_yaml_reads_back_to_the_same_transform(result):
    told = yaml.safe_load(report.transform_yaml(result))
    assert Pose2(**told["T_ref_mov"]) == result.T_ref_mov
    assert told["accepted"] is True


def test_the_publisher_makes_map_1_the_parent_of_map_2(result):
    words = yaml.safe_load(report.transform_yaml(result))["publish"].split()
    assert words[:4] == ["ros2", "run", "tf2_ros", "static_transform_publisher"]
    given = dict(zip(words[4::2], words[5::2], strict=True))
    assert (given.pop("--frame-id"), given.pop("--child-frame-id")) == ("map1", "map2")
    T = result.T_ref_mov
    assert {name: float(value) for name, value in given.items()} == pytest.approx(
        {"--x": T.x, "--y": T.y, "--yaw": T.theta}, abs=1e-6
    )


def test_the_overlay_shows_the_merged_map_upright_in_the_colours_of_the_legend(result):
    pixels = np.asarray(Image.open(io.BytesIO(report.overlay_png(result))).convert("RGB"))
    fusion = result.fusion
    assert pixels.shape[:2] == fusion.merged.cells.shape
    upright = pixels[::-1]  # row 0 at the bottom again
    ref_wall, mov_wall = fusion.ref_cells >= OCCUPIED_FROM, fusion.mov_cells >= OCCUPIED_FROM
    unseen = fusion.mov_cells == UNKNOWN
    assert (upright[ref_wall & mov_wall] == LIGHT.agreed).all()
    assert (upright[ref_wall & unseen] == LIGHT.ref).all()
    assert (upright[mov_wall & (fusion.ref_cells == UNKNOWN)] == LIGHT.mov).all()
    assert (upright[mov_wall & (fusion.ref_cells == 0)] == LIGHT.conflict).all()
    assert (upright[unseen & (fusion.ref_cells == UNKNOWN)] == LIGHT.unknown).all()


def test_what_a_robot_would_act_upon_is_left_out_of_a_refused_result(result, small_case):
    told, inputs = report.report_of(result), MergeInputs.of(small_case)
    files = report.result_files(result, inputs, None, told, with_merged=False)
    assert set(files) == {"overlay.png", "report.html", "report.json"}
    files = report.result_files(result, inputs, None, told, with_merged=True)
    assert list(files)[-1] == "report.json"  # when it is there, the others are
    assert {"merged.yaml", "merged.pgm", "transform.yaml"} < set(files)
