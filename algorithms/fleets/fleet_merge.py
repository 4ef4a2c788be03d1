"""A fleet becomes one map: its pairs are merged, the answers that are true together are chosen, all poses are
solved, every robot is held against the map of the others, and who is alone is looked for without a sighting.
"""

from __future__ import annotations

from collections.abc import Callable, Generator, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from math import exp

import networkx as nx
import numpy as np

from algorithms.common.pose import Pose2
from algorithms.fleets.consistent_set import AnswerGraph, ConsistentSet
from algorithms.fleets.island import Island, island_of
from algorithms.fleets.pair_hypotheses import PairFinding, PairOrder, find_pair, pair_orders
from algorithms.observations.fleet import Fleet
from algorithms.observations.observation import encounter

RunPairs = Callable[[Fleet, Sequence[PairOrder]], Iterator[PairFinding]]
"""Merges pairs, in any order, wherever there are workers."""


@dataclass(frozen=True)
class LeftOut:
    """A sighting that nothing rests on.

    number   : in the fleet's list, from 0
    distance : metres between where it saw the robot and where the rest puts that; None where nothing does
    reason   : why
    """

    number: int
    distance: float | None
    reason: str


@dataclass(frozen=True, eq=False)
class FleetResult:
    """What became of a fleet.

    islands  : the anchor's first, then by size; a robot that nothing ties to another is one alone
    findings : of every pair that was merged
    chosen   : number of a finding -> number of its answer that the poses rest on
    likely   : number of a finding -> that this answer is right, by itself and the loops that it closes
    left_out : sightings that nothing rests on
    refused  : robots that were taken out again, since the others' maps deny their walls: why
    """

    islands: tuple[Island, ...]
    findings: tuple[PairFinding, ...]
    chosen: Mapping[int, int]
    likely: Mapping[int, float]
    left_out: tuple[LeftOut, ...]
    refused: Mapping[str, str]

    @property
    def placed(self) -> Mapping[str, Pose2]:
        """T_anchor_robot of every robot of the anchor's map."""
        return self.islands[0].poses

    @property
    def whole(self) -> bool:
        """Whether every robot is in the anchor's map, and none by force."""
        return len(self.islands) == 1 and not self.forced

    @property
    def forced(self) -> frozenset[str]:
        """Robots of pairs whose answer is not likely enough, and which was taken all the same."""
        found = ((self.findings[number], likely) for number, likely in self.likely.items())
        return frozenset(finding.order.mov for finding, likely in found if likely < finding.accept_from)


@dataclass(frozen=True, eq=False)
class PairStep:
    """A pair has been merged: how many of how many there are, and what came of it."""

    done: int
    total: int
    finding: PairFinding


FleetStep = PairStep | FleetResult


def in_turn(fleet: Fleet, orders: Sequence[PairOrder]) -> Iterator[PairFinding]:
    """Merge pairs here, one after the other."""
    return map(partial(find_pair, fleet), orders)


def run_fleet(
    fleet: Fleet, run_pairs: RunPairs = in_turn, force: bool = False, further: Sequence[PairFinding] = ()
) -> Iterator[FleetStep]:
    """Yield a step for every pair that was merged; the last step is the FleetResult.

    further : what was found of pairs of which nothing is known
    force  : take the likeliest answers however unlikely they are, and take no robot out again
    raises : TooLargeError where a merged map would be over the bound
    """
    findings = yield from _merged(fleet, pair_orders(fleet), run_pairs, further)
    result = joined(fleet, findings, force)
    lonely = _unseen(result)
    if lonely:
        orders = [PairOrder(island.root, name, ()) for name in lonely for island in result.islands[:1]]
        charted = Fleet({**fleet.maps, fleet.anchor: result.islands[0].fusion.merged}, anchor=fleet.anchor)
        findings = yield from _merged(charted, orders, run_pairs, findings)
        result = joined(fleet, findings, force)
    yield result


def merge_fleet(fleet: Fleet) -> FleetResult:
    """The end of ``run_fleet``."""
    *_, last = run_fleet(fleet)
    assert isinstance(last, FleetResult)
    return last


def _unseen(result: FleetResult) -> list[str]:
    """Robots that are alone and that no sighting brings near anybody of the anchor's map.

    Where a sighting has left several answers open, a search without it would weigh the same walls again, and
    what it finds must not count as if it were something new.
    """
    alone = {island.root for island in result.islands[1:] if len(island.poses) == 1}
    for finding in result.findings:
        pair = {finding.order.ref, finding.order.mov}
        if finding.hypotheses and pair & set(result.placed):
            alone -= pair
    return sorted(alone)


def _merged(
    fleet: Fleet, orders: Sequence[PairOrder], run_pairs: RunPairs, before: Sequence[PairFinding]
) -> Generator[PairStep, None, list[PairFinding]]:
    """Yield a step for every order; returns what was found before, and what of these, in their order."""
    found: dict[PairOrder, PairFinding] = {}
    for finding in run_pairs(fleet, orders):
        found[finding.order] = finding
        yield PairStep(len(before) + len(found), len(before) + len(orders), finding)
    return [*before, *(found[order] for order in orders)]


