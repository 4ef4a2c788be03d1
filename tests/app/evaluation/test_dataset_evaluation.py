"""Many cases at once: what counts as right, what the totals say, and that one bad case costs no other."""

import json
import os
from dataclasses import replace
from pathlib import Path

import pytest

from algorithms.common.errors import NoAnswerError
from algorithms.common.pose import Pose2
from algorithms.files.observation_file import known_to_bytes
from algorithms.methods import registry as methods
from algorithms.observations.priors import InitialPose
from app.cli.main import main
from app.evaluation import dataset_evaluation as evaluate
from app.evaluation.dataset_evaluation import EvaluatedCase, EvaluationTask, run_case, totals_of
from app.evaluation.method_run import Judgement
from app.jobs.executor import SerialExecutor
from app.jobs.process_executor import ProcessExecutor

METHOD = "spectra-swarm"
DEFAULTS = methods.METHODS[METHOD].defaults


def order(root, **more):
    return EvaluationTask(Path(root), {METHOD: DEFAULTS}, **more)


def entry(name, accepted=True, right=True, fine=False, seconds=1.0, judged=True, among=False):
    truth = Judgement(0.0, 0.0, right, fine, "merge", right or among) if judged else None
    report = {"verdict": {"accepted": accepted}}
    return EvaluatedCase(name, "o", report, truth=truth, seconds=seconds)


def test_totals_count_each_group_by_the_name_up_to_its_first_underscore():
    totals = totals_of(
        [
            entry("a_1_x", fine=True, seconds=1.0),
            entry("a_2", right=False, seconds=3.0, among=True),
            entry("a_3", right=False, accepted=False, seconds=8.0),
            entry("b_1", judged=False),
            entry("b_2", accepted=False),
            EvaluatedCase("b_3", "o", error="bad"),
        ]
    )
    assert list(totals) == ["a", "b", "overall"]
    assert totals["a"] == {
        "n": 3,
        "judged": 3,
        "right": 1,
        "fine": 1,
        "right_first": 1,
        "right_among_five": 2,
        "right_accepted": 1,
        "refused": 1,
        "wrong_accepted": 1,
        "errors": 0,
        "median_seconds": 3.0,
    }
    assert totals["b"] == {
        "n": 3,
        "judged": 1,
        "right": 1,
        "fine": 0,
        "right_first": 1,
        "right_among_five": 1,
        "right_accepted": 0,
        "refused": 1,
        "wrong_accepted": 0,
        "errors": 1,
        "median_seconds": 1.0,
    }
    assert totals["overall"]["n"] == 6


def test_an_accepted_case_without_a_truth_is_not_called_wrong():
    assert totals_of([entry("a", judged=False)])["overall"]["wrong_accepted"] == 0


def likely(name, probability, right, expected="merge"):
    report = {"verdict": {"accepted": probability > 0.5, "probability": probability}}
    return EvaluatedCase(name, "o", report, truth=Judgement(0.0, 0.0, right, False, expected))


def test_probabilities_that_say_what_happens_have_no_calibration_error():
    sure = [likely(f"a_{k}", 1.0, True) for k in range(5)] + [likely(f"b_{k}", 0.0, False) for k in range(5)]
    told = evaluate.calibration_of(sure)
    assert (told["n"], told["ece"], told["brier"]) == (10, 0.0, 0.0)
    assert [each["n"] for each in told["bins"] if each["n"]] == [5, 5]


def test_a_wrong_pair_that_was_refused_counts_as_a_transform_that_is_not_right():
    told = evaluate.calibration_of([likely("a", 0.25, True, "refuse"), likely("b", 0.25, False)])
    assert told["ece"] == pytest.approx(0.25)
    assert told["brier"] == pytest.approx(0.0625)


def test_a_method_without_an_answer_gives_it_no_chance(unanswering, case_folder):
    told = evaluate.calibration_of([run_case(case_folder, order(case_folder))])
    assert (told["n"], told["ece"], told["brier"]) == (1, 0.0, 0.0)


