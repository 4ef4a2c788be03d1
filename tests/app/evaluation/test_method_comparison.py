"""Several methods on the same pairs: what counts as right and wrong, and that none costs another."""

import warnings
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from sweep_plans import trials

from algorithms.common.errors import NoAnswerError
from algorithms.common.pose import Pose2, pose_error
from algorithms.methods.registry import METHODS, PLANE_METHOD, merge
from app.evaluation.method_comparison import (
    ComparedRun,
    compare_methods,
    defaults_of,
    pairs_in,
    tally,
)
from app.evaluation.method_run import run_method, true_fusion
from app.jobs.executor import Executor, LostTask, SerialExecutor

QUICK = "spectra-swarm"


def outcomes(pairs, names=(QUICK,)):
    return {(s.case, s.method): s.trial for s in compare_methods(pairs, defaults_of(names), SerialExecutor())}


@given(st.lists(trials))
def test_what_is_judged_is_right_or_wrong_or_no_answer(found):
    kept = [
        replace(trial, right=False) if trial.T_ref_mov is None and trial.right else trial for trial in found
    ]
    for row in tally([ComparedRun("case", QUICK, trial) for trial in kept]).values():
        assert row.n + row.failed == len(found)
        assert row.right + row.wrong + row.no_answer == row.judged <= row.n
        assert row.wrong_accepted <= row.wrong
        assert row.index is None or 0 <= row.index <= 1


def test_every_pair_meets_every_method(small_case, strangers):
    told = outcomes([("flat", small_case), ("neg", strangers)], (QUICK, "paper-argmax"))
    assert set(told) == {(case, method) for case in ("flat", "neg") for method in (QUICK, "paper-argmax")}
    assert told["flat", QUICK].right
    assert told["flat", QUICK].accepted
    assert told["flat", QUICK].index > 0.95


def test_walls_alone_are_told_nothing_and_judged_as_the_others_are(small_case):
    seen = small_case.observations[0]
    case = replace(small_case, observations=(replace(seen, range=seen.range + 6.0),))
    told = outcomes([("flat", case)], (PLANE_METHOD, f"{PLANE_METHOD}-walls-alone"))
    misled, alone = told["flat", PLANE_METHOD], told["flat", f"{PLANE_METHOD}-walls-alone"]
    assert not misled.right
    assert alone.right
    T = merge(case.ref, case.mov).T_ref_mov
    assert alone.T_ref_mov == (T.x, T.y, T.theta)
    at = np.array([seen.observed_x, seen.observed_y])
    assert alone.distance == pytest.approx(pose_error(T, case.truth.T_ref_mov, at)[0])


def test_of_maps_that_share_no_place_every_transform_is_wrong_also_a_refused_one(strangers):
    trial = outcomes([("neg", strangers)])["neg", QUICK]
    assert trial.wrong
    assert not trial.accepted
    assert trial.index is None
    row = tally([ComparedRun("neg", QUICK, trial)])[QUICK]
    assert (row.right, row.wrong, row.refused, row.wrong_accepted) == (0, 1, 1, 0)


def test_a_method_without_an_answer_is_refused_and_merged_nothing(small_case, strangers, monkeypatch):
    def lost(*_args):
        raise NoAnswerError("no corner of one map was found in the other")
        yield

    monkeypatch.setitem(METHODS, QUICK, replace(METHODS[QUICK], search=lost))
    trial = run_method(small_case, QUICK, None, 0, true_fusion(small_case))
    assert (trial.T_ref_mov, trial.accepted, trial.right, trial.index) == (None, False, False, 0.0)
    assert "no corner" in trial.reason
    assert not trial.wrong
    assert run_method(strangers, QUICK, None, 0, None).right  # there is no transform to be found
    row = tally([ComparedRun("flat", QUICK, trial)])[QUICK]
    assert (row.no_answer, row.wrong, row.refused, row.index) == (1, 0, 1, 0.0)


def test_what_cannot_be_run_or_read_costs_no_other(small_case):
    seen = replace(small_case.observations[0], bearing_back=None)
    told = outcomes(
        [("bad", "map2.pgm: is torn"), ("flat", replace(small_case, observations=(seen,)))],
        (QUICK, "bilateral"),
    )
    assert told["bad", QUICK].reason == "map2.pgm: is torn"
    assert told["flat", "bilateral"].failed
    assert "bearing_back" in told["flat", "bilateral"].reason
    assert told["flat", QUICK].right
    rows = tally([ComparedRun(case, method, trial) for (case, method), trial in told.items()])
    assert (rows["bilateral"].n, rows["bilateral"].failed, rows["bilateral"].seconds) == (0, 2, None)
    assert (rows[QUICK].n, rows[QUICK].failed) == (1, 1)


def test_a_truth_that_puts_the_maps_a_thousand_miles_apart_costs_no_other_case(small_case):
    far = replace(small_case, truth=replace(small_case.truth, T_ref_mov=Pose2(1e6, 1e6)))
    told = outcomes([("far", far), ("flat", small_case)])
    assert "the limit is" in told["far", QUICK].reason
    assert told["flat", QUICK].right


@pytest.mark.parametrize("method", ["harris", "surf", "orb"])
def test_a_rival_that_finds_nothing_says_so_and_warns_of_nothing_on_the_terminal(strangers, method):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        trial = outcomes([("neg", strangers)], (method,))["neg", method]
    assert trial.reason.startswith("Refused: ")


def test_a_bug_in_a_method_is_told_as_one(small_case, monkeypatch):
    monkeypatch.setitem(METHODS, QUICK, replace(METHODS[QUICK], search=lambda *_args: iter([1 / 0])))
    assert "bug: ZeroDivisionError" in outcomes([("flat", small_case)])["flat", QUICK].reason


def test_a_method_whose_process_dies_is_told_as_failed(small_case):
    class Deadly(Executor):
        jobs = 1

        def run(self, work, tasks, stop=None):
            yield from ((number, LostTask()) for number, _ in enumerate(tasks))

    (score,) = compare_methods([("flat", small_case)], defaults_of([QUICK]), Deadly())
    assert score.trial.failed
    assert "too little memory" in score.trial.reason


def test_pairs_of_a_folder_are_read_when_it_is_their_turn_and_a_broken_one_is_told(
    case_maker, small_case, tmp_path
):
    case_maker(small_case, "flat_1")
    (case_maker(small_case, "bad/flat_2") / "map1.pgm").write_bytes(b"P5 nonsense")
    n, pairs = pairs_in(tmp_path / "cases")
    assert n == 2
    found = dict(pairs)
    assert list(found) == ["bad/flat_2", "flat_1"]
    assert isinstance(found["bad/flat_2"], str)
    assert "map1.pgm" in found["bad/flat_2"]
    (_, rough), *_ = pairs_in(tmp_path / "cases" / "flat_1", rough=True)[1]
    assert rough.observation_file == "observation_rough.yaml"


@pytest.mark.parametrize("names", [("paper-argmax", QUICK), (QUICK, "paper-argmax")])
def test_methods_stand_in_the_order_of_their_table(names):
    assert list(defaults_of(names)) == [QUICK, "paper-argmax"]
