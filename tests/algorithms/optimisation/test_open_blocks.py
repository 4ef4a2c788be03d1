"""The blocks that a proof has not opened: the best go first, none is lost, and ties have an order."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from algorithms.optimisation.open_blocks import OpenBlocks

few_values = st.sampled_from([-2.0, 0.0, 1.0, 1.5, 7.0])  # many of them equal


@st.composite
def open_blocks(draw: st.DrawFn) -> OpenBlocks:
    bounds = np.array(draw(st.lists(few_values, max_size=12)))
    nodes = np.array(draw(st.permutations(range(len(bounds)))), dtype=np.int64)
    return OpenBlocks(bounds, np.column_stack([nodes // 4, nodes // 2 % 2, nodes % 2]).reshape(-1, 3))


def held(bounds, nodes):
    """What a set of blocks holds, in an order of its own."""
    return sorted(zip(bounds.tolist(), nodes.tolist(), strict=True))


@given(open_blocks(), st.integers(1, 15))
def test_those_that_are_taken_have_the_highest_bounds_and_the_others_stay(blocks, most):
    before = held(blocks.bounds, blocks.nodes)
    bounds, nodes = blocks.take(most)
    assert len(bounds) == min(most, len(before))
    assert bounds.min(initial=np.inf) >= blocks.bounds.max(initial=-np.inf)
    assert sorted(held(bounds, nodes) + held(blocks.bounds, blocks.nodes)) == before


@given(open_blocks(), few_values)
def test_blocks_that_are_no_better_than_what_is_sought_are_dropped_and_no_others(blocks, value):
    before = held(blocks.bounds, blocks.nodes)
    bounds, nodes = blocks.drop(value)
    assert (bounds <= value).all()
    assert (blocks.bounds > value).all()
    assert sorted(held(bounds, nodes) + held(blocks.bounds, blocks.nodes)) == before


@given(open_blocks(), st.one_of(st.just(-np.inf), few_values))
def test_the_best_is_the_first_of_the_highest_whatever_their_order(blocks, above):
    value, node = blocks.best(above)
    if node is None:
        assert value == -np.inf
        assert (blocks.bounds <= above).all()
        return
    assert value == blocks.top > above
    equal = blocks.nodes[blocks.bounds == value].tolist()
    assert node.tolist() == min(equal)


@given(open_blocks(), open_blocks())
def test_what_is_added_is_there_with_what_was(one, other):
    both = held(one.bounds, one.nodes) + held(other.bounds, other.nodes)
    one.add(other.bounds, other.nodes)
    assert held(one.bounds, one.nodes) == sorted(both)


def test_where_there_is_nothing_there_is_no_best_and_nothing_to_take():
    empty = OpenBlocks.empty()
    assert empty.top == -np.inf
    assert empty.best() == (-np.inf, None)
    bounds, nodes = empty.take(5)
    assert (bounds.shape, nodes.shape) == ((0,), (0, 3))


@given(open_blocks(), st.randoms())
def test_keeping_some_keeps_each_block_with_its_bound(blocks, chance):
    which = np.array([chance.random() < 0.5 for _ in blocks.bounds], dtype=bool)
    wanted = held(blocks.bounds[which], blocks.nodes[which])
    blocks.keep(which)
    assert held(blocks.bounds, blocks.nodes) == wanted
    assert blocks.top == pytest.approx(max([b for b, _ in wanted], default=-np.inf))
