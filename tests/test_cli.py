"""The command line: what it takes, what it leaves, what it says and with which exit status."""

import io
import json
import os
import re
import signal
import subprocess
import sys
import time
import urllib.request
from dataclasses import replace
from pathlib import Path

import pytest
import yaml

from algorithms import methods
from algorithms.bounds import Bounds
from algorithms.casefiles import read_case, write_observations
from algorithms.errors import NoAnswerError
from algorithms.mapio import read_map
from algorithms.methods import METHODS
from algorithms.pose import Pose2
from app.cli import COMMANDS, main
from app.controls import settings_of

ROOT = Path(__file__).parent.parent
OF_A_REFUSAL = {"overlay.png", "report.html", "report.json"}
ALL_FILES = {"merged.yaml", "merged.pgm", "transform.yaml"} | OF_A_REFUSAL


def inputs(folder):
    return [str(folder / "map1.yaml"), str(folder / "map2.yaml"), f"--observation={folder}/observation.yaml"]


def usage_error(*words):
    """Exit status of words that the parser refuses."""
    with pytest.raises(SystemExit) as left:
        main(list(words))
    return left.value.code


def in_a_process(*words, **kwargs):
    return subprocess.run(
        [sys.executable, "-m", "app", *map(str, words)], capture_output=True, text=True, cwd=ROOT, **kwargs
    )


# ---- help and version


def test_help_opens_with_worked_examples_as_they_are_written(capsys):
    assert usage_error("--help") == 0
    lines = capsys.readouterr().out.splitlines()
    assert lines[2] == "Examples:"
    assert lines[3] == "  mapmeld serve                      open a sample in the browser and watch it merge"
    usage = next(at for at, line in enumerate(lines) if line.startswith("usage:"))
    assert usage > lines.index("Examples:")


@pytest.mark.parametrize("command", COMMANDS)
def test_every_command_has_worked_examples_in_its_help(command, capsys):
    assert usage_error(command, "--help") == 0
    said = capsys.readouterr().out
    assert said.index("Example") < said.index(f"  mapmeld {command} ") < said.index("usage:")


def test_help_and_version_load_nothing_heavy():
    code = (
        "import sys; from app.cli import main\n"
        "for words in (['--help'], ['--version'], ['serve', '--help']):\n"
        "    try: main(words)\n"
        "    except SystemExit: pass\n"
        "heavy = {'numpy', 'numba', 'scipy', 'viser', 'cv2', 'yaml', 'matplotlib', 'distributed'}\n"
        "heavy &= set(sys.modules)\n"
        "print(heavy, file=sys.stderr)"
    )
    told = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, cwd=ROOT, check=True)
    assert told.stderr.strip() == "set()"
    assert "mapmeld " in told.stdout


@pytest.mark.parametrize("method", METHODS)
def test_every_setting_of_a_method_is_a_flag_with_its_range_and_hint(method, capsys):
    usage_error("merge", "--method", method, "--help")
    said = " ".join(capsys.readouterr().out.split())
    for setting in settings_of(METHODS[method].defaults):
        assert f"--{'.'.join(setting.path).replace('_', '-')}" in said
        assert " ".join(setting.hint.split()) in said
        if isinstance(setting.bounds, Bounds):
            assert f"{setting.bounds.low:g} … {setting.bounds.high:g}" in said


# ---- wrong usage


