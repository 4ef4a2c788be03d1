"""``mapmeld sweep`` and ``mapmeld compare`` as a person runs them."""

import csv
import io
import json
import signal
import subprocess
import sys

import pytest
from commandline import ROOT, usage_error
from executor_tasks import until

from app.cli.main import main

SMALL = ["--swarm.iterations", "5", "--refine.candidates", "1", "--seeds", "2"]


def table(path):
    return list(csv.DictReader(io.StringIO(path.read_text())))


def test_a_sweep_that_is_killed_and_started_again_ends_with_the_same_files(case_folder, tmp_path, capsys):
    ranges = ["--x", "augment.spread=0.5:8:10", "--y", "swarm.particles=20,40,60"]
    command = ["sweep", str(case_folder), *ranges, *SMALL, "--jobs", "1", "--out"]
    whole, torn = tmp_path / "whole", tmp_path / "torn"
    journal = torn / "journal.jsonl"

    def lines():
        return journal.read_bytes().count(b"\n") if journal.exists() else 0

    with subprocess.Popen([sys.executable, "-m", "app", *command, str(torn)], cwd=ROOT) as first:
        assert until(lambda: lines() >= 3)
        first.send_signal(signal.SIGKILL)
    kept = lines()
    assert 3 <= kept < 30
    assert [path.name for path in torn.iterdir()] == ["journal.jsonl"]
    assert main([*command, str(torn)]) == 0
    assert f"{kept} of 30 points are known from before" in capsys.readouterr().out
    assert main([*command, str(whole)]) == 0
    names = {path.name for path in whole.iterdir()}
    assert names == {path.name for path in torn.iterdir()}
    same = {name for name in names if (whole / name).read_bytes() == (torn / name).read_bytes()}
    name = "swarm.particles_by_augment.spread"
    assert same == {f"{name}{end}" for end in (".csv", ".runs.csv", ".json", ".png", ".svg")}
    assert len(table(whole / f"{name}.csv")) == 30
    assert len(table(whole / f"{name}.runs.csv")) == 60


# a line of journal.jsonl as a sweep of the first version left it, before a point said what it was made of
OLD_LINE = (
    '{"key": "c2367e9712205e145c087b5130828dd1", "record": {"x": 1.0, "y": null, "trials": [{"T_ref_mov": '
    '[-10.28, 5.51, -1.06], "accepted": true, "reason": "Merged: the maps agree on 99% of the 202 m of wall '
    'that both robots should have seen.", "index": 0.95, "distance": 0.05, "angle": 0.005, "right": true, '
    '"fine": true, "seconds": 0.17, "failed": false}]}}\n'
)


def test_points_of_an_earlier_version_are_read_and_said_to_be_merged_anew(case_folder, tmp_path, capsys):
    journal = tmp_path / "journal.jsonl"
    journal.write_text(OLD_LINE)
    words = ["sweep", str(case_folder), "--x", "augment.spread=1,2", *SMALL, "--out", str(tmp_path)]
    assert main([*words, "--jobs", "1"]) == 0
    said = capsys.readouterr()
    assert said.err == ""
    assert [line for line in said.out.splitlines() if "the journal" in line] == [
        "augment.spread: 1 of 2 points are in the journal, but were made by another version of mapmeld, or "
        "with other maps, observations, truth, method, seeds, versions, settings: they are merged anew, as "
        "answers may differ"
    ]
    assert "known from before" not in said.out
    lines = journal.read_text().splitlines()
    assert f"{lines[0]}\n" == OLD_LINE  # what is there stays
    assert len(lines) == 3
    assert -10.28 not in {float(row["x_m"]) for row in table(tmp_path / "augment.spread.runs.csv")}
    assert main([*words, "--jobs", "1"]) == 0
    said = capsys.readouterr().out
    assert "2 of 2 points are known from before" in said
    assert "the journal" not in said


