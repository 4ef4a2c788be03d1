"""A run as one page: what is recorded, that it is the same every time, and that texts stay texts."""

from __future__ import annotations

import base64
import io
import json
import re
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays
from PIL import Image

from algorithms.common.pose import Pose2
from algorithms.common.robot_names import WORDS, RobotNames
from algorithms.files.case_folder import Case
from algorithms.maps.grid_map import FREE, OCCUPIED, GridMap
from algorithms.methods.registry import METHODS, run
from algorithms.observations.observation import Observation
from app.cli.main import main
from app.drawing.grid_pixels import upright
from app.drawing.png import data_uri
from app.model import status_text as words
from app.model.merge_inputs import MergeInputs
from app.model.run_state import RunState
from app.page.export.export_panel import file_name
from app.report.replay.chart_recorder import thinned
from app.report.replay.html_page import ReplayMetadata, as_script, replay_html
from app.report.replay.recorder import PICTURE, record


def recorded(case: Case, method: str = "spectra-proven"):
    config = METHODS[method].defaults
    steps = run(method, case.ref, case.mov, case.observations, config)
    return record(steps, MergeInputs.of(case), config)


def page_of(case: Case, recording, name: str | None = None) -> str:
    inputs = replace(MergeInputs.of(case), name=case.name if name is None else name)
    config = METHODS["spectra-proven"].defaults
    return replay_html(
        recording, ReplayMetadata(inputs, "spectra-proven", config, 0, {"mapmeld": "1"})
    ).decode()


def told(page: str):
    """What the page's script will read."""
    text = re.search(r'<script id="recording" type="application/json">(.*?)</script>', page, re.S)
    return json.loads(text.group(1))


def captions(recording) -> list[str]:
    return [frame["hud"]["state"] for frame in recording["frames"] if "state" in frame.get("hud", {})]


def test_a_recorded_run_of_a_fleets_pair_names_the_robots(small_case):
    config = METHODS["spectra-proven"].defaults
    steps = list(run("spectra-proven", small_case.ref, small_case.mov, small_case.observations, config))
    inputs = replace(MergeInputs.of(small_case), names=RobotNames("Bob", "Alice"))
    kept = {key: value for key, value in record(steps, inputs, config).items() if key != "pictures"}
    said = json.dumps(kept)
    assert WORDS.search(said) is None
    assert "Bob saw Alice" in said
    plain = json.dumps(record(steps, MergeInputs.of(small_case), config)["frames"])
    assert "Robot 1 saw robot 2" in plain


@pytest.fixture(scope="module")
def recording(small_case):
    return recorded(small_case)


# ---- what is recorded


@pytest.mark.parametrize("method", METHODS)
def test_every_method_is_recorded_from_the_maps_to_the_verdict(small_case, method):
    played = recorded(small_case, method)
    times = [frame["t"] for frame in played["frames"]]
    assert times == sorted(times)
    assert times[-1] < played["length"]
    names = [mark["name"] for mark in played["marks"]]
    assert (names[0], names[-1]) == ("Maps", "Verdict")
    assert all(mark["t"] in times for mark in played["marks"])
    assert captions(played)[-1] == played["verdict"]
    assert played["frames"][-1]["table"]["rows"]


def test_its_captions_are_the_sentences_of_the_page(small_case, recording):
    config, said = METHODS["spectra-proven"].defaults, {words.SIDE_BY_SIDE, recording["verdict"]}
    story = RunState(config)
    for step in run("spectra-proven", small_case.ref, small_case.mov, small_case.observations, config):
        story.add(step)
        said.add(words.sentence(story))
    assert set(captions(recording)) <= said
    assert any(caption.startswith("Searching: ") for caption in captions(recording))


def test_the_swarm_contracts_in_the_recording_as_it_did_in_the_run(recording):
    clouds = [
        item
        for frame in recording["frames"]
        for items in frame.get("layers", {}).values()
        for item in items or ()
        if item["k"] == "cloud" and item["glide"] == "0"
    ]
    first, last = (np.array(cloud["p"]).reshape(-1, 3) for cloud in (clouds[0], clouds[-1]))
    assert len(clouds) > 5
    assert np.ptp(last[:, :2], axis=0).max() <= np.ptp(first[:, :2], axis=0).max()
    assert last[:, :2].std() < first[:, :2].std()