def test_no_command_is_an_error_that_shows_the_help(capsys):
    assert main([]) == 2
    assert "Examples:" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("words", "remedy"),
    [
        (["mrege"], "did you mean merge?"),
        (["merge", "--observaton", "x"], "did you mean --observation?"),
        (["merge", "--augment.spred", "3"], "did you mean --augment.spread?"),
        (["merge", "--method", "spectra-swam"], "did you mean spectra-swarm?"),
        (["merge", "--method", "zebra"], "known are spectra-proven"),
        (["merge", "--method", "bilateral", "--swarm.particles", "90"], "other than bilateral"),
        (["merge", "a", "b", "--out", "c"], "required: --observation"),
        (["merge", "--augment.spread", "99"], "it must lie in [0.2, 20] m"),
        (["merge", "--augment.spread", "nan"], "it must lie in [0.2, 20] m"),
        (["merge", "--augment.spread", "wide"], "wide is no number"),
        (["merge", "--swarm.particles", "12.5"], "12.5 is no whole number"),
        (["merge", "--refine.optimiser", "psi"], "psi is none of pso, mco"),
        (["merge", "--seed", "-1"], "-1 is no whole number from 0 up"),
        (["merge", "--resolution", "0"], "0 is neither one positive number"),
        (["evaluate", ".", "--jobs", "0"], "0 is no whole number from 1 up"),
        (["serve", "--port", "99999"], "99999 is no port"),
        (["serve", "map1.yaml"], "give MAP1, MAP2 and --observation FILE together"),
    ],
)
def test_wrong_usage_ends_with_2_and_one_line_that_says_what_to_do(words, remedy, capsys):
    assert usage_error(*words) == 2
    said = capsys.readouterr().err
    assert remedy in said
    assert said.count("\n") == 1


# ---- merge


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


def test_a_refusal_is_told_with_what_would_help(case_folder, tmp_path, capsys):
    asked = ["merge", *inputs(case_folder), "--out", str(tmp_path)]
    assert main([*asked, "--verdict.wall", "200"]) == 1
    said = capsys.readouterr().out
    assert "too little to tell right from wrong" in said
    assert "Let one of the robots drive on" in said


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
    assert {path.name for path in tmp_path.iterdir()} == OF_A_REFUSAL
    said = capsys.readouterr().out
    assert said.startswith("Refused: ")
    assert "--force" in said
    assert "<strong>REFUSED</strong>" in (tmp_path / "report.html").read_text("utf-8")


def test_force_writes_the_refused_map_and_still_ends_with_1(strangers_folder, tmp_path):
    assert main(["merge", *inputs(strangers_folder), "--out", str(tmp_path), "--force"]) == 1
    assert {path.name for path in tmp_path.iterdir()} == ALL_FILES
    assert yaml.safe_load((tmp_path / "transform.yaml").read_text())["accepted"] is False


def test_a_refused_merge_takes_an_earlier_map_away_and_says_so(
    case_folder, strangers_folder, tmp_path, capsys
):
    (tmp_path / "notes.txt").write_text("mine")
    assert main(["merge", *inputs(case_folder), "--out", str(tmp_path)]) == 0
    assert main(["merge", *inputs(strangers_folder), "--out", str(tmp_path)]) == 1
    assert {path.name for path in tmp_path.iterdir()} == {
        "overlay.png",
        "report.html",
        "report.json",
        "notes.txt",
    }
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
    monkeypatch.setitem(METHODS, default, replace(METHODS[default], run=without_an_answer))
    assert main([*words, "--force"]) == 1
    said = capsys.readouterr().out
    assert said.startswith("Refused: no two places of these maps are alike.\n")
    assert "merged.yaml" in said.split("removed")[1]
    assert {path.name for path in tmp_path.iterdir()} == {"report.json", "notes.txt"}
    report = json.loads((tmp_path / "report.json").read_text())
    assert report["T_ref_mov"] is None
    assert report["verdict"] == {
        "accepted": False,
        "reason": "Refused: no two places of these maps are alike.",
    }
    assert main([*words, "--json"]) == 1
    assert json.loads(capsys.readouterr().out) == json.loads((tmp_path / "report.json").read_text())


def test_a_report_without_an_answer_has_the_keys_of_one_with(case_folder, tmp_path, monkeypatch):
    words = ["merge", *inputs(case_folder), "--out", str(tmp_path)]
    main(words)
    usual = json.loads((tmp_path / "report.json").read_text())
    default = methods.DEFAULT_METHOD
    monkeypatch.setitem(METHODS, default, replace(METHODS[default], run=without_an_answer))
    main(words)
    assert list(json.loads((tmp_path / "report.json").read_text())) == list(usual)


