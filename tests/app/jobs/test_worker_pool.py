"""Merges in processes of their own: the same as here, whatever becomes of the process."""

from __future__ import annotations

import gc
import os
import signal
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from functools import partial
from threading import Event, Thread, Timer

import numpy as np
import pytest
from commandline import ROOT
from hypothesis import given
from hypothesis import strategies as st
from wire import until

from algorithms.common.errors import NoAnswerError, SettingError
from algorithms.common.pose import Pose2
from algorithms.maps.grid_map import FREE, GridMap
from algorithms.methods.manual_merge import ManualMerge, refine
from algorithms.methods.merge_result import MergeResult
from algorithms.methods.registry import METHODS
from algorithms.methods.steps import ObservationDetail, Step
from algorithms.observations.pair_problem import PairProblem
from app.jobs.incremental_pickle import IncrementalPickle
from app.jobs.runner import RunCallbacks
from app.jobs.worker_pool import WorkerDiedError, WorkerPool
from app.model.merge_job import MergeJob
from app.system.memory import whole


@pytest.fixture(scope="module")
def workers() -> Iterator[WorkerPool]:
    workers = WorkerPool(most=1)
    yield workers
    workers.close()


@pytest.fixture
def bench(workers):
    bench = workers.runner()
    yield bench
    bench.close()


@pytest.fixture
def job(small_case) -> MergeJob:
    return MergeJob(small_case.ref, small_case.mov, small_case.observations, None)


def told(bench, job: MergeJob, **how) -> list[Step]:
    return list(bench.steps(job, RunCallbacks(), **how))


def end(steps: list[Step]) -> MergeResult:
    return steps[-1].detail


# --- parcels ----------------------------------------------------------------------------------------


@dataclass(frozen=True, eq=False)
class Thing:
    inside: tuple[Thing, ...] = ()
    worked_out: list[int] = field(default_factory=list)


def line() -> tuple[IncrementalPickle, IncrementalPickle]:
    return IncrementalPickle("one"), IncrementalPickle("other")


def sent(value, start: IncrementalPickle, goal: IncrementalPickle):
    return goal.unpack(start.pack(value))


@given(st.lists(st.one_of(st.integers(0, 4), st.just("turn over")), max_size=40), st.data())
def test_what_came_from_the_other_end_goes_back_as_itself(deeds, data):
    here, there = line()
    things = [Thing() for _ in range(4)]
    things.append(Thing(tuple(things[:2])))
    for deed in deeds:
        if deed == "turn over":
            here.turn_over()
            there.turn_over()
            continue
        arrived = sent(things[deed], here, there)
        assert arrived is not things[deed]
        assert sent([arrived, *arrived.inside], there, here) == [things[deed], *things[deed].inside]
        assert sent(things[deed], here, there) is arrived


def test_what_was_not_met_for_two_turns_is_held_by_nobody():
    here, there = line()
    thing = Thing()
    first = sent(thing, here, there)
    for _ in range(2):
        assert sent(thing, here, there) is first  # met again and again it stays
        here.turn_over()
        there.turn_over()
    here.turn_over()
    there.turn_over()
    assert not here._numbers
    assert not there._things
    assert sent(thing, here, there) is not first


def test_a_map_travels_once(small_case):
    here, there = line()
    first = len(here.pack(small_case.ref))
    assert first > small_case.ref.cells.nbytes
    assert len(here.pack([small_case.ref] * 10)) < 1000
    assert there is not here


def test_what_was_made_of_a_map_stays_where_it_was_made(small_case):
    here, there = line()
    copy = replace(small_case.ref)
    assert copy.occupied.any()
    arrived = sent(copy, here, there)
    assert "occupied" in vars(copy)
    assert "occupied" not in vars(arrived)
    np.testing.assert_array_equal(arrived.cells, copy.cells)


# --- a run ------------------------------------------------------------------------------------------


@pytest.mark.parametrize("method", ["spectra-proven", "mse", "orb"])
def test_a_run_in_a_process_of_its_own_is_that_run(bench, job, method):
    job = replace(job, method=method)
    here, there = list(job.run({})), told(bench, job)
    assert [step.stage for step in there] == [step.stage for step in here]
    assert [type(step.detail) for step in there] == [type(step.detail) for step in here]
    assert end(there).T_ref_mov == end(here).T_ref_mov
    assert end(there).verdict == end(here).verdict
    np.testing.assert_array_equal(end(there).fusion.merged.cells, end(here).fusion.merged.cells)


def test_what_is_known_is_told_again_and_is_the_same_thing(bench, job):
    first, again = told(bench, job), told(bench, job)
    assert not any(step.reused for step in first)
    assert all(step.reused for step in again if step.stage != "verdict")
    assert end(again).fusion is end(first).fusion
    moved = replace(
        METHODS[job.method].defaults, augment=replace(METHODS[job.method].defaults.augment, spread=2)
    )
    third = told(bench, replace(job, config=moved))
    assert [step.stage for step in third if step.reused] == ["observe"]
    assert third[0].detail is first[0].detail


