"""How fast a fleet is merged: the whole of it against its pairs one by one, and the graph step alone.

`make bench`. What is pinned are ratios against a reference in the same run; seconds are printed beside them.
"""

from __future__ import annotations

import resource
from dataclasses import replace
from functools import partial
from statistics import mean
from time import perf_counter

import networkx as nx
import pytest

from algorithms.fleets.consistent_set import AnswerGraph
from algorithms.fleets.fleet_merge import FleetResult, probability_of, run_fleet
from algorithms.fleets.pair_hypotheses import find_pair, pair_orders
from algorithms.fleets.pose_graph import solve
from algorithms.observations.fleet import Fleet
from algorithms.simulator.fleets.fleet_scenario import simulate_fleet
from app.jobs.fleet_pairs import run_pairs
from app.jobs.process_executor import ProcessExecutor

SIZES = {3: 3, 12: 20, 50: 120}  # robots, and how many sightings
TRIED = 5  # pairs that are merged alone
JOBS = 2


def fleet_of(robots: int, sightings: int) -> Fleet:
    """An office's robots with the first of their sightings, one in five of them a lie; all are tied."""
    fleet = simulate_fleet("office", 2, robots).fleet
    return replace(fleet, sightings=fleet.sightings[:sightings])


@pytest.mark.parametrize("robots", SIZES)
def bench_fleet(robots, benchmark):
    fleet = fleet_of(robots, SIZES[robots])
    orders = pair_orders(fleet)
    find_pair(fleet, orders[0])  # compiles
    began = perf_counter()
    for order in orders[:TRIED]:
        find_pair(fleet, order)
    alone = (perf_counter() - began) / min(TRIED, len(orders)) * len(orders)
    executor = ProcessExecutor(JOBS)

    def merged() -> FleetResult:
        *_, last = run_fleet(fleet, partial(run_pairs, executor))
        assert isinstance(last, FleetResult)
        return last

    result = benchmark.pedantic(merged, rounds=1)
    ours = benchmark.stats.stats.median
    children = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss
    here = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    benchmark.extra_info.update(
        ratio=alone / ours,
        reference="its pairs one by one, by the mean of five",
        placed=f"{len(result.placed)} of {robots}",
        sightings=len(fleet.sightings),
        mb=(here + JOBS * children) / 1024,
    )
    assert alone / ours > 0.5  # two processes have to be started, and all maps are fused


def bench_graph_step(benchmark):
    """Fifty robots, 120 answers, of which 24 are wrong; against one merge of a pair."""
    fleet = fleet_of(50, 120)
    findings = [find_pair(fleet, order) for order in pair_orders(fleet)]

    def step() -> None:
        graph = AnswerGraph(list(fleet.maps), findings, 1e4)
        best = graph.best()
        likely = {number: probability_of(graph, best, number) for number in best.chosen}
        assert mean(likely.values()) > 0.9
        names = [name for name in fleet.maps if name in _tied(graph, best.chosen, fleet.anchor)]
        edges = [graph.edge(number, k) for number, k in best.chosen.items()]
        edges = [edge for edge in edges if edge.ref in names]
        solve(fleet.anchor, graph.along(best.chosen, fleet.anchor, names), edges)

    step()
    benchmark(step)
    began = perf_counter()
    find_pair(fleet, pair_orders(fleet)[0])
    ratio = (perf_counter() - began) / benchmark.stats.stats.median
    benchmark.extra_info.update(ratio=ratio, reference="one merge of a pair", answers=len(findings))
    assert ratio > 0.5  # it takes no longer than two merges of a pair


def _tied(graph: AnswerGraph, chosen: dict[int, int], anchor: str) -> set[str]:
    return set(nx.node_connected_component(graph.ties(chosen), anchor))
