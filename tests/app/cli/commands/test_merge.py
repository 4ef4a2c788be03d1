"""``mapmeld merge``: what it takes, what it leaves, what it says and with which exit status."""

import io
import json
import re
import sys
from dataclasses import replace

import numpy as np
import pytest
import yaml
from commandline import inputs, usage_error
from PIL import Image

from algorithms.common.errors import NoAnswerError
from algorithms.common.pose import Pose2
from algorithms.common.robot_names import WORDS
from algorithms.files.case_folder import read_case
from algorithms.files.map_file import read_map
from algorithms.files.observation_file import write_observations
from algorithms.maps.grid_map import FREE, OCCUPIED
from algorithms.methods import registry as methods
from algorithms.methods.registry import METHODS
from app.cli.main import main

ALWAYS = {"overlay.png", "report.html", "report.json"}
ALL_FILES = {"merged.yaml", "merged.pgm", "transform.yaml"} | ALWAYS


def of_a_refusal(folder) -> set[str]:
    """What a refused merge leaves: what it suggests, too."""
    suggested = json.loads((folder / "suggestions.json").read_text())
    assert suggested
    return ALWAYS | {"suggestions.json"} | {each["picture"] for each in suggested}


def test_a_merge_leaves_its_files_and_ends_with_0(case_folder, tmp_path, capsys):
    assert main(["merge", *inputs(case_folder), "--out", str(tmp_path / "new" / "out")]) == 0
    out = tmp_path / "new" / "out"
    assert {path.name for path in out.iterdir()} == ALL_FILES
    report = json.loads((out / "report.json").read_text())
    said = capsys.readouterr()
    assert said.out.startswith(report["verdict"]["reason"])
    assert said.err == ""  # no bar where nobody looks at it
    assert yaml.safe_load((out / "transform.yaml").read_text())["T_ref_mov"] == report["T_ref_mov"]


def test_a_merge_says_what_was_maximised_and_whether_a_better_place_is_ruled_out(
    case_folder, tmp_path, capsys
):
    assert main(["merge", *inputs(case_folder), "--out", str(tmp_path)]) == 0
    assert re.search(
        r"^agreement \d+\.\d m, proven \([\d,]+ blocks bounded\)$", capsys.readouterr().out, re.M
    )
    main(["merge", *inputs(case_folder), "--out", str(tmp_path), "--method", "spectra-swarm"])
    assert re.search(r"^Γ [\d.]+$", capsys.readouterr().out, re.M)


def test_a_refusal_is_told_with_what_would_help(strangers_folder, tmp_path, capsys):
    assert main(["merge", *inputs(strangers_folder), "--out", str(tmp_path)]) == 1
    told = json.loads((tmp_path / "report.json").read_text())
    assert told["verdict"]["outcome"] == "refused"
    lines = capsys.readouterr().out.splitlines()
    assert lines[0] == told["verdict"]["reason"]
    assert lines[1].startswith("Are these maps of one building?")


def test_a_merge_is_accepted_from_the_likelihood_that_is_asked_for(bent_folder, tmp_path):
    asked = ["merge", *inputs(bent_folder), "--out", str(tmp_path)]
    assert main([*asked, "--accept-from", "0.999"]) == 1
    told = json.loads((tmp_path / "report.json").read_text())["verdict"]
    assert told["outcome"] == "refused"
    assert told["probability"] < 0.999
    assert main([*asked, "--accept-from", str(told["probability"] - 0.001)]) == 0


def test_a_bent_merge_is_a_merge_unless_it_is_to_be_strict(bent_folder, tmp_path, capsys):
    asked = ["merge", *inputs(bent_folder), "--out", str(tmp_path)]
    assert main(asked) == 0
    assert json.loads((tmp_path / "report.json").read_text())["verdict"]["outcome"] == "merged, bent"
    assert "double" in capsys.readouterr().out
    assert {path.name for path in tmp_path.iterdir()} == ALL_FILES
    assert main([*asked, "--strict"]) == 1
    assert "a bent merge is not wanted" in capsys.readouterr().out
    assert {path.name for path in tmp_path.iterdir()} == ALWAYS  # it is right: there is nothing to choose
    assert main([*asked, "--strict", "--force"]) == 1
    assert {path.name for path in tmp_path.iterdir()} == ALL_FILES


