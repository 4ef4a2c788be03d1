"""Work done elsewhere: the same answers whoever does it, and none that is lost with a worker."""

import os
import pickle
import signal
import subprocess
import sys
import threading
from contextlib import closing

import pytest
from commandline import as_in_a_terminal
from executor_tasks import add, alive, fail, fragile, linger, pid, until, who
from repository import ROOT

from algorithms.common import parallel_kernels as kernels
from algorithms.common.errors import InputFileError, NoAnswerError, OutputError, SettingError
from app.cli.executor_flags import executor_for
from app.jobs.executor import LostTask, SerialExecutor, Shared, Task, unpacked
from app.jobs.process_executor import ProcessExecutor


@pytest.mark.parametrize("executor", [SerialExecutor(), ProcessExecutor(2)])
def test_every_task_is_answered_with_the_value_that_it_shares(executor):
    one, two = Shared.of(100), Shared.of(200)
    told = dict(executor.run(add, [Task(order, one if order < 3 else two) for order in range(6)]))
    assert told == {0: 100, 1: 101, 2: 102, 3: 203, 4: 204, 5: 205}


def test_a_shared_value_comes_back_as_it_was(small_case):
    value = unpacked(Shared.of(small_case).data)
    assert (value.ref.cells == small_case.ref.cells).all()
    assert value.observations == small_case.observations
    assert len(Shared.of(small_case).data) < small_case.ref.cells.size / 10


def test_a_process_that_dies_costs_a_second_try_and_one_that_always_dies_only_its_own_task(tmp_path):
    shared = Shared.of(tmp_path)
    told = dict(ProcessExecutor(2).run(fragile, [Task(order, shared) for order in range(8)]))
    assert {order: answer for order, answer in told.items() if order != 5} == {
        order: order * order for order in range(8) if order != 5
    }
    assert isinstance(told[5], LostTask)


@pytest.mark.parametrize("executor", [SerialExecutor(), ProcessExecutor(2)])
def test_what_the_work_raises_is_raised_to_whoever_asked(executor):
    with pytest.raises(SettingError, match="1 is none of ours"):
        list(executor.run(fail, [Task(1)]))


@pytest.mark.parametrize(
    "error",
    [
        InputFileError("map.yaml", "is torn", "mend it"),
        OutputError("out", "is full", "empty it"),
        NoAnswerError("no corner was found"),
        SettingError("too much"),
    ],
)
def test_an_error_is_the_same_after_it_has_come_from_another_process(error):
    copy = pickle.loads(pickle.dumps(error))
    assert type(copy) is type(error)
    assert str(copy) == str(error)
    assert vars(copy) == vars(error)


def test_tasks_are_taken_only_as_workers_become_free():
    taken = []

    def tasks():
        for order in range(100):
            taken.append(order)
            yield Task(order, Shared.of(order))

    with closing(SerialExecutor().run(add, tasks())) as answers:
        assert next(answers) == (0, 0)
        assert taken == [0]


def test_processes_share_the_cores_among_them(monkeypatch):
    ((_, (number, *threads)),) = ProcessExecutor(max(2, kernels.cores())).run(who, [Task(0)])
    assert number != os.getpid()
    assert threads == [1, 1]


@pytest.mark.parametrize("end", [signal.SIGINT, signal.SIGKILL])
def test_no_process_outlives_the_one_that_asked(end, tmp_path):
    script = (
        "import sys, pathlib; from app.jobs.executor import *\n"
        "from app.jobs.process_executor import ProcessExecutor\n"
        "sys.path.insert(0, 'tests/support'); import executor_tasks\n"
        "shared = Shared.of(pathlib.Path(sys.argv[1]))\n"
        "list(ProcessExecutor(1).run(executor_tasks.linger, [Task(0, shared)]))"
    )
    command = [sys.executable, "-c", script, str(tmp_path)]
    apart = {"start_new_session": True, "preexec_fn": as_in_a_terminal}
    with subprocess.Popen(command, cwd=ROOT, stderr=subprocess.PIPE, **apart) as first:
        assert until(lambda: list(tmp_path.glob("began_*")))
        (began,) = tmp_path.glob("began_*")
        assert alive(pid(began))
        first.send_signal(end)
        assert first.wait(timeout=30) != 0
    assert until(lambda: not alive(pid(began)))


def test_who_leaves_the_loop_stops_the_work_at_once(tmp_path):
    answers = ProcessExecutor(2).run(
        linger, [Task("quick", Shared.of(tmp_path)), Task(0, Shared.of(tmp_path))]
    )
    assert next(answers) == (0, None)
    answers.close()
    assert until(lambda: not any(alive(pid(path)) for path in tmp_path.glob("began_*")))


@pytest.mark.parametrize("executor", [SerialExecutor(), ProcessExecutor(1)])
def test_another_thread_can_stop_the_work(executor, tmp_path):
    stop = threading.Event()
    shared = Shared.of(tmp_path)
    answers = executor.run(linger, [Task("quick", shared), Task(0, shared)], stop)
    assert next(answers) == (0, None)
    if isinstance(executor, SerialExecutor):
        stop.set()
    else:
        threading.Timer(0.3, stop.set).start()
    assert list(answers) == []
    if isinstance(executor, ProcessExecutor):
        assert until(lambda: not any(alive(pid(path)) for path in tmp_path.glob("began_*")))


def test_one_job_is_done_here_and_more_in_processes():
    assert isinstance(executor_for(1), SerialExecutor)
    assert executor_for(3).jobs == 3
    assert executor_for().jobs == kernels.cores()
