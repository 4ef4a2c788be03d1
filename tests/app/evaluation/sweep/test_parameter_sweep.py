"""A sweep: every place once, the same numbers however it was interrupted, a plan that is checked first."""

import json
from contextlib import closing
from dataclasses import asdict, replace
from itertools import islice, pairwise

import pytest
from hypothesis import given
from hypothesis import strategies as st
from sweep_plans import INTENSITY, METHOD, SMALL, SPREAD, plan, trials, untimed

from algorithms.common.errors import OutputError, SettingError
from algorithms.maps.grid_map import GridMap
from algorithms.methods.registry import METHODS
from app.evaluation.method_run import MethodRun, run_method, true_fusion
from app.evaluation.sweep import parameter_sweep as sweeping
from app.evaluation.sweep.checkpoint import Checkpoint
from app.evaluation.sweep.parameter_sweep import Spread, SweepAxis, SweepPlan, in_order, point_keys, sweep
from app.jobs.executor import Executor, SerialExecutor
from app.system import version


class Nobody(Executor):
    """Whoever is asked though there is nothing to do."""

    jobs = 1

    def run(self, work, tasks, stop=None):
        raise AssertionError("there was work left")


@given(trials)
def test_a_trial_comes_back_from_json_as_it_was(trial):
    assert MethodRun.of(json.loads(json.dumps(asdict(trial)))) == trial


@given(st.integers(0, 300))
def test_coarse_to_fine_visits_every_place_once_and_the_ends_first(n):
    order = sweeping._coarse_first(list(range(n)))
    assert sorted(order) == list(range(n))
    assert set(order[:2]) == {0, n - 1} or n < 2


