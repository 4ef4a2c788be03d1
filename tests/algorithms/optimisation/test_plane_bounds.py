"""The bounds of whole sectors of the plane: above all that their blocks hold, and tight enough for use."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from drawn import Problem, flat_pair, problems, seeds, small_maps
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from algorithms.common.pose import Pose2
from algorithms.maps.robots import NO_ROBOTS
from algorithms.observations.pair_problem import Known, PairProblem
from algorithms.observations.priors import InitialPose, TurnPrior
from algorithms.observations.search_window import WindowConfig
from algorithms.optimisation.objective import Lookup, Objective
from algorithms.optimisation.plane_bounds import PlaneBlocks, PlaneBounds
from algorithms.optimisation.transform_lattice import TransformLattice
from algorithms.verdict.whole_maps import make_whole_maps

COUPLED = WindowConfig("coupled", deviations=3.5)


def check_bounds(objective: Objective, blocks: PlaneBlocks, seed: int) -> None:
    """Every block against all that it holds, or against some of it where that is very much."""
    lattice, bounds = blocks.lattice, PlaneBounds(objective, blocks)
    shape = (lattice.turns, lattice.side, lattice.side)
    rng = np.random.default_rng(seed)
    for turn in range(blocks.turns)[:: max(1, blocks.turns // 8)]:
        told = bounds.bounds(turn)
        numbers = rng.integers(0, shape, (4000, 3))
        numbers[:, 0] = rng.integers(turn << blocks.level, (turn + 1) << blocks.level, len(numbers))
        values = objective(lattice.poses(lattice.coordinates(numbers, 0)))
        _, cols, rows = (numbers >> blocks.level).T
        assert (values <= told[rows, cols]).all()


@settings(max_examples=60)
@given(problems(), seeds)
def test_no_transform_in_a_block_is_better_than_the_blocks_bound(problem: Problem, seed):
    assume(len(problem.objective.sides) == 2)
    objective = replace(problem.objective, window=None)
    check_bounds(objective, PlaneBlocks(TransformLattice(objective, problem.window)), seed)


@settings(max_examples=60)
@given(small_maps(), small_maps(), seeds)
def test_nor_on_the_whole_plane_where_nothing_is_known(ref, mov, seed):
    problem = PairProblem(ref, mov)
    objective, blocks = whole_plane(problem)
    check_bounds(objective, blocks, seed)


def whole_plane(problem: PairProblem) -> tuple[Objective, PlaneBlocks]:
    window = problem.window(COUPLED, curved=True)
    whole = make_whole_maps(problem.ref, problem.mov, NO_ROBOTS, window, 0.25)
    objective = replace(whole.crisp, lookup=Lookup.NEAREST)
    return objective, PlaneBlocks(TransformLattice(objective, window))


@given(small_maps(), small_maps(), st.floats(-9, 9), st.floats(-9, 9), st.floats(-3, 3))
def test_beyond_the_lattice_no_wall_meets_anything(ref, mov, dx, dy, turn):
    objective, blocks = whole_plane(PairProblem(ref, mov))
    window, disc = blocks.lattice.window, blocks.lattice.disc
    far = np.array([dx, dy]) / max(1e-9, float(np.hypot(dx, dy))) * disc * 1.001
    assume(np.hypot(*far) > disc)
    x, y = window.place + far - Pose2(theta=turn).apply(window.pivot)
    assert objective(np.array([[x, y, turn]])) == 0.0


FLAT = flat_pair()
T_TRUE = FLAT[3]


def sectors_left(*known: Known) -> tuple[int, bool]:
    """How many sectors of turns what is known leaves, and whether the true one is among them."""
    _, blocks = whole_plane(PairProblem.of(FLAT[0], FLAT[1], known))
    node = blocks.lattice.nearest(T_TRUE)[13]
    return len(blocks.left), node[0] >> blocks.level in blocks.left


def test_what_is_known_leaves_few_sectors_and_always_the_true_one():
    _, blocks = whole_plane(PairProblem(*FLAT[:2]))
    assert sectors_left() == (blocks.turns, True)
    for known in (TurnPrior(T_TRUE.theta + 0.02, 0.02), InitialPose(T_TRUE, 1.0, 1.0, 0.05)):
        left, true = sectors_left(known)
        assert true
        assert 0 < left < blocks.turns / 5


def test_the_walls_of_a_flat_leave_few_blocks_that_may_be_better_than_the_truth():
    objective, blocks = whole_plane(PairProblem(*FLAT[:2]))
    best = objective(
        blocks.lattice.poses(blocks.lattice.coordinates(blocks.lattice.nearest(T_TRUE), 0))
    ).max()
    assert best > 10
    bounds = PlaneBounds(objective, blocks)
    found = [bounds.above(turn, best - 1e-6) for turn in range(blocks.turns)]
    nodes = np.concatenate([nodes for nodes, *_ in found])
    assert 0 < len(nodes) < blocks.count / 1000
    home = (blocks.lattice.nearest(T_TRUE) >> blocks.level).tolist()
    assert any(node in home for node in nodes.tolist())
    assert max(rest for *_, rest in found) <= best


def test_the_nearest_transforms_of_the_lattice_surround_one():
    _, blocks = whole_plane(PairProblem(*FLAT[:2]))
    lattice = blocks.lattice
    poses = lattice.poses(lattice.coordinates(lattice.nearest(T_TRUE), 0))
    off = [Pose2.from_array(pose).inverse() @ T_TRUE for pose in poses]
    assert len(off) == 27
    assert min(abs(each.theta) for each in off) <= lattice.step / 2
    moved = [np.hypot(*(T.apply(lattice.window.pivot) - lattice.window.pivot)) for T in off]
    assert min(moved) == pytest.approx(0, abs=lattice.cell)