def test_the_climb_grows_and_the_axis_of_the_proof_stands_still(recording):
    charts = [chart for frame in recording["frames"] for chart in frame.get("curves", ())]
    climbs = [chart for chart in charts if chart["label"] == "iteration"]
    lengths = [sum(len(line["x"]) for line in chart["series"]) for chart in climbs]
    assert lengths == sorted(lengths)
    proofs = [chart["y"] for chart in charts if chart["label"].endswith("the whole circle")]
    assert len(proofs) > 1
    assert all(axis == proofs[0] for axis in proofs)


def test_a_search_over_the_plane_shows_the_best_of_every_turn_and_the_surface_of_the_turn_at_hand(small_case):
    played = recorded(small_case, "whole-plane")
    told = [frame["curves"] for frame in played["frames"] if frame.get("curves")]
    assert all(charts[0]["title"] == "Best agreement (m of wall) at every turn" for charts in told)
    surfaces = [chart for charts in told for chart in charts[1:]]
    assert all((chart["label"], chart["up"]) == ("Δx (m)", "Δy (m)") for chart in surfaces)
    *searched, last = [chart["title"] for chart in surfaces]
    assert len(set(searched)) == len(searched) > 1
    assert last in searched  # the best turn, looked at again
    assert all(chart["scale"]["ends"][1].endswith("m of wall") for chart in surfaces)


def test_the_same_run_is_the_same_file_byte_by_byte(small_case, recording):
    assert page_of(small_case, recorded(small_case)) == page_of(small_case, recording)


def test_a_replay_says_that_it_is_one_and_of_what(small_case, recording):
    data = told(page_of(small_case, recording))
    assert any("recording" in note for note in data["notes"])
    facts = dict(data["facts"])
    assert facts["method"] == "Spectra, swarm, proven optimum (spectra-proven)"
    assert facts["seed"] == "0"
    assert facts["made with"] == "mapmeld 1"
    assert data["verdict"].startswith("Merged")


def test_a_changed_setting_is_told_beside_what_it_usually_is(small_case):
    usual = METHODS["spectra-proven"].defaults
    config = replace(usual, swarm=replace(usual.swarm, particles=120))
    about = ReplayMetadata(MergeInputs.of(small_case), "spectra-proven", config, 0)
    changed = [row for row in about.settings() if row[2]]
    assert changed == [["swarm: N_p particles", "120", "instead of 400"]]


def test_pictures_of_a_large_map_are_bounded_and_lose_no_wall():
    cells = np.full((8, 2 * PICTURE + 100), FREE, dtype=np.int8)
    cells[:, 1501] = OCCUPIED
    grid = GridMap(cells, 0.05)
    seen = Observation(Pose2(2.0, 0.2), 4.0, 0.2, 2.0, 0.0, observed_heading=0.0, bearing_back=np.pi)
    played = recorded(Case("long", grid, grid, (seen,), "", None), "bilateral")
    walls = [picture for picture in played["pictures"] if picture["thin"] and picture["frame"] == "map1"]
    image = Image.open(io.BytesIO(base64.b64decode(walls[0]["data"].split(",")[1]))).convert("RGBA")
    assert max(image.size) <= PICTURE
    assert np.asarray(image)[..., 3].any(axis=0).sum() == 1  # one column of walls, still


# ---- laws


@given(st.recursive(st.text(), lambda inner: st.lists(inner) | st.dictionaries(st.text(), inner)))
def test_any_text_comes_back_from_the_script_and_none_of_it_is_markup(data):
    text = as_script(data)
    assert "<" not in text
    assert json.loads(text) == data


