"""Which of the pairs' answers are true together: the likeliest set whose loops all come back to themselves.

Of each pair at most one answer is right, or none is. A set of them has the log-odds

    Σ (log-odds of an answer over none of its pair) + Σ over loops log (N(e; 0, Σ) 2π A),

e: how far a loop misses its beginning, Σ its covariance, A the area over which a wrong answer would be
scattered. An answer that closes a loop within the covariances gains much, since a wrong one seldom does; one
that does not cannot stand beside the others of its loop. This is the mixed discrete problem; pairwise
consistency (Mangelson et al., ICRA 2018) asks less, and takes loops of two answers alone, of which a fleet
with one sighting a pair has none. It is solved by building forests, the likeliest answer first, and again
with each answer that was left out put in first, as long as that makes the set likelier: the graph has few
more edges than robots, and what is left out are the few lies.

Findings of the same two robots weigh the same walls: they outvote a lie, each by a sighting of its own, but
none makes another likelier: see ``fleet_merge.probability_of``.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from copy import copy
from dataclasses import dataclass
from math import log, pi, radians

import networkx as nx
import numpy as np

from algorithms.common.pose import Pose2
from algorithms.fleets.pair_hypotheses import PairFinding
from algorithms.fleets.pose_graph import PoseEdge
from algorithms.fleets.spanning_forest import SpanningForest
from algorithms.fleets.transform_chain import EXACT, UncertainTransform

SLACK = 0.1, radians(1.0)  # metres, radians; how far maps of one building are bent between two meetings
FARTHEST_OFF = 16.27  # squared deviations, 3 degrees of freedom: one true loop in a thousand misses by more
LEAST_WEIGHT = -4.6  # log-odds, one in a hundred; what is less likely is not asked whether a loop supports it
MOST_ROUNDS = 8

Answer = tuple[int, int]
"""Number of a finding, and of one of its answers."""

Chosen = dict[int, int]
"""Number of a finding -> number of its answer that is taken."""


@dataclass(frozen=True, eq=False)
class ConsistentSet:
    """The likeliest set.

    chosen : of which finding which answer
    score  : log-odds of the set over the empty one
    """

    chosen: Chosen
    score: float


class AnswerGraph:
    """All answers of all pairs.

    names    : of the robots
    findings : of the pairs
    area     : over which a wrong answer would be scattered; m²
    """

    def __init__(self, names: Sequence[str], findings: Sequence[PairFinding], area: float) -> None:
        self._names, self._findings = tuple(names), tuple(findings)
        self._scattered = log(2 * pi * area)
        self._loops: dict[tuple[Answer, tuple[Answer, ...]], float] = {}
        self._edges = {
            (number, k): UncertainTransform(answer.T_ref_mov, answer.covariance).loosened(
                finding.pivot, *SLACK
            )
            for number, finding in enumerate(findings)
            for k, answer in enumerate(finding.hypotheses)
        }

    def best(self) -> ConsistentSet:
        """The likeliest set."""
        order = sorted(self._edges, key=lambda key: (-self._weight(key), self._called(key)))
        best = self._built(order)
        for _ in range(MOST_ROUNDS):
            left = [key for key in order if best.chosen.get(key[0]) != key[1]]
            tried = [self._built([key, *order], forced=key) for key in left]
            better = max(tried, key=lambda each: each.score, default=best)
            if better.score <= best.score + 1e-9:
                break
            best = better
        return best

    def same_pair(self, number: int) -> frozenset[int]:
        """The findings of the same two robots, whoever of them saw the other; this one, too."""
        pair = self._pair(number)
        return frozenset(other for other, _ in self._edges if self._pair(other) == pair)

    def without(self, numbers: Collection[int]) -> AnswerGraph:
        """The same graph without the answers of some findings; numbers stay as they are."""
        rest = copy(self)
        rest._edges = {key: edge for key, edge in self._edges.items() if key[0] not in numbers}
        return rest

    def holding(self, key: Answer) -> ConsistentSet:
        """The likeliest set that begins with an answer."""
        order = sorted(self._edges, key=lambda key: (-self._weight(key), self._called(key)))
        return self._built([key, *order], forced=key, keep=True)

    def others(self, number: int, like: ConsistentSet) -> list[ConsistentSet]:
        """The likeliest set without a finding, and those with each of its answers that ``like`` has not."""
        order = sorted(self._edges, key=lambda key: (-self._weight(key), self._called(key)))
        rest = [key for key in order if key[0] != number]
        mine = [key for key in order if key[0] == number and key[1] != like.chosen[number]]
        return [self._built(rest), *(self._built([key, *rest], forced=key, keep=True) for key in mine)]

    def ties(self, chosen: Mapping[int, int]) -> nx.MultiGraph:
        """The robots, and between them the chosen answers; an edge's key is its finding's number."""
        graph = nx.MultiGraph()
        graph.add_nodes_from(self._names)
        for number in chosen:
            order = self._findings[number].order
            graph.add_edge(order.ref, order.mov, key=number)
        return graph

    def edge(self, number: int, k: int) -> PoseEdge:
        """An answer of a finding, for the pose graph."""
        order, held = self._findings[number].order, self._edges[number, k]
        return PoseEdge(order.ref, order.mov, held.T, held.covariance)

    def along(self, chosen: Mapping[int, int], root: str, names: Sequence[str]) -> dict[str, Pose2]:
        """T_root_robot of each, along the fewest answers."""
        ties = self.ties(chosen)
        tree: SpanningForest[Answer] = SpanningForest(self._names)
        for near, far in nx.bfs_edges(ties, root):
            number = min(ties[near][far])
            tree.link(near, far, (number, chosen[number]))
        return {name: self._chain(tree, root, name).T for name in names}

    def _pair(self, number: int) -> frozenset[str]:
        order = self._findings[number].order
        return frozenset((order.ref, order.mov))

    def _weight(self, key: Answer) -> float:
        return self._findings[key[0]].hypotheses[key[1]].weight

    def _called(self, key: Answer) -> tuple[float, ...]:
        """Breaks ties by what an answer is, so that the order of robots and sightings changes nothing."""
        answer = self._findings[key[0]].hypotheses[key[1]]
        return tuple(answer.T_ref_mov.array().tolist())

    def _built(
        self, order: Sequence[Answer], forced: Answer | None = None, keep: bool = False
    ) -> ConsistentSet:
        """A set, made by taking one answer after the other that makes it likelier.

        forced : is taken whatever it does
        keep   : and stays though it is unlikely by itself, and no loop supports it
        """
        tree: SpanningForest[Answer] = SpanningForest(self._names)
        chosen: Chosen = {}
        score = 0.0
        for key in order:
            number, _ = key
            if number in chosen:
                continue
            pair, gain = self._findings[number].order, self._weight(key)
            tied = tree.root(pair.ref) == tree.root(pair.mov)
            if tied:
                gain += self._loop(tree, key)
            if gain <= (0 if tied else LEAST_WEIGHT) and key != forced:
                continue
            chosen[number] = key[1]
            score += gain
            if not tied:
                tree.link(pair.ref, pair.mov, key)
        return self._pruned(ConsistentSet(chosen, score), forced if keep else None)

    def _pruned(self, found: ConsistentSet, kept: Answer | None) -> ConsistentSet:
        """Without the answers that are unlikely by themselves, and which no loop supports, but for one."""
        chosen, score = dict(found.chosen), found.score
        while any(self._weight(key) <= 0 for key in chosen.items()):
            links: dict[frozenset[str], list[int]] = {}
            for number in chosen:
                links.setdefault(self._pair(number), []).append(number)
            bridges = nx.bridges(nx.Graph(tuple(pair) for pair in links))
            alone = [links[frozenset(bridge)] for bridge in bridges]
            weak = [numbers[0] for numbers in alone if len(numbers) == 1]
            answers = [(number, chosen[number]) for number in weak]
            weak = [key[0] for key in answers if self._weight(key) <= 0 and key != kept]
            if not weak:
                break
            for number in weak:
                score -= self._weight((number, chosen.pop(number)))
        return ConsistentSet(chosen, score)

    def _loop(self, tree: SpanningForest[Answer], key: Answer) -> float:
        """What closing a loop adds to the log-odds; −∞ where it does not close."""
        pair = self._findings[key[0]].order
        way = tuple(link for _, link in tree.way(pair.ref, pair.mov))
        known = self._loops.get((key, way))
        if known is None:
            off, covariance = self._chain(tree, pair.ref, pair.mov).difference(self._edges[key])
            squared = float(off @ np.linalg.solve(covariance, off))
            known = -np.inf
            if squared <= FARTHEST_OFF:
                _, logdet = np.linalg.slogdet(covariance)
                known = float(self._scattered - 0.5 * (squared + logdet + 3 * log(2 * pi)))
            self._loops[key, way] = known
        return known

    def _chain(self, tree: SpanningForest[Answer], start: str, end: str) -> UncertainTransform:
        """T_start_end along a tree."""
        found = EXACT
        for at, key in tree.way(start, end):
            edge = self._edges[key]
            found = found.then(edge if self._findings[key[0]].order.ref == at else edge.inverse())
        return found