def test_what_is_merged_anew_is_said_with_what_has_changed(case_folder, tmp_path, capsys, monkeypatch):
    words = ["sweep", str(case_folder), "--x", "augment.spread=1,2", *SMALL, "--jobs", "1", "--out"]
    assert main([*words, str(tmp_path)]) == 0
    assert "the journal" not in capsys.readouterr().out
    other = ["sweep", str(case_folder), "--x", "augment.intensity=1,2", *SMALL, "--jobs", "1", "--out"]
    assert main([*other, str(tmp_path)]) == 0  # another sweep in the same folder
    assert "the journal" not in capsys.readouterr().out
    assert main([*words, str(tmp_path), "--swarm.omega", "0.5"]) == 0
    assert (
        "2 of 2 points are in the journal, but were made with other settings: they are"
        in capsys.readouterr().out
    )
    monkeypatch.setattr("app.evaluation.sweep.parameter_sweep.code", lambda _: "changed")
    assert main([*words, str(tmp_path), "--swarm.omega", "0.5"]) == 0
    assert (
        "2 of 2 points are in the journal, but were made with other versions: they are"
        in capsys.readouterr().out
    )


def test_an_interrupted_sweep_says_how_far_it_came(case_folder, tmp_path, monkeypatch, capsys):
    from app.evaluation.sweep import parameter_sweep as sweeping

    calls = []

    def attempt(*args):
        calls.append(args)
        if len(calls) > 4:
            raise KeyboardInterrupt
        return trial(*args)

    trial = sweeping.run_method
    monkeypatch.setattr(sweeping, "run_method", attempt)
    words = ["sweep", str(case_folder), "--x", "augment.spread=1,2,3", *SMALL, "--out", str(tmp_path)]
    assert main([*words, "--jobs", "1"]) == 130
    assert "2 of 3 points are kept; the same command goes on there" in capsys.readouterr().out
    assert [path.name for path in tmp_path.iterdir()] == ["journal.jsonl"]


def test_without_a_range_both_sweeps_of_the_paper_are_made(case_folder, tmp_path, capsys, monkeypatch):
    monkeypatch.setattr("app.evaluation.sweep.sweep_axes.SQUARED_CELLS", (105, 900))
    monkeypatch.setattr("app.evaluation.sweep.sweep_axes.INTENSITIES", (1.0, 1000.0))
    monkeypatch.setattr("app.evaluation.sweep.sweep_axes.PARTICLE_COUNTS", (10, 20))
    monkeypatch.chdir(tmp_path)
    assert main(["sweep", str(case_folder), *SMALL, "--jobs", "1"]) == 0
    out = tmp_path / "sweep_flat_1"
    thirteen = json.loads((out / "augment.intensity_by_augment.spread.json").read_text())
    fourteen = json.loads((out / "swarm.particles.json").read_text())
    assert thirteen["settings"]["swarm"]["particles"] == 200
    assert fourteen["settings"]["augment"]["intensity"] == 100
    assert fourteen["settings"]["augment"]["spread"] == pytest.approx(0.5123)
    assert thirteen["method"] == "spectra-swarm"
    assert "4 points of 2 seeds" in capsys.readouterr().out
    assert len(table(out / "swarm.particles.times.csv")) == 2
    # what the command line names, it means
    assert main(["sweep", str(case_folder), *SMALL, "--jobs", "1", "--swarm.particles", "50"]) == 0
    told = json.loads((out / "augment.intensity_by_augment.spread.json").read_text())
    assert told["settings"]["swarm"]["particles"] == 50


def test_what_cannot_be_swept_is_told_in_one_line(case_folder, capsys):
    for words, remedy in (
        ((case_folder, "--x", "augment.spred=1,2"), "did you mean augment.spread?"),
        ((case_folder, "--x", "augment.spread=1:90:3"), "must lie in [0.2, 20] m"),
        ((case_folder, "--method", "bilateral"), "has no setting swarm.particles"),
    ):
        assert main(["sweep", *map(str, words)]) == 2
        said = capsys.readouterr().err
        assert remedy in said
        assert said.count("\n") == 1
    for words in (
        (case_folder, "--y", "augment.spread=1,2"),
        ("no_such_sample",),
        (case_folder, "--seeds", "0"),
    ):
        assert usage_error("sweep", *words) == 2
        assert capsys.readouterr().err.count("\n") == 1