def test_a_map_that_was_read_wrongly_is_warned_of_and_cured_by_the_grey_for_unknown(
    case_folder, small_case, tmp_path, capsys
):
    cells = small_case.mov.cells
    greys = np.select([cells == FREE, cells == OCCUPIED], [254, 0], 216).astype(np.uint8)
    Image.fromarray(greys[::-1]).save(tmp_path / "grey.png")
    meta = yaml.safe_load((case_folder / "map2.yaml").read_text())
    (tmp_path / "grey.yaml").write_text(yaml.safe_dump({**meta, "image": "grey.png"}))
    words = [
        case_folder / "map1.yaml",
        tmp_path / "grey.yaml",
        "--observation",
        case_folder / "observation.yaml",
    ]
    asked = ["merge", *map(str, words), "--out", str(tmp_path / "out")]
    main(asked)
    warned = capsys.readouterr().err
    assert warned.startswith("warning: Map 2 (grey")
    assert "216" in warned
    assert json.loads((tmp_path / "out" / "report.json").read_text())["warnings"] == [
        warned.removeprefix("warning: ").strip()
    ]
    assert main([*asked, "--unknown-grey", "216"]) == 0
    assert capsys.readouterr().err == ""


def test_a_setting_that_is_gone_is_told_with_what_took_its_place(case_folder, tmp_path, capsys):
    asked = ["merge", *inputs(case_folder), "--out", str(tmp_path)]
    with pytest.raises(SystemExit) as ended:
        main([*asked, "--verdict.bent-wall", "12"])
    assert ended.value.code == 2
    assert "accept_from" in capsys.readouterr().err


def test_the_merged_map_that_is_left_is_the_one_that_the_library_makes(case_folder, small_case, tmp_path):
    main(["merge", *inputs(case_folder), "--out", str(tmp_path), "--seed", "3"])
    left = read_map(tmp_path / "merged.yaml")
    made = methods.merge(small_case.ref, small_case.mov, small_case.observations, seed=3).fusion.merged
    assert (left.cells == made.cells).all()
    assert (left.origin, left.resolution) == (made.origin, made.resolution)


def test_with_json_stdout_is_the_report_alone(case_folder, tmp_path, capsys):
    assert main(["merge", *inputs(case_folder), "--out", str(tmp_path), "--json"]) == 0
    assert capsys.readouterr().out == (tmp_path / "report.json").read_text()


def test_settings_and_seed_reach_the_method_in_either_spelling(case_folder, tmp_path):
    words = ["--augment.spread=2.5", "--box.sigma_x", "0.5", "--no-candidates.twins", "--seed", "7"]
    main(["merge", *inputs(case_folder), "--out", str(tmp_path), *words])
    report = json.loads((tmp_path / "report.json").read_text())
    assert report["seed"] == 7
    assert report["settings"]["augment"]["spread"] == 2.5
    assert report["settings"]["box"]["sigma_x"] == 0.5
    assert report["settings"]["candidates"]["twins"] is False


def test_a_method_starts_from_its_own_defaults(case_folder, tmp_path):
    main(["merge", *inputs(case_folder), "--out", str(tmp_path), "--method", "spectra-montecarlo"])
    report = json.loads((tmp_path / "report.json").read_text())
    assert report["method"] == "spectra-montecarlo"
    assert report["settings"]["refine"]["optimiser"] == "mco"


def test_a_refused_merge_ends_with_1_and_leaves_no_map(strangers_folder, tmp_path, capsys):
    assert main(["merge", *inputs(strangers_folder), "--out", str(tmp_path)]) == 1
    assert {path.name for path in tmp_path.iterdir()} == of_a_refusal(tmp_path)
    said = capsys.readouterr().out
    assert said.startswith("Refused: ")
    assert "--force" in said
    assert "<strong>REFUSED</strong>" in (tmp_path / "report.html").read_text("utf-8")


def test_force_writes_the_refused_map_and_still_ends_with_1(strangers_folder, tmp_path):
    assert main(["merge", *inputs(strangers_folder), "--out", str(tmp_path), "--force"]) == 1
    assert {path.name for path in tmp_path.iterdir()} == ALL_FILES | of_a_refusal(tmp_path)
    assert yaml.safe_load((tmp_path / "transform.yaml").read_text())["accepted"] is False


def test_a_suggestion_is_taken_on_the_word_of_a_person(strangers_folder, tmp_path, capsys):
    maps = inputs(strangers_folder)[:2]
    assert main(["merge", *maps, "--out", str(tmp_path)]) == 1
    suggested = json.loads((tmp_path / "suggestions.json").read_text())
    assert "--take N" in capsys.readouterr().out
    last = suggested[-1]
    assert main(["merge", *maps, "--out", str(tmp_path), "--take", str(last["number"])]) == 0
    assert capsys.readouterr().out.startswith("Chosen by you. Refused: ")
    report = json.loads((tmp_path / "report.json").read_text())
    assert report["T_ref_mov"] == last["T_ref_mov"]
    assert report["method"] == "chosen by you"
    assert {path.name for path in tmp_path.iterdir()} == ALL_FILES  # no suggestion is left of the run before


