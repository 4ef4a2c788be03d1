"""What a merge leaves behind: the report, the merged map in the frame that was asked for, the picture."""

import io
import json

import numpy as np
import yaml
from PIL import Image

from algorithms.common.pose import Pose2
from algorithms.files.map_file import read_map
from algorithms.maps.grid_map import OCCUPIED_FROM, UNKNOWN
from algorithms.verdict.contradictions import near_walls
from app.drawing.palette import LIGHT
from app.model.merge_inputs import MergeInputs
from app.report import result_files as report
from app.report.export_frame import ExportFrame
from app.report.json_report import report_of


def test_the_overlay_shows_the_merged_map_upright_in_the_colours_of_the_legend(result):
    pixels = np.asarray(Image.open(io.BytesIO(report.overlay_png(result))).convert("RGB"))
    fusion = result.fusion
    assert pixels.shape[:2] == fusion.merged.cells.shape
    upright = pixels[::-1]  # row 0 at the bottom again
    ref_wall, mov_wall = fusion.ref_cells >= OCCUPIED_FROM, fusion.mov_cells >= OCCUPIED_FROM
    by_ref, by_mov = near_walls(fusion)
    unseen = fusion.mov_cells == UNKNOWN
    assert (upright[ref_wall & mov_wall] == LIGHT.agreed).all()
    assert (upright[(ref_wall & by_mov) | (mov_wall & by_ref)] == LIGHT.agreed).all()
    assert (upright[ref_wall & unseen & ~by_mov] == LIGHT.ref).all()
    assert (upright[mov_wall & (fusion.ref_cells == UNKNOWN) & ~by_ref] == LIGHT.mov).all()
    assert (upright[mov_wall & (fusion.ref_cells == 0) & ~by_ref] == LIGHT.conflict).all()
    assert (upright[unseen & (fusion.ref_cells == UNKNOWN)] == LIGHT.unknown).all()


def test_what_a_robot_would_act_upon_is_left_out_of_a_refused_result(result, small_case):
    told, inputs = report_of(result), MergeInputs.of(small_case)
    files = report.result_files(result, inputs, None, told, None)
    assert set(files) == {"overlay.png", "report.html", "report.json"}
    exported = ExportFrame().given(result.fusion.merged, result.T_ref_mov)
    files = report.result_files(result, inputs, None, told, exported)
    assert list(files)[-1] == "report.json"  # when it is there, the others are
    assert {"merged.yaml", "merged.pgm", "transform.yaml"} < set(files)


def test_the_map_the_transform_and_both_reports_speak_of_one_frame(result, inputs, tmp_path):
    frame = ExportFrame("mov", yaw=False, resolution=0.1)
    files = report.ResultFiles(result, inputs, None, frame).files
    for name in ("merged.pgm", "merged.yaml"):
        (tmp_path / name).write_bytes(files[name])
    merged, told = read_map(tmp_path / "merged.yaml"), json.loads(files["report.json"])["merged_map"]
    assert (merged.resolution, merged.origin.theta) == (0.1, 0.0)
    assert Pose2(**told["origin"]) == merged.origin
    assert Pose2(**told["T_ref_frame"]) == result.T_ref_mov
    assert told["frame"] == yaml.safe_load(files["transform.yaml"])["frame"] == "map2"
    assert told["cells_changed"] == told["now_wall"] + told["now_free"] > 0
    page = files["report.html"].decode()
    assert f"without yaw, in cells of 0.1 m: {told['cells_changed']:,} of " in page
    assert "--frame-id map2 --child-frame-id map1" in page
    for wall in result.fusion.merged.points[::50]:  # each is a wall again, at its place in map 2's frame
        assert merged.value_at(result.T_ref_mov.inverse().apply(wall)) >= OCCUPIED_FROM
