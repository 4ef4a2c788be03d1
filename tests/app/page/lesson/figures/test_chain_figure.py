"""The lesson's picture of three robots: what it says before, and once the pairs are merged."""

from __future__ import annotations

import re
from html import unescape

import pytest

from algorithms.common.pose import pose_error
from algorithms.files.fleet_truth_file import read_fleet_truth
from algorithms.methods.registry import METHODS
from app.drawing.palette import LIGHT
from app.model.merge_inputs import MergeInputs
from app.model.run_state import RunState
from app.page.lesson.chain_runs import OPEN, SAMPLE, chain_of, chain_runs
from app.page.lesson.figures.chain_figure import (
    chain,
    far_end,
    runs_of,
    second_at,
    second_sighting,
    shares_after,
)
from app.page.lesson.lesson_run import LessonRun
from app.page.lesson.side_runs import SideRuns
from app.system import data_paths as paths


@pytest.fixture(scope="module")
def over() -> SideRuns:
    """All three merged."""
    runs = chain_runs()
    for one in runs.each:
        one.run = RunState(one.job.config)
        for step in one.job.run({}):
            one.run.add(step)
    return runs


def lesson(small_case, sides: dict[str, SideRuns]) -> LessonRun:
    return LessonRun(MergeInputs.of(small_case), METHODS["spectra-proven"].defaults, sides=sides)


def words(svg: str) -> str:
    return unescape(" ".join(re.findall(r"<text[^>]*>([^<]*)</text>", svg)))


def test_before_the_pairs_are_merged_it_says_which_are(small_case, over):
    fresh = lesson(small_case, {})
    assert words(chain(fresh, (), LIGHT)).count("waits …") == 3
    begun = SideRuns(*chain_runs().each[:2], over.each[2])
    begun.each[0].run = RunState(begun.each[0].job.config)
    said = words(chain(lesson(small_case, {"chain": begun}), (), LIGHT))
    assert [said.count(state) for state in ("merging …", "waits …", "merged")] == [1, 1, 1]
    assert runs_of(fresh) is not runs_of(fresh)  # nothing is kept that has not begun


def test_the_error_grows_along_the_chain_and_shrinks_once_the_loop_is_closed(small_case, over):
    said = words(chain(lesson(small_case, {"chain": over}), (), LIGHT))
    near, far, closed = (float(each) for each in re.findall(r"± (\d\.\d\d) m", said))
    assert far > near
    assert far > closed
    right, twin = (float(each) for each in re.findall(r"(\d+\.\d) deviations", said))
    assert right < 3
    assert twin > 10
    assert "then right to > 99.9%" in said


def test_the_open_pair_is_the_last_and_the_way_round_puts_its_robot_where_it_truly_is(over):
    found = chain_of(over)
    *_, open_pair = found.findings
    assert (open_pair.order.ref, open_pair.order.mov) == OPEN
    assert not open_pair.accepted
    truth = read_fleet_truth(paths.fleets()[SAMPLE] / "truth.yaml")
    distance, angle = pose_error(found.result.placed["r2"], truth.T_anchor_robot["r2"], truth.at["r2"])
    assert distance < truth.tolerance_m
    assert angle < truth.tolerance_rad
    assert chain_of(chain_runs()) is None


def test_a_second_sighting_leaves_the_answer_it_agrees_with_and_between_both_neither(small_case, over):
    told = lesson(small_case, {"chain": over})
    found = chain_of(over)
    answers = found.findings[-1].hypotheses[:2]
    far = far_end(found)
    for k, answer in enumerate(answers):
        shares = shares_after(found, answer.T_ref_mov.apply(far))
        assert shares[k] > 0.9
        assert shares[1 - k] < 1e-3
    assert sum(second_at(told, (240, 240))) < 1e-3
    assert "neither" in words(second_sighting(told, (240, 240), LIGHT))
    assert "merging the pairs" in words(second_sighting(lesson(small_case, {}), (240, 240), LIGHT))