@given(arrays.arrays(np.uint8, st.tuples(st.integers(1, 6), st.integers(1, 9), st.just(4))))
def test_a_picture_comes_back_pixel_by_pixel_top_row_first(pixels):
    data = base64.b64decode(data_uri(pixels).removeprefix("data:image/png;base64,"))
    assert np.array_equal(np.asarray(Image.open(io.BytesIO(data)).convert("RGBA")), upright(pixels))


@given(st.lists(st.floats(0, 1), min_size=2, max_size=200), st.integers(2, 50))
def test_a_thinned_curve_keeps_its_ends_and_its_peak(values, most):
    y = np.array(values)
    x, kept = thinned(np.arange(len(y), dtype=float), y, most)
    assert (x[0], x[-1]) == (0, len(y) - 1)
    assert kept.max() == y.max()
    assert len(x) <= max(most, 1) + 2
    assert np.array_equal(kept, y[x.astype(int)])


@given(st.text())
def test_any_name_of_a_pair_makes_a_file_name(name):
    assert re.fullmatch(r"replay(_[\w-]+)?\.html", file_name(name))
    assert len(file_name(name)) <= 80


# ---- texts are texts, and nothing is asked of anybody


@pytest.mark.parametrize(
    "name", ["</script><script>alert(1)</script>", "<!--", "{{recording}}", "/*{{ink}}*/"]
)
def test_a_name_is_never_markup_nor_a_slot_of_the_page(small_case, recording, name):
    plain, page = page_of(small_case, recording), page_of(small_case, recording, name)
    assert told(page)["name"] == name
    assert page.count("<script") == plain.count("<script")
    assert "alert(1)</script>" not in page


def test_the_page_may_load_nothing(small_case, recording):
    page = page_of(small_case, recording)
    assert "default-src 'none'" in page
    assert not re.search(r"(src|href)\s*=\s*[\"']?(https?:)?//", page)
    assert "{{" not in page.replace(as_script(told(page)), "")


# ---- the command


def test_the_command_writes_the_page_of_a_case_folder(case_folder, tmp_path, capsys):
    out = tmp_path / "new" / "merge.html"
    assert main(["replay", str(case_folder), "--out", str(out), "--seed", "3"]) == 0
    said = capsys.readouterr().out
    assert said.startswith("Merged")
    data = told(out.read_text(encoding="utf-8"))
    assert data["name"] == case_folder.name
    assert data["seed"] == 3
    again = tmp_path / "again.html"
    assert main(["replay", str(case_folder), "--out", str(again), "--seed", "3"]) == 0
    assert again.read_bytes() == out.read_bytes()


def test_the_command_takes_two_maps_as_merge_does(case_folder, tmp_path):
    maps = [str(case_folder / name) for name in ("map1.yaml", "map2.yaml")]
    seen = f"--observation={case_folder}/observation.yaml"
    out = tmp_path / "merge.html"
    assert main(["replay", *maps, seen, "--out", str(out), "--method", "bilateral"]) == 0
    assert told(out.read_text(encoding="utf-8"))["name"] == "map1 + map2"


@pytest.mark.parametrize(
    ("more", "finding"),
    [
        (["ofice_r2_r1", "--out", "a.html"], "did you mean office_r2_r1?"),
        (["office_r2_r1", "--out", "a.txt"], "let its name end in .html"),
        (["office_r2_r1", "--out", "a.html", "--resolution", "0.1"], "give both maps"),
        (["office_r2_r1", "--out", "a.html", "--unknown-grey", "205"], "give both maps"),
    ],
)
def test_what_cannot_be_recorded_is_refused_with_a_remedy(more, finding, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(SystemExit) as left:
        main(["replay", *more])
    assert left.value.code == 2
    assert finding in capsys.readouterr().err
    assert list(tmp_path.iterdir()) == []


def test_pictures_lie_where_the_cells_are(small_case, recording):
    floor = next(picture for picture in recording["pictures"] if picture["frame"] == "map1")
    grid, anchor = small_case.ref, MergeInputs.of(small_case).at.x_ref
    middle = grid.origin.apply(np.array([grid.width, grid.height]) * grid.resolution / 2) - anchor
    assert floor["at"] == pytest.approx([*middle.tolist(), grid.origin.theta], abs=1e-3)