def test_a_method_that_cannot_be_run_ends_with_1_and_says_why(strangers_folder, tmp_path, capsys):
    words = [
        "--method",
        "bilateral",
        "--x",
        "verdict.bent_from=0.1,0.2",
        "--out",
        str(tmp_path),
        "--jobs",
        "1",
    ]
    assert main(["sweep", str(strangers_folder), *words]) == 1
    assert "could not be run: the bilateral method needs" in capsys.readouterr().out


@pytest.fixture
def cases(case_maker, small_case, strangers, tmp_path):
    case_maker(small_case, "deep/flat_1")
    case_maker(strangers, "neg_1")
    return tmp_path / "cases"


def test_compare_prints_a_row_per_method_and_leaves_tables_and_pictures(cases, tmp_path, capsys):
    out = tmp_path / "out"
    words = ["--methods", "paper-argmax,spectra-swarm,bilateral", "--out", str(out), "--jobs", "1"]
    assert main(["compare", str(cases), *words]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert lines[0].split()[:6] == ["method", "n", "right", "fine", "wrong", "none"]
    assert [line.split()[0] for line in lines[1:4]] == ["spectra-swarm", "paper-argmax", "bilateral"]
    assert lines[1].split()[1:7] == ["2", "1", "1", "1", "0", "1"]
    assert any("no part of the rivals" in line for line in lines)
    assert any(line.startswith("bilateral could not be run on 1 of the cases") for line in lines)
    told = json.loads((out / "compare.json").read_text())
    assert {(score["case"], score["method"]) for score in told["scores"]} == {
        (case, method)
        for case in ("deep/flat_1", "neg_1")
        for method in ("spectra-swarm", "paper-argmax", "bilateral")
    }
    assert told["methods"]["spectra-swarm"]["wrong_accepted"] == 0
    pictures = {
        f"{name}{end}" for name in ("bars", "maps_deep_flat_1", "maps_neg_1") for end in (".png", ".svg")
    }
    assert {path.name for path in out.iterdir()} == pictures | {"methods.csv", "scores.csv", "compare.json"}
    assert [row["method"] for row in table(out / "methods.csv")] == [
        "spectra-swarm",
        "paper-argmax",
        "bilateral",
    ]
    assert len(table(out / "scores.csv")) == 6


def test_a_case_that_cannot_be_read_costs_no_other_and_ends_with_1(cases, capsys):
    (cases / "neg_1" / "map2.pgm").write_bytes(b"P5 nonsense")
    assert main(["compare", str(cases), "--methods", "spectra-swarm", "--jobs", "1"]) == 1
    said = capsys.readouterr().out
    assert "spectra-swarm could not be run on 1 of the cases" in said
    assert said.splitlines()[1].split()[:3] == ["spectra-swarm", "1", "1"]


def test_without_a_truth_nothing_is_called_right_or_wrong(case_folder, tmp_path, capsys):
    folder = tmp_path / "mine"
    folder.mkdir()
    for path in case_folder.iterdir():
        if path.name != "truth.yaml":
            (folder / path.name).write_bytes(path.read_bytes())
    assert main(["compare", str(folder), "--methods", "spectra-swarm", "--jobs", "1"]) == 0
    said = capsys.readouterr().out
    assert said.splitlines()[1].split()[1:6] == ["1", "–", "–", "–", "–"]
    assert "1 of the cases have no truth.yaml" in said


@pytest.mark.parametrize(
    ("words", "remedy"),
    [
        (["no_such_sample"], "neither a folder nor a sample"),
        (["ofice_r2_r1"], "did you mean office_r2_r1?"),
        (["office_r2_r1", "--methods", "paper-argmx"], "did you mean paper-argmax?"),
        (["office_r2_r1", "--methods", ""], "known are spectra-proven"),
        (["office_r2_r1", "--jobs", "2", "--scheduler", "tcp://127.0.0.1:1"], "not allowed with"),
    ],
)
def test_wrong_words_to_compare_end_with_2_and_one_line(words, remedy, capsys):
    assert usage_error("compare", *words) == 2
    said = capsys.readouterr().err
    assert remedy in said
    assert said.count("\n") == 1
