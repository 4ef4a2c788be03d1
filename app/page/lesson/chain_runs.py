"""The three pairs of a sample fleet that a step of the lesson merges: a chain, and what closes it."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

from algorithms.files.fleet_file import read_fleet
from algorithms.fleets.fleet_merge import FleetResult, joined
from algorithms.fleets.pair_hypotheses import PairFinding, PairOrder, finding_of, known_of, pair_orders
from algorithms.methods.registry import METHODS, default_method
from algorithms.observations.fleet import Fleet
from algorithms.observations.pair_problem import PairProblem
from app.model.merge_job import MergeJob
from app.page.lesson.side_runs import SideRun, SideRuns
from app.system import data_paths as paths

SAMPLE = "corridor_fleet_loop"
OPEN = "r1", "r2"  # the pair whose own sighting leaves two answers open
BETWEEN = "r3"  # the robot by which the way round goes


@cache
def sample_fleet() -> Fleet:
    """Three robots in a corridor that looks alike turned by 180°."""
    return read_fleet(paths.fleets()[SAMPLE])


def chain_runs(seed: int = 0) -> SideRuns:
    """A merge per pair; the open one is the last."""
    return SideRuns(*(SideRun(_title(order), _job(order, seed)) for order in _orders()))


def _orders() -> list[PairOrder]:
    return sorted(pair_orders(sample_fleet()), key=lambda order: {order.ref, order.mov} == set(OPEN))


def _title(order: PairOrder) -> str:
    return f"{order.ref} saw {order.mov}"


def _problem(order: PairOrder) -> PairProblem:
    fleet = sample_fleet()
    return PairProblem.of(fleet.maps[order.ref], fleet.maps[order.mov], known_of(fleet, order))


def _job(order: PairOrder, seed: int) -> MergeJob:
    problem = _problem(order)
    method = default_method(problem)
    known = (*problem.observations, *problem.priors)
    return MergeJob(problem.ref, problem.mov, known, METHODS[method].defaults, method, seed)


@dataclass(frozen=True, eq=False)
class Chain:
    """What came of the three pairs; the open one is the last.

    result : of all of them together
    """

    findings: tuple[PairFinding, ...]
    result: FleetResult


def chain_of(runs: SideRuns) -> Chain | None:
    """What came of the pairs; None while one is not over."""
    found = [
        finding_of(order, _problem(order), one.job.config, one.result)
        for order, one in zip(_orders(), runs.each, strict=True)
        if one.result is not None
    ]
    if len(found) < len(runs.each):
        return None
    return Chain(tuple(found), joined(sample_fleet(), found))
