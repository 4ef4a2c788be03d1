"""A Dask scheduler with two workers on this machine: the same answers as at home, also where one dies."""

import json
import os
import signal
import socket
import sys
from threading import Event, Thread, Timer

import pytest
from executor_tasks import die_at_two, fail, meet, process_id, stay, until
from sweep_plans import plan, untimed

from algorithms.common.errors import SettingError
from app.cli.executor_flags import executor_for
from app.cli.main import main
from app.evaluation.sweep.parameter_sweep import in_order, sweep
from app.jobs import dask_executor as cluster
from app.jobs.dask_executor import DaskExecutor
from app.jobs.executor import LostTask, SerialExecutor, Shared, Task


@pytest.fixture(scope="module")
def scheduler():
    """With two workers, processes of one thread each, and a nanny for either."""
    from distributed import LocalCluster

    with LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None, host="127.0.0.1") as started:
        yield started.scheduler


@pytest.fixture
def address(scheduler):
    return scheduler.address


def workers_in(folder):
    return {int(path.name.split("_")[1]) for path in folder.glob("*_*")}


def test_both_workers_do_tasks_and_every_task_is_answered_once(address, tmp_path):
    executor = executor_for(scheduler=address)
    assert executor.jobs == 2
    told = dict(executor.run(meet, [Task(order, Shared.of(tmp_path)) for order in range(6)]))
    assert {number: order for number, (order, _) in told.items()} == {order: order for order in range(6)}
    assert len({worker for _, worker in told.values()}) == 2


def test_a_worker_that_is_killed_in_the_middle_loses_nothing(address, tmp_path):
    def shoot():
        assert until(lambda: len(workers_in(tmp_path)) == 2)
        os.kill(min(workers_in(tmp_path)), signal.SIGKILL)
        (tmp_path / "go").touch()

    shooter = Thread(target=shoot)
    shooter.start()
    told = list(DaskExecutor(address).run(stay, [Task(order, Shared.of(tmp_path)) for order in range(5)]))
    shooter.join()
    assert sorted(told) == [(order, order) for order in range(5)]


def test_cases_judged_on_a_cluster_are_those_judged_here_bit_for_bit(
    address, case_maker, small_case, strangers, tmp_path, capsys
):
    case_maker(small_case, "flat_1")
    case_maker(strangers, "neg_1")
    broken = case_maker(small_case, "bad_1")
    (broken / "map2.pgm").write_bytes(b"P5 nonsense")
    told = []
    for words in (["--jobs", "1"], ["--scheduler", address]):
        out = tmp_path / "out.json"
        assert main(["evaluate", str(tmp_path / "cases"), "--json", str(out), *words]) == 1
        entries = json.loads(out.read_text())["cases"]
        for entry in entries:
            entry.pop("seconds")
            entry.get("report", {}).pop("timings_s", None)
        told.append(entries)
    assert told[0] == told[1]
    assert [entry["case"] for entry in told[0]] == ["bad_1", "flat_1", "neg_1"]


def test_a_sweep_on_a_cluster_is_that_of_this_machine_though_a_worker_is_killed_in_it(address, small_case):
    here = untimed(in_order(plan(), list(sweep(small_case, plan(), SerialExecutor()))))
    running = sweep(small_case, plan(), DaskExecutor(address))
    points = [next(running)]
    ((_, victim),) = DaskExecutor(address).run(process_id, [Task(0)])
    os.kill(victim, signal.SIGKILL)
    points += running
    assert untimed(in_order(plan(), points)) == here


def test_what_the_work_raises_is_raised_to_whoever_asked(address):
    with pytest.raises(SettingError, match="1 is none of ours"):
        list(DaskExecutor(address).run(fail, [Task(1)]))


def test_another_thread_can_stop_the_work(address, tmp_path):
    stop = Event()
    Timer(0.5, stop.set).start()
    assert list(DaskExecutor(address).run(stay, [Task(0, Shared.of(tmp_path))], stop)) == []
    (tmp_path / "go").touch()  # the worker, which can't be interrupted, is free again


def test_a_worker_with_other_code_is_named_and_refused(address, monkeypatch):
    monkeypatch.setattr(cluster, "code", lambda: "other")
    with pytest.raises(SettingError, match=r"worker at tcp://.* has mapmeld's code \w+, here it is other"):
        DaskExecutor(address)


def free_port():
    with socket.create_server(("127.0.0.1", 0)) as server:
        return server.getsockname()[1]


@pytest.mark.parametrize("where", ["tcp://127.0.0.1:{port}", "nonsense", "carrier-pigeon://home:1"])
def test_where_no_scheduler_answers_that_is_said_in_one_line(
    where, tmp_path, case_folder, monkeypatch, capsys
):
    monkeypatch.setattr(cluster, "PATIENCE_S", 0.3)
    address = where.format(port=free_port())
    assert main(["evaluate", str(case_folder), "--scheduler", address]) == 2
    said = capsys.readouterr().err
    assert f"--scheduler {address}: no Dask scheduler answers there" in said
    assert said.count("\n") == 1


def test_something_else_that_listens_is_not_waited_for_long(monkeypatch):
    monkeypatch.setattr(cluster, "PATIENCE_S", 0.3)
    with (
        socket.create_server(("127.0.0.1", 0)) as silent,
        pytest.raises(SettingError, match="no Dask scheduler answers there"),
    ):
        DaskExecutor(f"tcp://127.0.0.1:{silent.getsockname()[1]}")


def test_without_dask_the_remedy_is_named(monkeypatch):
    monkeypatch.setitem(sys.modules, "distributed", None)
    with pytest.raises(SettingError, match=r"pip install 'mapmeld\[dask\]'"):
        executor_for(scheduler="tcp://127.0.0.1:1")


def test_a_task_that_kills_its_workers_is_lost_and_the_next_one_is_not(scheduler, monkeypatch):
    # the last test: the worker is a while coming back
    monkeypatch.setattr(scheduler, "allowed_failures", 0)
    ((_, answer),) = DaskExecutor(scheduler.address).run(die_at_two, [Task(2)])
    assert isinstance(answer, LostTask)
    assert list(DaskExecutor(scheduler.address).run(die_at_two, [Task(3)])) == [(0, 3)]
