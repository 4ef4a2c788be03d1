"""What every baseline shares: the sighting before its search, and after it the verdict of any method."""

from __future__ import annotations

import numpy as np
import pytest
from drawn import T_REF_MOV, flat_pair

from algorithms.common.pose import Pose2
from algorithms.maps.map_fusion import ConflictRule, fuse
from algorithms.methods.baselines.base import BaselineConfig, weigh_best
from algorithms.methods.merge_result import Answer, MergeResult
from algorithms.methods.shared_stages import run_search
from algorithms.methods.steps import AnswersDetail, ObservationDetail, WeighedDetail
from algorithms.observations.observation import encounter, robots_of
from algorithms.observations.pair_problem import PairProblem
from algorithms.verdict.decision import VerdictConfig

REF, MOV, SEEN, _ = flat_pair()
COVARIANCE = np.diag([1.0, 4.0, 9.0])
ELSEWHERE = T_REF_MOV @ Pose2(2.0, 1.0, 1.0)


def searching(*places: Pose2, calls: list[str] | None = None, valued: bool = True):
    """A search that finds these transforms, best first."""

    def make():
        if calls is not None:
            calls.append("searched")
        return [AnswersDetail(tuple(Answer(T, 7.5 - k, "looked") for k, T in enumerate(places)))]

    def search(problem, config, seed, runner):
        found = yield from runner.stage("search", ("asked",), make)
        return (yield from weigh_best(problem, config, runner, found, COVARIANCE, valued))

    return search


def steps(*places: Pose2, config: BaselineConfig | None = None, memo=None, calls=None, valued=True):
    problem, search = PairProblem(REF, MOV, (SEEN,)), searching(*places, calls=calls, valued=valued)
    return list(run_search(search, problem, config or BaselineConfig(), 5, memo, "mine"))


def ended(*places: Pose2, **named) -> MergeResult:
    return steps(*places, **named)[-1].detail


def test_the_stages_come_in_the_order_of_the_work_and_the_last_one_tells_the_result():
    told = steps(T_REF_MOV)
    assert [step.stage for step in told] == ["observe", "search", "weigh", "fuse", "verdict"]
    assert isinstance(told[0].detail, ObservationDetail)
    assert told[0].detail.encounter.x_ref == pytest.approx(encounter(SEEN).x_ref)
    assert isinstance(told[2].detail, WeighedDetail)
    assert isinstance(told[-1].detail, MergeResult)


def test_the_result_is_the_best_of_what_the_search_found_with_its_covariance():
    result = ended(T_REF_MOV, ELSEWHERE)
    assert result.T_ref_mov == T_REF_MOV
    assert [answer.T_ref_mov for answer in result.answers] == [T_REF_MOV, ELSEWHERE]
    assert np.array_equal(result.covariance, COVARIANCE)
    assert (result.method, result.seed) == ("mine", 5)
    assert set(result.timings_s) == {"observe", "search", "weigh", "fuse", "verdict"}


def test_a_value_that_says_nothing_is_not_told():
    assert ended(T_REF_MOV).value == 7.5
    assert ended(T_REF_MOV, valued=False).value is None


def test_a_right_transform_is_accepted_and_a_wrong_one_refused_as_of_any_method():
    assert ended(T_REF_MOV).verdict.accepted
    assert not ended(ELSEWHERE).verdict.accepted
    strict = BaselineConfig(verdict=VerdictConfig(accept_from=0.999))
    assert ended(T_REF_MOV, config=strict).verdict.probability == ended(T_REF_MOV).verdict.probability


def test_a_transform_that_a_better_one_lies_beside_is_told_to_move_there():
    """A baseline that is off by little must not pass because nobody looked beside its answer."""
    result = ended(Pose2(0.25, 0.15) @ T_REF_MOV)
    beside = [other.T_ref_mov for other in result.weighed[1:]]
    assert any(np.allclose(T.xy, T_REF_MOV.xy, atol=0.06) for T in beside)


@pytest.mark.parametrize("conflict", list(ConflictRule))
def test_the_cells_are_merged_as_the_settings_say(conflict):
    result = ended(ELSEWHERE, config=BaselineConfig(conflict=conflict))
    robots = robots_of([encounter(SEEN)], VerdictConfig().robot_size)
    assert np.array_equal(
        result.fusion.merged.cells, fuse((REF, MOV), (Pose2(), ELSEWHERE), conflict, robots).merged.cells
    )


def test_what_is_remembered_of_an_equal_run_is_not_worked_out_again():
    memo, calls = {}, []
    first = steps(T_REF_MOV, memo=memo, calls=calls)
    again = steps(T_REF_MOV, memo=memo, calls=calls)
    assert calls == ["searched"]
    assert not any(step.reused for step in first)
    assert again[1].reused
    assert again[1].detail is first[1].detail