@pytest.mark.parametrize("count", ["0", "-1", "many"])
def test_a_count_of_wrong_pairs_is_a_whole_number(count, case_folder, capsys):
    with pytest.raises(SystemExit) as left:
        main(["evaluate", str(case_folder), f"--wrong-pairs={count}"])
    assert left.value.code == 2
    assert "whole number from 1 up" in capsys.readouterr().err


@pytest.fixture
def cases(case_maker, small_case, strangers, tmp_path):
    """A folder of five cases: right, unjudged, to be refused, broken, and one a level deeper."""
    case_maker(small_case, "flat_1")
    case_maker(replace(small_case, truth=None), "flat_2")
    case_maker(strangers, "neg_1")
    broken = case_maker(small_case, "bad_1")
    (broken / "map2.pgm").write_bytes(b"P5 nonsense")
    case_maker(small_case, "more/flat_3")
    return tmp_path / "cases"


def test_evaluate_runs_every_case_and_goes_on_after_a_broken_one(cases, tmp_path, capsys):
    assert main(["evaluate", str(cases), "--json", str(tmp_path / "out.json")]) == 1  # one could not run
    told = json.loads((tmp_path / "out.json").read_text())
    by_name = {case["case"]: case for case in told["cases"]}
    assert list(by_name) == ["bad_1", "flat_1", "flat_2", "more/flat_3", "neg_1"]
    assert "map2.pgm" in by_name["bad_1"]["error"]
    assert "report" not in by_name["bad_1"]
    assert by_name["flat_1"]["truth"]["right"]
    assert by_name["flat_2"]["truth"] is None
    assert by_name["flat_1"]["observation"] == "observation.yaml"
    assert by_name["flat_1"]["report"]["T_ref_mov"] == by_name["flat_2"]["report"]["T_ref_mov"]
    assert by_name["neg_1"]["truth"]["right"]
    assert told["totals"]["flat"]["n"] == 3
    assert told["totals"]["overall"]["wrong_accepted"] == 0
    said = capsys.readouterr().out
    assert "failed: bad_1: " in said
    assert said.splitlines()[0].split()[:2] == ["group", "n"]


def without_times(cases):
    told = [case.plain() for case in cases]
    for case in told:
        case.pop("seconds")
        case.get("report", {}).pop("timings_s", None)
    return sorted(told, key=lambda case: case["case"])


def test_the_answers_do_not_depend_on_how_many_processes_work(cases):
    one = list(evaluate.evaluate(order(cases), SerialExecutor()))
    two = list(evaluate.evaluate(order(cases), ProcessExecutor(2)))
    assert without_times(one) == without_times(two)


def test_rough_takes_the_badly_measured_observation(cases):
    told = run_case(cases / "flat_1", order(cases, rough=True))
    assert told.observation == "observation_rough.yaml"
    fine = run_case(cases / "flat_1", order(cases))
    assert told.report["verdict"]["deviation"] != fine.report["verdict"]["deviation"]


def test_both_runs_every_case_with_either_observation_and_prints_a_table_for_each(cases, tmp_path, capsys):
    (cases / "flat_2" / "observation_rough.yaml").unlink()  # a case need not have one
    (cases / "bad_1" / "map2.pgm").unlink()
    assert main(["evaluate", str(cases), "--both", "--json", str(tmp_path / "out.json")]) == 1
    told = json.loads((tmp_path / "out.json").read_text())
    ran = [(entry["case"], entry["observation"]) for entry in told["cases"]]
    good, rough = "observation.yaml", "observation_rough.yaml"
    assert [case for case, file in ran if file == good] == [
        *("bad_1", "flat_1", "flat_2", "more/flat_3", "neg_1"),
    ]
    assert [case for case, file in ran if file == rough] == ["bad_1", "flat_1", "more/flat_3", "neg_1"]
    assert told["totals"]["overall"]["n"] == 9
    assert told["totals_by_observation"][good]["flat"]["n"] == 3
    assert told["totals_by_observation"][rough]["flat"]["n"] == 2
    lines = capsys.readouterr().out.splitlines()
    assert lines[0] == good
    assert lines[lines.index(rough) - 1] == ""
    for title in (good, rough):
        assert lines[lines.index(title) + 1].split()[:4] == ["group", "n", "right", "fine"]
    assert sum(line.startswith("failed: bad_1: ") for line in lines) == 2