def test_a_suggestion_that_is_not_there_is_told_in_a_line(case_folder, tmp_path, capsys):
    asked = ["merge", *inputs(case_folder), "--out", str(tmp_path), "--take", "5"]
    assert main(asked) == 2
    assert "to take" in capsys.readouterr().err
    assert not (tmp_path / "merged.yaml").exists()


def test_a_refused_merge_takes_an_earlier_map_away_and_says_so(
    case_folder, strangers_folder, tmp_path, capsys
):
    (tmp_path / "notes.txt").write_text("mine")
    assert main(["merge", *inputs(case_folder), "--out", str(tmp_path)]) == 0
    assert main(["merge", *inputs(strangers_folder), "--out", str(tmp_path)]) == 1
    assert {path.name for path in tmp_path.iterdir()} == of_a_refusal(tmp_path) | {"notes.txt"}
    assert "removed" in capsys.readouterr().out


def without_an_answer(*_):
    raise NoAnswerError("no two places of these maps are alike")
    yield


def test_a_merge_without_an_answer_is_a_refusal_that_leaves_its_reason_alone(
    case_folder, tmp_path, capsys, monkeypatch
):
    (tmp_path / "notes.txt").write_text("mine")
    words = ["merge", *inputs(case_folder), "--out", str(tmp_path)]
    assert main(words) == 0
    capsys.readouterr()
    default = methods.DEFAULT_METHOD
    monkeypatch.setitem(METHODS, default, replace(METHODS[default], search=without_an_answer))
    assert main([*words, "--force"]) == 1
    said = capsys.readouterr().out
    assert said.startswith("Refused: no two places of these maps are alike.\n")
    assert "merged.yaml" in said.split("removed")[1]
    assert {path.name for path in tmp_path.iterdir()} == {"report.json", "notes.txt"}
    report = json.loads((tmp_path / "report.json").read_text())
    assert report["T_ref_mov"] is None
    assert report["verdict"] == {
        "accepted": False,
        "outcome": "refused",
        "probability": 0.0,
        "reason": "Refused: no two places of these maps are alike.",
    }
    assert main([*words, "--json"]) == 1
    assert json.loads(capsys.readouterr().out) == json.loads((tmp_path / "report.json").read_text())


def test_a_report_without_an_answer_has_the_keys_of_one_with(case_folder, tmp_path, monkeypatch):
    words = ["merge", *inputs(case_folder), "--out", str(tmp_path)]
    main(words)
    usual = json.loads((tmp_path / "report.json").read_text())
    default = methods.DEFAULT_METHOD
    monkeypatch.setitem(METHODS, default, replace(METHODS[default], search=without_an_answer))
    main(words)
    assert list(json.loads((tmp_path / "report.json").read_text())) == list(usual)


def test_a_replay_of_no_answer_is_not_written(case_folder, tmp_path, capsys, monkeypatch):
    default = methods.DEFAULT_METHOD
    monkeypatch.setitem(METHODS, default, replace(METHODS[default], search=without_an_answer))
    assert main(["replay", str(case_folder), "--out", str(tmp_path / "a.html")]) == 1
    assert "Refused: no two places" in capsys.readouterr().err
    assert not (tmp_path / "a.html").exists()


@pytest.mark.parametrize("named", ["merged.yaml", "left.yaml"])
def test_a_merge_never_overwrites_its_own_inputs(named, case_folder, tmp_path, capsys):
    (tmp_path / "merged.pgm").write_bytes((case_folder / "map1.pgm").read_bytes())
    (tmp_path / named).write_bytes(
        (case_folder / "map1.yaml").read_bytes().replace(b"map1.pgm", b"merged.pgm")
    )
    before = {path.name: path.read_bytes() for path in tmp_path.iterdir()}
    _, *others = inputs(case_folder)
    assert main(["merge", str(tmp_path / named), *others, "--out", str(tmp_path)]) == 2
    assert "is an input of this merge; choose another --out" in capsys.readouterr().err
    assert {path.name: path.read_bytes() for path in tmp_path.iterdir()} == before


def test_a_bar_names_the_stage_at_work_where_a_person_looks(case_folder, tmp_path, monkeypatch):
    class Terminal(io.StringIO):
        def isatty(self):
            return True

    seen = Terminal()
    monkeypatch.setattr(sys, "stderr", seen)
    assert main(["merge", *inputs(case_folder), "--out", str(tmp_path)]) == 0
    assert "refine" in seen.getvalue()
    assert "%" in seen.getvalue()