def joined(fleet: Fleet, findings: Sequence[PairFinding], force: bool = False) -> FleetResult:
    """The answers of all pairs, put together; robots whose walls the rest denies are taken out again.

    force : as of ``run_fleet``
    """
    if force:
        return _put_together(fleet, findings, findings, {}, force)
    refused: dict[str, str] = {}
    while True:
        use = [f for f in findings if not {f.order.ref, f.order.mov} & set(refused)]
        result = _put_together(fleet, findings, use, refused)
        denied = {
            name: walls
            for island in result.islands
            for name, walls in island.denied().items()
            if name != island.root
        }
        if not denied:
            return result
        worst = max(denied, key=lambda name: (denied[name][1] - denied[name][0], name))
        agree, deny = denied[worst]
        refused[worst] = f"the others' maps deny {deny:.0f} m of its walls and confirm {agree:.0f} m"


def poses_so_far(fleet: Fleet, findings: Sequence[PairFinding]) -> dict[str, Pose2]:
    """T_anchor_robot of each robot that accepted answers tie to the anchor, before all pairs are known."""
    links = nx.Graph()
    links.add_node(fleet.anchor)
    for finding in findings:
        if finding.accepted and finding.hypotheses:
            T = finding.hypotheses[0].T_ref_mov
            links.add_edge(
                finding.order.ref, finding.order.mov, T={finding.order.ref: T, finding.order.mov: T.inverse()}
            )
    poses = {fleet.anchor: Pose2()}
    for near, far in nx.bfs_edges(links, fleet.anchor):
        poses[far] = poses[near] @ links.edges[near, far]["T"][near]
    return poses


def _put_together(
    fleet: Fleet,
    findings: Sequence[PairFinding],
    use: Sequence[PairFinding],
    refused: Mapping[str, str],
    force: bool = False,
) -> FleetResult:
    graph = AnswerGraph(list(fleet.maps), use, _area(fleet))
    best = graph.best()
    likely = {number: probability_of(graph, best, number) for number in best.chosen}
    sure = {
        number: k for number, k in best.chosen.items() if force or likely[number] >= use[number].accept_from
    }
    parts = nx.connected_components(graph.ties(sure))
    islands = []
    for part in sorted(parts, key=lambda part: (fleet.anchor not in part, -len(part), min(part))):
        root = fleet.anchor if fleet.anchor in part else min(part)
        mine = {number: k for number, k in sure.items() if use[number].order.ref in part}
        islands.append(island_of(fleet.maps, graph, mine, likely, [root, *sorted(part - {root})]))
    index = {id(finding): number for number, finding in enumerate(findings)}
    at = {number: index[id(use[number])] for number in sure}
    left = _left_out(fleet, findings, {at[number] for number in sure}, islands)
    chosen = {at[number]: k for number, k in sure.items()}
    sureness = {at[number]: likely[number] for number in sure}
    return FleetResult(tuple(islands), tuple(findings), chosen, sureness, left, dict(refused))


def _area(fleet: Fleet) -> float:
    """Over which a wrong answer may be scattered: that of a map as wide as the two largest together; m²."""
    sizes = sorted(max(grid.width, grid.height) * grid.resolution for grid in fleet.maps.values())
    return (sizes[-1] + sizes[-2]) ** 2


def probability_of(graph: AnswerGraph, best: ConsistentSet, number: int) -> float:
    """That a chosen answer is right: the set with it against those with none of its finding, or another.

    Where other findings of the same two robots are chosen, too, it is at most as likely as the likeliest of
    them without the others: where walls look alike in one of them, they do so in all.
    """
    likely = _against_others(graph, best, number)
    same = graph.same_pair(number)
    together = [each for each in same if each in best.chosen]
    if len(together) == 1:
        return likely
    return min(likely, max(_by_itself(graph.without(same - {each}), best, each) for each in together))


def _by_itself(graph: AnswerGraph, best: ConsistentSet, number: int) -> float:
    """That a chosen answer is right where its finding is the only one of its two robots."""
    return _against_others(graph, graph.holding((number, best.chosen[number])), number)


def _against_others(graph: AnswerGraph, like: ConsistentSet, number: int) -> float:
    odds = (exp(min(700.0, other.score - like.score)) for other in graph.others(number, like))
    return 1.0 / (1.0 + sum(odds))


def _left_out(
    fleet: Fleet, findings: Sequence[PairFinding], chosen: set[int], islands: Sequence[Island]
) -> tuple[LeftOut, ...]:
    of_sighting = {number: k for k, finding in enumerate(findings) for number in finding.order.sightings}
    out = []
    for number, seen in enumerate(fleet.sightings):
        if of_sighting.get(number) in chosen:
            continue
        finding = findings[of_sighting[number]]
        distance, reason = None, finding.said
        for island in islands:
            if seen.observer in island.poses and seen.observed in island.poses:
                T = island.poses[seen.observer].inverse() @ island.poses[seen.observed]
                at = encounter(seen.observation)
                distance = float(np.linalg.norm(T.apply(at.x_mov) - at.x_ref))
                if not finding.failed:  # else it says what is wrong with the sighting
                    reason = (
                        f"{seen.observer}'s sighting of {seen.observed} would put it {distance:.1f} m off"
                    )
        out.append(LeftOut(number, distance, reason))
    return tuple(out)