def test_rough_and_both_exclude_each_other(cases, capsys):
    with pytest.raises(SystemExit) as left:
        main(["evaluate", str(cases), "--rough", "--both"])
    assert left.value.code == 2
    assert "not allowed with" in capsys.readouterr().err


def test_a_bug_in_one_case_is_told_as_one(cases, monkeypatch):
    monkeypatch.setattr(methods, "run", lambda *_args: 1 / 0)
    told = run_case(cases / "flat_1", order(cases))
    assert told.error == "bug: ZeroDivisionError: division by zero"


def die(_, given):
    """Stands for what works on a case: one of them takes its process down."""
    folder, _order, _read = given
    if folder.name == "neg_1":
        os._exit(1)
    return EvaluatedCase(folder.name, "o")


def test_a_case_that_kills_its_process_costs_no_other(cases, monkeypatch):
    monkeypatch.setattr(evaluate, "_work", die)
    told = list(evaluate.evaluate(order(cases), ProcessExecutor(2)))
    assert {case.case for case in told} == {"bad_1", "flat_1", "flat_2", "flat_3", "neg_1"}
    assert [case.case for case in told if case.error] == ["neg_1"]


def test_a_folder_without_cases_ends_with_2(tmp_path, capsys):
    assert main(["evaluate", str(tmp_path)]) == 2
    assert "map1.yaml" in capsys.readouterr().err


def test_one_case_can_be_given_as_the_folder(cases, tmp_path, capsys):
    assert main(["evaluate", str(cases / "flat_1"), "--json", str(tmp_path / "out.json")]) == 0
    told = json.loads((tmp_path / "out.json").read_text())
    assert [case["case"] for case in told["cases"]] == ["flat_1"]


def test_no_report_takes_the_place_of_a_file_of_a_case(cases, capsys):
    place = cases / "flat_1" / "map1.yaml"
    before = place.read_bytes()
    for folder in (cases, cases / "flat_1"):
        assert main(["evaluate", str(folder), "--json", str(place)]) == 2
        assert "lies in the folder of a case; choose another place for --json" in capsys.readouterr().err
    assert place.read_bytes() == before


# ---- a method that finds no transform


@pytest.fixture
def unanswering(monkeypatch):
    """A method that sees nothing in any map."""

    def run(*_):
        raise NoAnswerError("nothing in these maps is like anything else")
        yield

    monkeypatch.setitem(methods.METHODS, METHOD, replace(methods.METHODS[METHOD], search=run))


def test_a_case_without_an_answer_is_refused_not_failed(unanswering, case_folder):
    told = run_case(case_folder, order(case_folder))
    assert told.no_answer == "Refused: nothing in these maps is like anything else."
    assert not told.plain().keys() & {"report", "error"}
    assert (told.truth.right, told.truth.distance) == (False, None)
    totals = totals_of([told])["overall"]
    assert (totals["refused"], totals["errors"], totals["right"]) == (1, 0, 0)
    assert (totals["judged"], totals["wrong_accepted"]) == (1, 0)


def test_where_refusing_is_right_no_answer_is_right(unanswering, strangers_folder):
    told = run_case(strangers_folder, order(strangers_folder))
    assert told.truth.right
    assert totals_of([told])["overall"]["right"] == 1


def test_without_a_truth_no_answer_is_not_judged(unanswering, small_case, case_maker):
    folder = case_maker(replace(small_case, truth=None), "x_1")
    told = run_case(folder, order(folder.parent))
    assert told.truth is None
    assert totals_of([told])["overall"]["refused"] == 1


def test_evaluate_ends_with_0_where_a_case_has_no_answer(unanswering, case_folder, capsys):
    assert main(["evaluate", str(case_folder), "--method", METHOD]) == 0
    assert "failed" not in capsys.readouterr().out


# ---- knowledge other than a sighting

KINDS = ("sighting", "initial", "turn", "none")


@pytest.fixture
def two(case_maker, small_case, strangers, tmp_path):
    """A folder of a case to be merged, and one to be refused."""
    case_maker(small_case, "flat_1")
    case_maker(strangers, "neg_1")
    return tmp_path / "cases"