def test_plain_images_merge_where_their_resolution_is_given(case_folder, tmp_path, capsys):
    case = read_case(case_folder)
    o, first, second = case.observations[0], case.ref.origin.inverse(), case.mov.origin.inverse()
    seen = second @ Pose2(o.observed_x, o.observed_y)  # without a YAML file the corner is the origin
    moved = replace(o, observer=first @ o.observer, observed_x=seen.x, observed_y=seen.y)
    write_observations(tmp_path / "o.yaml", [moved])
    for name in ("map1.pgm", "map2.pgm"):
        (tmp_path / name).write_bytes((case_folder / name).read_bytes())
    words = ["merge", str(tmp_path / "map1.pgm"), str(tmp_path / "map2.pgm"), "--out", str(tmp_path / "out")]
    words += ["--observation", str(tmp_path / "o.yaml")]
    assert main(words) == 2
    assert "resolution of the image" in capsys.readouterr().err
    assert main([*words, "--resolution", f"{case.ref.resolution},{case.mov.resolution}"]) == 0
    assert read_map(tmp_path / "out" / "merged.yaml").resolution == case.ref.resolution


@pytest.mark.parametrize("given", ["0.1", "0.1,0.1"])
def test_a_resolution_for_maps_that_say_their_own_is_refused(case_folder, tmp_path, capsys, given):
    words = ["merge", *inputs(case_folder), "--out", str(tmp_path / "out"), "--resolution", given]
    assert main(words) == 2
    error = capsys.readouterr().err
    assert "map1.yaml is no plain image" in error
    assert "leave --resolution out" in error
    assert not (tmp_path / "out").exists()


def test_a_file_of_several_observations_is_merged_and_a_robot_off_its_map_is_told_by_number(
    case_folder, small_case, tmp_path, capsys
):
    (seen,) = small_case.observations
    lost, several = replace(seen, observed_x=800.0), tmp_path / "several.yaml"
    one, two, _ = inputs(case_folder)
    words = ["merge", one, two, "--observation", str(several), "--out", str(tmp_path / "out")]
    write_observations(several, [seen, seen])
    assert main(words) == 0
    write_observations(several, [seen, lost])
    assert main(words) == 2
    assert "observation 2 puts robot 2 at (800, " in capsys.readouterr().err


def test_swapped_maps_end_with_2_and_say_so(case_folder, tmp_path, capsys):
    one, two, seen = inputs(case_folder)
    assert main(["merge", two, one, seen, "--out", str(tmp_path / "out")]) == 2
    assert "whether the two maps are swapped" in capsys.readouterr().err


@pytest.mark.parametrize("missing", ["map1.yaml", "map2.yaml", "observation.yaml"])
def test_a_missing_file_ends_with_2_and_one_line_that_names_it(missing, case_folder, tmp_path, capsys):
    words = [word.replace(missing, f"no_{missing}") for word in inputs(case_folder)]
    assert main(["merge", *words, "--out", str(tmp_path / "out")]) == 2
    said = capsys.readouterr().err
    assert f"no_{missing}: no such file" in said
    assert said.count("\n") == 1
    assert not (tmp_path / "out").exists()


def test_robots_that_have_names_are_told_by_them_and_so_are_the_frames_of_their_maps(
    case_folder, tmp_path, capsys
):
    asked = ["merge", *inputs(case_folder), "--out", str(tmp_path), "--names", "Bob", "Alice"]
    assert main(asked) == 0
    said = capsys.readouterr().out
    assert "Alice's map in Bob's map: x " in said
    texts = {name: (tmp_path / name).read_text("utf-8") for name in ("report.html", "transform.yaml")}
    for text in (said, *texts.values()):
        assert WORDS.search(re.sub(r'base64,[^"]*', "", text)) is None
    assert "Bob saw Alice</h1>" in texts["report.html"]
    assert "--frame-id bob/map --child-frame-id alice/map" in texts["transform.yaml"]
    report = json.loads((tmp_path / "report.json").read_text())
    assert (report["inputs"]["robot1"], report["inputs"]["robot2"]) == ("Bob", "Alice")
    assert "robot 1" not in report["verdict"]["reason"]


@pytest.mark.parametrize(
    ("names", "fault"),
    [
        (("Bob", "Bob"), "both robots are called Bob; give them two names"),
        (("a/b", "Alice"), "'a/b' is no name for a robot; give 1 to 64 letters, without a slash"),
    ],
)
def test_names_that_no_fleet_would_take_are_refused_in_a_line(case_folder, tmp_path, capsys, names, fault):
    assert main(["merge", *inputs(case_folder), "--out", str(tmp_path / "out"), "--names", *names]) == 2
    error = capsys.readouterr().err
    assert fault in error
    assert error.count("\n") == 1
    assert not (tmp_path / "out").exists()