def test_a_run_aside_leaves_the_next_one_what_it_knew(bench, job):
    told(bench, job)
    bare = (
        replace(job, config=replace(METHODS[job.method].defaults, seed=3)) if False else replace(job, seed=3)
    )
    aside = told(bench, bare, aside=True)
    assert not all(step.reused for step in aside)
    assert all(step.reused for step in told(bench, job) if step.stage != "verdict")


def test_a_refinement_by_hand_runs_there_too(bench, job):
    at = end(told(bench, job)).T_ref_mov
    scales = ManualMerge(PairProblem(job.ref, job.mov, job.known), METHODS[job.method].defaults)
    steps = told(bench, replace(job, steps=partial(refine, scales, at, 0)))
    assert end(steps).T_ref_mov == end(list(refine(scales, at, 0))).T_ref_mov


def test_a_run_that_is_left_half_way_hinders_no_other(bench, job):
    steps = bench.steps(job, RunCallbacks())
    assert isinstance(next(steps).detail, ObservationDetail)
    between = told(bench, replace(job, method="smm-window"))
    steps.close()
    assert end(between).method == "smm-window"
    assert end(told(bench, job)).method == job.method


def test_two_tabs_at_one_worker_go_on_side_by_side(workers, bench, job):
    other = workers.runner()
    one, two = bench.steps(job, RunCallbacks()), other.steps(job, RunCallbacks())
    both = [step for pair in zip(one, two, strict=True) for step in pair]
    assert end(both[::2]).T_ref_mov == end(both[1::2]).T_ref_mov
    assert len(workers.pids) == 1
    other.close()
    with pytest.raises(WorkerDiedError):
        told(other, job)


def test_what_a_tab_had_is_let_go_of_when_it_goes(workers, bench, job):
    other = workers.runner()
    told(other, replace(job, ref=replace(job.ref), mov=replace(job.mov)))
    (held,) = told(bench, replace(job, steps=maps_held))
    other.close()
    (left,) = told(bench, replace(job, steps=maps_held))
    assert left.seconds <= held.seconds - 2


def maps_held() -> Iterator[Step]:
    """How many maps the process holds."""
    maps = sum(type(thing) is GridMap for thing in gc.get_objects())
    yield Step("observe", ObservationDetail(()), float(maps))


# --- what goes wrong ----------------------------------------------------------------------------------


def test_a_process_that_is_killed_is_told_of_and_the_next_run_has_another(workers, bench, job, caplog):
    before = end(told(bench, job))
    neighbour = workers.runner()
    steps, beside = bench.steps(job, RunCallbacks()), neighbour.steps(job, RunCallbacks())
    next(steps), next(beside)
    (pid,) = workers.pids
    os.kill(pid, signal.SIGKILL)
    with pytest.raises(WorkerDiedError, match="Press Merge again"):
        list(steps)
    with pytest.raises(WorkerDiedError):  # it was the neighbour's, too
        list(beside)
    assert "a process that merges has ended" in caplog.text
    for tab in (bench, neighbour):
        again = end(told(tab, job))
        assert again.T_ref_mov == before.T_ref_mov
    assert workers.pids != [pid]
    neighbour.close()


def test_one_that_died_with_nothing_to_do_is_missed_by_nobody(workers, bench, job, caplog):
    told(bench, job)
    (pid,) = workers.pids
    os.kill(pid, signal.SIGKILL)
    until(lambda: not alive(workers), "its end")
    assert end(told(bench, job)).method == job.method
    assert "a process that merges has ended" in caplog.text


def alive(workers: WorkerPool) -> bool:
    return any(worker._process.is_alive() for worker in workers._workers)


def test_one_that_is_killed_in_the_middle_of_a_step_is_told_of_at_once(workers, bench, job):
    told(bench, job)
    (pid,) = workers.pids
    failed: list[BaseException] = []

    def run() -> None:
        try:
            told(bench, replace(job, steps=stuck))
        except WorkerDiedError as error:
            failed.append(error)

    thread = Thread(target=run)
    thread.start()
    until(lambda: not next(iter(workers._workers)).turns._free, "the step to begin")
    os.kill(pid, signal.SIGKILL)
    thread.join(20)
    assert failed


def test_one_that_hangs_is_ended_once_nobody_wants_what_it_is_at(workers, bench, job, monkeypatch):
    monkeypatch.setattr("app.jobs.worker_pool.HANGS", 0.0)
    wanted = Event()
    wanted.set()
    steps = bench.steps(job, RunCallbacks(wanted.is_set))
    next(steps)
    (pid,) = workers.pids
    os.kill(pid, signal.SIGSTOP)
    Timer(0.5, wanted.clear).start()
    with pytest.raises(WorkerDiedError):
        list(steps)
    assert not wanted.is_set()
    assert end(told(bench, job)).method == job.method
    assert workers.pids != [pid]


