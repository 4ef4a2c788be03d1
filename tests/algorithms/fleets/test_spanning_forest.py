"""Trees that grow link by link, held against a graph library's."""

from __future__ import annotations

from itertools import pairwise

import networkx as nx
from hypothesis import given
from hypothesis import strategies as st

from algorithms.fleets.spanning_forest import SpanningForest

NAMES = [f"r{k}" for k in range(9)]


@given(st.lists(st.tuples(st.sampled_from(NAMES), st.sampled_from(NAMES)), max_size=40))
def test_the_way_between_two_robots_is_the_only_one_there_is(pairs):
    forest: SpanningForest[int] = SpanningForest(NAMES)
    graph = nx.Graph()
    graph.add_nodes_from(NAMES)
    for number, (a, b) in enumerate(pairs):
        assert (forest.root(a) == forest.root(b)) == nx.has_path(graph, a, b)
        if not nx.has_path(graph, a, b):
            forest.link(a, b, number)
            graph.add_edge(a, b, number=number)
    for a in NAMES:
        for b in nx.node_connected_component(graph, a):
            path = nx.shortest_path(graph, a, b)
            links = [graph.edges[step]["number"] for step in pairwise(path)]
            assert forest.way(a, b) == list(zip(path[:-1], links, strict=True))