@given(st.integers(3, 300))
def test_half_way_through_no_gap_of_a_curve_is_wider_than_four_places(n):
    order = sorted(sweeping._coarse_first(list(range(n)))[: n // 2 + 1])
    assert max(later - earlier for earlier, later in pairwise(order)) <= 4


@given(st.lists(st.floats(0, 1), min_size=1, max_size=12))
def test_mean_and_median_lie_between_the_extremes(values):
    spread = Spread.of(values)
    for middle in (spread.mean, spread.median):
        assert spread.low - 1e-12 <= middle <= spread.high + 1e-12
    assert (spread.deviation == 0) == (spread.low == spread.high) or spread.deviation < 1e-12


def test_every_place_is_swept_with_every_seed_and_told_in_order_of_the_table(small_case):
    points = list(sweep(small_case, plan(), SerialExecutor()))
    assert {(point.x, point.y) for point in points} == {
        (x, y) for x in (0.5, 1.0, 3.0) for y in (10.0, 100.0)
    }
    assert [(p.x, p.y) for p in in_order(plan(), points)] == plan().places()
    assert all(len(point.trials) == 2 and not point.failed for point in points)
    assert all(0 <= point.index.low <= point.index.high <= 1 for point in points)


def test_a_trial_within_a_sweep_is_the_merge_alone_with_that_seed_and_those_settings(small_case):
    (point,) = (p for p in sweep(small_case, plan(), SerialExecutor()) if (p.x, p.y) == (1.0, 100.0))
    alone = run_method(small_case, METHOD, plan().config_at(1.0, 100.0), 1, true_fusion(small_case))
    assert replace(point.trials[1], seconds=0.0) == replace(alone, seconds=0.0)


def test_the_intensity_moves_no_answer(small_case):
    points = list(
        sweep(small_case, plan(x=SweepAxis(INTENSITY, (1.0, 30.0, 1000.0)), y=None), SerialExecutor())
    )
    first, *others = [point.index.mean for point in points]
    assert others == pytest.approx([first] * 2, abs=1e-3)


def test_an_interrupted_sweep_goes_on_where_it_was_and_ends_as_if_it_had_not_been(small_case, tmp_path):
    whole = untimed(in_order(plan(), list(sweep(small_case, plan(), SerialExecutor()))))
    path = tmp_path / "new" / "journal.jsonl"
    with closing(sweep(small_case, plan(), SerialExecutor(), Checkpoint(path))) as running:
        before = list(islice(running, 3))
    with path.open("ab") as stream:
        stream.write(b'{"key": "half a li')  # what a process leaves that is killed as it writes
    points = list(sweep(small_case, plan(), SerialExecutor(), Checkpoint(path)))
    assert points[:3] == before  # times and all
    assert untimed(in_order(plan(), points)) == whole
    assert list(sweep(small_case, plan(), Nobody(), Checkpoint(path))) != []


def test_points_of_an_earlier_sweep_serve_a_wider_one(small_case):
    journal = Checkpoint()
    narrow = plan(x=SweepAxis(SPREAD, (0.5, 1.0)), y=None)
    first = list(sweep(small_case, narrow, SerialExecutor(), journal))
    wide = list(sweep(small_case, plan(y=None), SerialExecutor(), journal))
    assert [point for point in wide if point in first] == wide[:2]
    assert len(wide) == 3


def test_what_a_point_rests_on_is_its_key(small_case):
    keys = point_keys(small_case, plan())
    assert len(set(keys.values())) == 6
    renamed = replace(small_case, name="other", ref=replace(small_case.ref, name="other"))
    assert point_keys(renamed, plan()) == keys
    cells = small_case.ref.cells.copy()
    cells[5, 5] += 1
    for case, other in (
        (replace(small_case, ref=GridMap(cells, small_case.ref.resolution, small_case.ref.origin)), plan()),
        (replace(small_case, truth=None), plan()),
        (replace(small_case, observations=small_case.observations * 2), plan()),
        (small_case, plan(seeds=(0, 2))),
        (small_case, replace(plan(), config=replace(SMALL, swarm=replace(SMALL.swarm, omega=0.5)))),
    ):
        assert not set(point_keys(case, other).values()) & set(keys.values())


def test_the_code_that_a_method_stands_on_is_told_apart_from_all_other_code():
    swarm = version._stands_on("algorithms.methods.spectra_method")
    assert {
        "algorithms/optimisation/particle_swarm.py",
        "algorithms/common/pose.py",
        "algorithms/common/parallel_kernels.py",
    } <= swarm
    assert "algorithms/methods/registry.py" not in swarm
    assert not [path for path in swarm if "simulator" in path]
    assert version._stands_on("algorithms.common.pose") == {"algorithms/common/pose.py"}
    told = {
        version.code(),
        version.code("algorithms.methods.spectra_method"),
        version.code("algorithms.common.pose"),
    }
    assert len(told) == 3
    assert version.code("algorithms.common.pose") == version.code("algorithms.common.pose")


def test_a_value_out_of_bounds_is_refused_before_anything_is_run():
    with pytest.raises(SettingError, match=r"must lie in \[0.2, 20\] m"):
        plan(x=SweepAxis(SPREAD, (1.0, 25.0)))


def test_without_a_truth_the_index_is_that_of_the_estimate_and_nothing_is_called_right(small_case):
    (point,) = sweep(
        replace(small_case, truth=None), plan(x=SweepAxis(SPREAD, (1.0,)), y=None), SerialExecutor()
    )
    assert point.right is None
    assert point.index.mean > 0.5


def test_a_method_that_cannot_be_run_says_so_and_is_tried_again_next_time(small_case):
    seen = replace(small_case.observations[0], bearing_back=None)
    case, journal = replace(small_case, observations=(seen,)), Checkpoint()
    asked = SweepPlan(
        "bilateral", METHODS["bilateral"].defaults, SweepAxis(("verdict", "bent_from"), (0.2,)), seeds=(0,)
    )
    (point,) = sweep(case, asked, SerialExecutor(), journal)
    assert "needs measurement.bearing_back" in point.failed
    assert point.index is None
    assert journal.get(point_keys(case, asked)[0.2, None]) is None


def test_a_journal_that_cannot_be_written_names_the_remedy(tmp_path):
    (tmp_path / "file").touch()
    with pytest.raises(OutputError, match="choose another --out"):
        Checkpoint(tmp_path / "file" / "journal.jsonl").add("key", {})