def test_a_replay_of_no_answer_is_not_written(case_folder, tmp_path, capsys, monkeypatch):
    default = methods.DEFAULT_METHOD
    monkeypatch.setitem(METHODS, default, replace(METHODS[default], run=without_an_answer))
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


def test_a_bug_is_told_apart_from_a_refusal(case_folder, tmp_path, monkeypatch, capsys):
    def broken(*_args, **_kwargs):
        raise ZeroDivisionError("oh no")

    monkeypatch.setattr(methods, "run", broken)
    assert main(["merge", *inputs(case_folder), "--out", str(tmp_path)]) == 70
    said = capsys.readouterr().err
    assert "ZeroDivisionError" in said
    assert said.splitlines()[-1] == "mapmeld: this is a bug of mapmeld; please report the lines above"


def test_an_interrupt_ends_with_130_one_line_and_no_files(case_folder, tmp_path, monkeypatch, capsys):
    def interrupted(*_args, **_kwargs):
        raise KeyboardInterrupt

    monkeypatch.setattr(methods, "run", interrupted)
    assert main(["merge", *inputs(case_folder), "--out", str(tmp_path / "out")]) == 130
    assert capsys.readouterr().err == "mapmeld: interrupted; nothing half-written is left\n"
    assert not (tmp_path / "out").exists()


def test_python_m_app_is_the_same_command(strangers_folder, tmp_path):
    told = in_a_process("merge", *inputs(strangers_folder), "--out", tmp_path, "--json")
    assert told.returncode == 1
    assert json.loads(told.stdout)["verdict"]["accepted"] is False
    assert told.stderr == ""


# ---- serve


def as_in_a_terminal():
    """A shell without job control lets what it starts in the background ignore Ctrl-C."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)


@pytest.mark.parametrize("end", [signal.SIGINT, signal.SIGTERM])
def test_serve_answers_on_this_machine_alone_until_it_is_told_to_end(end):
    command = [sys.executable, "-m", "app", "serve", "--no-browser", "--port", "0"]
    with subprocess.Popen(
        command, stdout=subprocess.PIPE, text=True, cwd=ROOT, preexec_fn=as_in_a_terminal
    ) as page:
        try:
            said = next(line for line in page.stdout if line.startswith("mapmeld is at "))
            url = said.split()[3]
            assert url.startswith("http://127.0.0.1:")
            with urllib.request.urlopen(url, timeout=20) as answer:
                assert answer.status == 200
            time.sleep(0.2)
            page.send_signal(end)
            assert page.wait(timeout=20) == 0
        finally:
            if page.poll() is None:
                page.kill()


def test_a_browser_is_opened_only_where_there_is_a_screen(monkeypatch):
    from app.commands.serve import _has_display

    monkeypatch.setattr(sys, "platform", "linux")
    for name in ("DISPLAY", "WAYLAND_DISPLAY"):
        monkeypatch.delenv(name, raising=False)
    assert not _has_display()
    monkeypatch.setitem(os.environ, "DISPLAY", ":0")
    assert _has_display()


def test_a_lesson_with_a_broken_text_is_refused_before_anyone_sees_it(tmp_path, capsys):
    assert main(["serve", "--no-browser", "--lesson", str(tmp_path)]) == 2
    assert "holds no text" in capsys.readouterr().err
    (tmp_path / "01-mine.md").write_text("---\ntitle: Mine\npicture: hoof\n---\nText.\n")
    assert main(["serve", "--no-browser", "--lesson", str(tmp_path)]) == 2
    said = capsys.readouterr().err
    assert "01-mine.md: picture is 'hoof'; known are " in said
    assert said.count("\n") == 1