def test_the_merged_map_comes_in_the_frame_and_the_cells_that_are_asked_for(case_folder, tmp_path, capsys):
    asked = ["merge", *inputs(case_folder), "--out", str(tmp_path)]
    assert main([*asked, "--frame", "mov"]) == 0
    assert "The merged map is in map 2's frame.\n" in capsys.readouterr().out
    turned = read_map(tmp_path / "merged.yaml")
    told = yaml.safe_load((tmp_path / "transform.yaml").read_text())
    T = Pose2(**told["T_ref_mov"])
    assert told["publish"].endswith("--frame-id map2 --child-frame-id map1")
    assert main([*asked, "--frame", "mov", "--no-yaw"]) == 0
    said = re.search(r"without yaw: ([\d,]+) of ([\d,]+) cells changed", capsys.readouterr().out)
    flat = read_map(tmp_path / "merged.yaml")
    assert (turned.origin.theta != 0, flat.origin.theta) == (True, 0.0)
    assert int(said[2].replace(",", "")) == turned.cells.size
    report = json.loads((tmp_path / "report.json").read_text())["merged_map"]
    assert report["cells_changed"] == int(said[1].replace(",", "")) > 0
    assert main([*asked, "--merged-resolution", "0.1"]) == 0
    coarse = read_map(tmp_path / "merged.yaml")
    assert coarse.resolution == 0.1
    for wall in turned.points[::40]:
        assert flat.value_at(wall) == OCCUPIED
        assert coarse.value_at(T.apply(wall)) == OCCUPIED


def test_a_chosen_frame_may_begin_with_a_minus_and_publishes_both_maps(case_folder, tmp_path):
    asked = ["merge", *inputs(case_folder), "--out", str(tmp_path)]
    assert main([*asked, "--frame", "-1.5,2,0.25"]) == 0
    told = yaml.safe_load((tmp_path / "transform.yaml").read_text())
    assert told["T_ref_frame"] == {"x": -1.5, "y": 2.0, "theta": 0.25}
    assert [words.split("--frame-id ")[1] for words in told["publish"]] == [
        "map --child-frame-id map1",
        "map --child-frame-id map2",
    ]


@pytest.mark.parametrize(
    ("words", "fault"),
    [
        (["--frame", "map2"], "map2 is neither ref nor mov nor X,Y,YAW"),
        (["--frame", "1,2"], "1,2 is neither ref nor mov nor X,Y,YAW"),
        (["--frame", "1,2,nan"], "1,2,nan is neither ref nor mov nor X,Y,YAW"),
        (["--merged-resolution", "-0.1"], "-0.1 is no positive number of metres"),
    ],
)
def test_a_frame_or_a_cell_that_cannot_be_is_told_before_anything_is_read(words, fault, tmp_path, capsys):
    assert usage_error("merge", "a.yaml", "b.yaml", "--out", tmp_path, *words) == 2
    assert fault in capsys.readouterr().err


@pytest.mark.parametrize(
    ("words", "fault"),
    [
        (["--frame", "1e9,0,0"], "no frame lies at 1e+09, 0 m; give x, y and yaw in map 1's frame"),
        (["--merged-resolution", "0.0001"], "the map in other cells"),
        (["--merged-resolution", "1000"], "a map cannot have cells of 1000 m"),
    ],
)
def test_a_merged_map_that_cannot_be_made_is_told_in_a_line_and_nothing_is_left(
    words, fault, case_folder, tmp_path, capsys
):
    assert main(["merge", *inputs(case_folder), "--out", str(tmp_path / "out"), *words]) == 2
    error = capsys.readouterr().err
    assert fault in error
    assert error.count("\n") == 1
    assert not (tmp_path / "out").exists()


def test_with_a_date_that_is_set_two_merges_leave_the_same_page_but_for_the_times(
    case_folder, tmp_path, monkeypatch
):
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "1700000000")
    pages = []
    for folder in (tmp_path / "one", tmp_path / "two"):
        assert main(["merge", *inputs(case_folder), "--out", str(folder)]) == 0
        pages.append(re.sub(r"<td>\d+ ms</td>", "", (folder / "report.html").read_text("utf-8")))
        assert json.loads((folder / "report.json").read_text())["made"] == "2023-11-14T22:13:20Z"
    assert pages[0] == pages[1]
