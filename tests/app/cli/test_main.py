"""The command line of all commands: help, wrong usage, bugs and interrupts, and their exit status."""

import json
import subprocess
import sys

import pytest
from commandline import ROOT, in_a_process, inputs, usage_error

from algorithms.common.setting_bounds import Bounds
from algorithms.methods import registry as methods
from algorithms.methods.registry import METHODS
from app.cli.main import COMMANDS, main
from app.model.settings import settings_of

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
        "import sys; from app.cli.main import main\n"
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
        (["merge", "--observation", "o", "--augment.spred", "3"], "did you mean --augment.spread?"),
        (["merge", "--method", "spectra-swam"], "did you mean spectra-swarm?"),
        (["merge", "--method", "zebra"], "known are spectra-proven"),
        (["merge", "--method", "bilateral", "--swarm.particles", "90"], "other than bilateral"),
        (["merge", "a", "b"], "required: --out"),
        (["merge", "--initial", "1", "2"], "--initial: expected 3 arguments"),
        (["merge", "--observation", "o", "--augment.spread", "99"], "it must lie in [0.2, 20] m"),
        (["merge", "--observation", "o", "--augment.spread", "nan"], "it must lie in [0.2, 20] m"),
        (["merge", "--observation", "o", "--augment.spread", "wide"], "wide is no number"),
        (["merge", "--observation", "o", "--swarm.particles", "12.5"], "12.5 is no whole number"),
        (["merge", "--observation", "o", "--refine.optimiser", "psi"], "psi is none of pso, mco"),
        (["merge", "--seed", "-1"], "-1 is no whole number from 0 up"),
        (["merge", "--resolution", "0"], "0 is neither one positive number"),
        (["evaluate", ".", "--jobs", "0"], "0 is no whole number from 1 up"),
        (["serve", "--port", "99999"], "99999 is no port"),
        (["serve", "map1.yaml"], "give MAP1 and MAP2 together"),
    ],
)
def test_wrong_usage_ends_with_2_and_one_line_that_says_what_to_do(words, remedy, capsys):
    assert usage_error(*words) == 2
    said = capsys.readouterr().err
    assert remedy in said
    assert said.count("\n") == 1


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


ENDED_WHILE_WRITING = """
import os, signal, sys
from app.cli.main import entry
sync, calls = os.fsync, []
def ended(*what):
    calls.append(what)
    if len(calls) == 3:
        os.kill(os.getpid(), signal.SIGTERM)
    sync(*what)
os.fsync = ended
entry()
"""


def test_who_is_told_to_end_while_writing_leaves_everything_as_it_was(case_folder, tmp_path):
    (tmp_path / "merged.yaml").write_text("an older one")
    words = ["merge", *inputs(case_folder), "--out", tmp_path]
    told = in_a_process(*words, run=["-c", ENDED_WHILE_WRITING])
    assert told.returncode == 130
    assert told.stderr == "mapmeld: interrupted; nothing half-written is left\n"
    assert [path.name for path in tmp_path.iterdir()] == ["merged.yaml"]
    assert (tmp_path / "merged.yaml").read_text() == "an older one"


def test_python_m_app_is_the_same_command(strangers_folder, tmp_path):
    told = in_a_process("merge", *inputs(strangers_folder), "--out", tmp_path, "--json")
    assert told.returncode == 1
    assert json.loads(told.stdout)["verdict"]["accepted"] is False
    assert told.stderr == ""