def test_one_that_hears_nothing_any_more_is_ended_too(workers, bench, job, monkeypatch):
    told(bench, job)
    (pid,) = workers.pids
    os.kill(pid, signal.SIGSTOP)
    with monkeypatch.context() as patch:
        patch.setattr("app.jobs.worker_pool.HANGS_BESIDE", 0.5)
        with pytest.raises(WorkerDiedError):
            told(bench, job)
    assert end(told(bench, job)).method == job.method


def stuck() -> Iterator[Step]:
    signal.pause()
    yield Step("never", ObservationDetail(()), 0.0)


@dataclass(frozen=True)
class Broken:
    """Breaks what it is used in."""

    error: Exception

    def __call__(self) -> Iterator[Step]:
        yield Step("observe", ObservationDetail(()), 0.0)
        raise self.error


class OddError(Exception):
    """Cannot travel."""

    def __init__(self, one: int, two: int) -> None:
        super().__init__(f"{one} {two}")


@pytest.mark.parametrize("error", [MemoryError(), KeyError("a"), NoAnswerError("it lacks walls")])
def test_what_a_run_raises_is_raised_here_and_the_next_one_works(workers, bench, job, error):
    (pid,) = workers.pids or [None]
    with pytest.raises(type(error)) as raised:
        told(bench, replace(job, steps=Broken(error)))
    assert str(raised.value) == str(error)
    assert "in __call__" in str(raised.value.__cause__)  # where it was, for the log
    assert end(told(bench, job)).method == job.method
    assert pid in (None, *workers.pids)


@pytest.mark.skipif(sys.platform != "linux", reason="other systems do not bound a process's memory so")
def test_a_run_that_wants_nearly_all_memory_fails_before_the_system_ends_anyone(workers, bench, job):
    told(bench, job)
    (pid,) = workers.pids
    with pytest.raises(MemoryError):
        told(bench, replace(job, steps=greedy))
    assert end(told(bench, job)).method == job.method
    assert workers.pids == [pid]


def test_a_container_has_as_much_memory_as_it_may_have(tmp_path):
    files = [tmp_path / "max", tmp_path / "none", tmp_path / "bounded"]
    files[0].write_text("max\n")
    machine = whole(files[:2])
    assert machine > 2**28
    files[2].write_text("123456789\n")
    assert whole(files) == 123456789
    files[2].write_text(f"{2 * machine}\n")
    assert whole(files) == machine


def greedy() -> Iterator[Step]:
    held = np.empty(int(0.8 * whole()), dtype=np.uint8)  # asked for, never touched
    yield Step("observe", ObservationDetail(()), float(held.size))


def test_an_error_that_cannot_travel_is_told_by_its_name(bench, job):
    with pytest.raises(RuntimeError, match="OddError: 1 2"):
        told(bench, replace(job, steps=odd))


def odd() -> Iterator[Step]:
    yield Step("observe", ObservationDetail(()), 0.0)
    raise OddError(1, 2)


def test_what_cannot_travel_at_all_is_an_error_and_no_more(bench, job):
    with pytest.raises(Exception, match=r"pickle|local object"):
        told(bench, replace(job, steps=lambda: iter(())))
    assert end(told(bench, job)).method == job.method
    with pytest.raises(Exception, match=r"pickle|local object"):
        told(bench, replace(job, steps=unpackable))
    assert end(told(bench, job)).method == job.method


def unpackable() -> Iterator[Step]:
    yield Step("observe", ObservationDetail((lambda: None,)), 0.0)  # type: ignore[arg-type]


def test_a_sighting_far_off_its_map_is_refused_as_it_is_here(bench, job):
    nowhere = GridMap(np.full((4, 4), FREE, dtype=np.int8), 0.1, Pose2(500.0, 0.0))
    with pytest.raises(SettingError):
        told(bench, replace(job, ref=nowhere))


def test_closed_workers_die_in_silence(job, caplog):
    workers = WorkerPool(most=1)
    bench = workers.runner()
    steps = bench.steps(job, RunCallbacks())
    next(steps)
    workers.close()
    with pytest.raises(WorkerDiedError):
        list(steps)
    with pytest.raises(WorkerDiedError):
        told(bench, job)
    assert not caplog.records


HALF_STARTED = """
import threading, time
from multiprocessing import resource_tracker, util
from app.jobs import worker_pool as workers

resource_tracker.ensure_running()
spawn, half = util.spawnv_passfds, threading.Event()

def slowly(*what):
    pid = spawn(*what)
    half.set()
    time.sleep(0.5)
    return pid

util.spawnv_passfds = slowly
threading.Thread(target=workers.COMMON.assign(object()).start, daemon=True).start()
half.wait()
"""


@pytest.mark.skipif(sys.platform == "win32", reason="processes are started in another way there")
def test_a_server_that_ends_while_a_process_is_being_started_leaves_no_trace_of_it_on_stderr():
    ended = subprocess.run(
        [sys.executable, "-c", HALF_STARTED],
        capture_output=True,
        text=True,
        timeout=60,
        cwd=ROOT,
    )
    assert (ended.returncode, ended.stdout, ended.stderr) == (0, "", "")