def test_each_kind_of_knowledge_has_its_table_and_the_method_that_suits_it(two, tmp_path, capsys):
    words = ["--knowledge", ",".join(KINDS), "--json", str(tmp_path / "out.json")]
    assert main(["evaluate", str(two), *words]) == 0
    told = json.loads((tmp_path / "out.json").read_text())
    assert [(each["knowledge"], each["case"]) for each in told["cases"]] == [
        (kind, case) for kind in KINDS for case in ("flat_1", "neg_1")
    ]
    for each in told["cases"]:
        sighting = each["knowledge"] == "sighting"
        assert each["report"]["method"] == ("spectra-proven" if sighting else "whole-plane")
        assert ("drawn" in each) is (each["knowledge"] in ("initial", "turn"))
        assert each["truth"]["right"]
        assert each["truth"]["among_five"] is (each["case"] == "flat_1")
    assert list(told["by_knowledge"]) == list(KINDS)
    for kind, found in told["by_knowledge"].items():
        overall = found["totals"]["overall"]
        assert (overall["n"], overall["right"], overall["right_first"]) == (2, 2, 1), kind
        assert found["calibration"]["n"] == 2
    assert told["totals"]["overall"]["n"] == 2 * len(KINDS)
    lines = capsys.readouterr().out.splitlines()
    assert [line for line in lines if line in KINDS] == list(KINDS)
    assert sum("first five" in line for line in lines) == len(KINDS)


def test_what_is_drawn_is_the_same_on_any_number_of_processes(two):
    asked = EvaluationTask(two, {"harris": methods.METHODS["harris"].defaults}, knowledge="initial")
    one = list(evaluate.evaluate(asked, SerialExecutor()))
    assert all(each.drawn for each in one)
    assert without_times(one) == without_times(evaluate.evaluate(asked, ProcessExecutor(2)))


def test_a_case_that_holds_a_rough_pose_alone_is_run_by_the_method_that_suits_it(two, small_case):
    pose = small_case.truth.T_ref_mov
    prior = InitialPose(replace(pose, x=pose.x + 0.4))
    (two / "flat_1" / "observation.yaml").write_bytes(known_to_bytes([prior]))
    configs = {name: methods.METHODS[name].defaults for name in ("spectra-proven", "whole-plane")}
    told = run_case(two / "flat_1", EvaluationTask(two, configs))
    assert told.report["method"] == "whole-plane"
    assert told.transform_right


def test_a_case_that_contradicts_itself_is_told_and_costs_no_other(two, small_case):
    far = InitialPose(Pose2(900.0, 900.0, 1.0))
    known = known_to_bytes([*small_case.observations, far])
    (two / "flat_1" / "observation.yaml").write_bytes(known)
    told = {each.case: each for each in evaluate.evaluate(order(two))}
    assert "standard deviations of both" in told["flat_1"].error
    assert not told["neg_1"].error


@pytest.mark.parametrize(
    ("words", "remedy"),
    [
        (["--knowledge", "non"], "there is no knowledge non, did you mean none?"),
        (["--knowledge", "none,"], "known are sighting, initial, turn, none"),
        (["--knowledge", "turn", "--method", "spectra-swarm"], "spectra-swarm needs a sighting, and "),
        (
            ["--knowledge", "none", "--method", "bilateral"],
            "choose a --method that does without: whole-plane",
        ),
        (["--knowledge", "sighting,none", "--swarm.particles", "90"], "spectra-proven needs a sighting"),
        (["--knowledge", "none", "--swarm.particles", "90"], "no option --swarm.particles"),
        (["--knowledge", "none", "--rough"], "--rough and --both choose a sighting"),
        (["--knowledge", "initial,turn", "--both"], "--knowledge initial,turn leaves it out"),
    ],
)
def test_knowledge_that_cannot_be_asked_for_ends_with_2_and_one_line(words, remedy, case_folder, capsys):
    with pytest.raises(SystemExit) as left:
        main(["evaluate", str(case_folder), *words])
    assert left.value.code == 2
    said = capsys.readouterr().err
    assert remedy in said
    assert said.count("\n") == 1
