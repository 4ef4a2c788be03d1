"""The pairs of a fleet on a Dask cluster: the same answers as here, also where a worker dies."""

from __future__ import annotations

import os
import signal
from dataclasses import replace

import numpy as np
import pytest

from algorithms.common.pose import Pose2, pose_error
from algorithms.files.case_folder import Case
from algorithms.fleets.fleet_merge import FleetResult, PairStep, run_fleet
from algorithms.fleets.pair_hypotheses import find_pair, pair_orders
from algorithms.observations.fleet import MOST_ROBOTS, Fleet, FleetSighting
from app.jobs.dask_executor import DaskExecutor
from app.jobs.executor import LostTask, SerialExecutor, Task
from app.jobs.fleet_pairs import run_pairs

LEADER = "r1"


def frame(number: int) -> Pose2:
    """Of a robot's map in the frame of the case's second map."""
    return Pose2(3.0 * number, -2.0 * number, 0.1 * number)


@pytest.fixture(scope="module")
def crowd(small_case: Case) -> Fleet:
    """As many robots as can be: the first saw all others, whose maps are one in frames of their own."""
    (o,) = small_case.observations
    maps, sightings = {LEADER: small_case.ref}, []
    for number in range(2, MOST_ROBOTS + 1):
        T = frame(number)
        x, y = T.inverse().apply(np.array([o.observed_x, o.observed_y])).tolist()
        seen = replace(o, observed_x=x, observed_y=y, observed_heading=None, bearing_back=None)
        maps[f"r{number}"] = replace(small_case.mov, origin=T.inverse() @ small_case.mov.origin)
        sightings.append(FleetSighting(LEADER, f"r{number}", seen))
    return Fleet(maps, tuple(sightings))


def process_id(shared: object, order: object) -> int:
    return os.getpid()


def test_fifty_robots_are_merged_on_a_cluster_though_a_worker_is_killed_in_it(crowd, small_case):
    from distributed import LocalCluster

    T, result = small_case.truth.T_ref_mov, None
    with LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None, host="127.0.0.1") as cluster:
        executor = DaskExecutor(cluster.scheduler.address)
        for step in run_fleet(crowd, lambda fleet, orders: run_pairs(executor, fleet, orders)):
            if isinstance(step, PairStep) and step.done == 10:
                ((_, victim),) = executor.run(process_id, [Task(0)])
                os.kill(victim, signal.SIGKILL)
            if isinstance(step, PairStep) and step.done in (1, 49):
                here = find_pair(crowd, step.finding.order)
                assert [each.T_ref_mov for each in here.hypotheses] == [
                    each.T_ref_mov for each in step.finding.hypotheses
                ]
            result = step
    assert isinstance(result, FleetResult)
    assert result.whole
    for number in range(2, MOST_ROBOTS + 1):
        place = frame(number).inverse().apply(small_case.truth.T_ref_mov.inverse().apply(np.zeros(2)))
        distance, angle = pose_error(result.placed[f"r{number}"], T @ frame(number), place)
        assert distance < 0.2
        assert angle < 0.02


def test_a_pair_whose_worker_dies_each_time_has_no_answer_and_costs_no_other(crowd):
    class Losing(SerialExecutor):
        """Loses the first task."""

        far = True

        def run(self, work, tasks, stop=None):
            for number, answer in super().run(work, tasks, stop):
                yield number, LostTask() if number == 0 else answer

    few = Fleet({name: crowd.maps[name] for name in (LEADER, "r2", "r3")}, crowd.sightings[:2])
    lost, found = run_pairs(Losing(), few, pair_orders(few))
    assert lost.hypotheses == ()
    assert "too little memory" in lost.reason
    assert found.accepted
