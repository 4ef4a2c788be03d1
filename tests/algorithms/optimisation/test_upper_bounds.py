from dataclasses import replace

import numpy as np
import pytest
from drawn import (
    OBSERVED,
    OBSERVER,
    T_MOV_WORLD,
    T_REF_WORLD,
    Problem,
    angles,
    drawn_map,
    poses,
    problems,
    seeds,
    sighting,
)
from hypothesis import given, settings
from hypothesis import strategies as st

from algorithms.common import parallel_kernels as kernels
from algorithms.common.errors import TooLargeError
from algorithms.common.pose import Pose2, wrap_angles
from algorithms.maps.grid_map import GridMap
from algorithms.observations.observation import Encounter, encounter
from algorithms.observations.search_window import WindowConfig, coupled_window
from algorithms.optimisation.likelihood_field import AgreementConfig, make_agreement
from algorithms.optimisation.objective import Lookup
from algorithms.optimisation.transform_lattice import TransformLattice
from algorithms.optimisation.upper_bounds import UpperBounds
from algorithms.spectra.augmented_map import AugmentConfig


def transforms_of(lattice, seed, most=50_000):
    """(P, 3) numbers of all the transforms, of very many only some."""
    shape = (lattice.turns, lattice.side, lattice.side)
    if np.prod(shape) > most:
        return np.random.default_rng(seed).integers(0, shape, (most, 3))
    return np.indices(shape).reshape(3, -1).T


def values_of(problem, lattice, numbers):
    """(P,) values of (P, 3) transforms, −inf for those outside the window."""
    poses = lattice.poses(lattice.coordinates(numbers, 0))
    return np.where(problem.window.contains(poses), problem.objective(poses), -np.inf)


def check_bounds(problem, seed):
    """Every block of every level against all that it holds."""
    upper_bounds = UpperBounds(problem.objective, problem.window)
    numbers = transforms_of(upper_bounds.lattice, seed)
    values = values_of(problem, upper_bounds.lattice, numbers)
    assert np.array_equal(upper_bounds(numbers, 0), values)
    for level in range(1, upper_bounds.lattice.levels + 1):
        shape = (
            np.array([upper_bounds.lattice.turns, upper_bounds.lattice.side, upper_bounds.lattice.side])
            >> level
        )
        bounds = upper_bounds(np.indices(shape).reshape(3, -1).T, level).reshape(shape)
        assert np.all(values <= bounds[tuple((numbers >> level).T)])


@settings(max_examples=80)
@given(problems(), seeds)
def test_no_transform_in_a_block_is_better_than_the_blocks_bound(problem, seed):
    # what lies outside the window has the bound −inf, so that nothing of the window may be in it
    check_bounds(problem, seed)


@settings(max_examples=10)
@given(poses, poses, seeds)
def test_nor_where_a_rough_sighting_leaves_more_than_the_map_is_large(T_ref_world, T_mov_world, seed):
    # a turn then swings the shift farther than the walls
    ref, mov = (drawn_map(T, 0.1, seen=(4.1, 0.9, 5, 1.7)) for T in (T_ref_world, T_mov_world))
    post = np.array([4.2, 1.0])
    met = [Encounter(T_ref_world.apply(post), T_mov_world.apply(post), np.eye(2) * 0.3**2)]
    window = coupled_window(met, WindowConfig("coupled"))
    narrow = AugmentConfig(spread=0.2)
    objective = make_agreement(ref, mov, met, narrow, AgreementConfig(), window, Lookup.NEAREST)
    check_bounds(Problem(ref, mov, met, window, objective), seed)


def members_of(nodes, level):
    """Numbers of all the transforms in blocks, by counting them."""
    offsets = np.indices((2**level,) * 3).reshape(3, -1).T
    return (nodes[:, None, :] * 2**level + offsets).reshape(-1, 3)


@given(st.integers(1, 4), st.tuples(*3 * [st.integers(0, 1000)]))
def test_the_children_of_a_block_hold_its_transforms_each_once(level, node):
    block = np.array([node])
    theirs = members_of(TransformLattice.children(block), level - 1)
    assert sorted(map(tuple, theirs)) == sorted(map(tuple, members_of(block, level)))


@settings(max_examples=20)
@given(problems(side=8))
def test_the_coarsest_blocks_hold_every_transform_once(problem):
    lattice = TransformLattice(problem.objective, problem.window)
    numbers = members_of(lattice.roots(), lattice.levels)
    flat = np.ravel_multi_index(tuple(numbers.T), (lattice.turns, lattice.side, lattice.side))
    assert np.array_equal(np.sort(flat), np.arange(lattice.turns * lattice.side**2))


@settings(max_examples=20)
@given(problems(side=8), st.floats(1e6, 1e9))
def test_a_window_of_more_blocks_than_memory_holds_is_refused_with_a_remedy(problem, wide):
    # the disc of a sighting of metres, in cells of a tenth of a millimetre
    lattice = TransformLattice(problem.objective, replace(problem.window, k=wide))
    with pytest.raises(
        TooLargeError, match=r"blocks of transforms .* coarser resolution, or smaller deviations"
    ):
        lattice.roots()


@settings(max_examples=60)
@given(problems(), angles, angles, st.floats(0, 1))
def test_no_shift_and_no_turn_of_the_window_is_left_out(problem, turn, towards, share):
    lattice = TransformLattice(problem.objective, problem.window)
    direction = problem.window.k * share * np.array([np.cos(towards), np.sin(towards)])
    off = np.linalg.solve(problem.window.whitening[0], direction)
    whole = np.trunc(off / lattice.cell) * lattice.cell
    every = np.column_stack([np.zeros(lattice.side), *(2 * [np.arange(lattice.side)])])
    shifts = lattice.coordinates(every, 0)[:, 0]
    for axis in range(2):
        assert np.abs(shifts - whole[axis]).min() < 1e-9
    turns = lattice.step * np.arange(lattice.turns)
    assert np.abs(wrap_angles(turns - turn)).min() <= lattice.step / 2 + 1e-9


@settings(max_examples=40)
@given(problems())
def test_between_neighbours_no_wall_moves_by_more_than_a_cell(problem):
    lattice = TransformLattice(problem.objective, problem.window)
    middle = np.array([0, lattice.side // 2, lattice.side // 2])
    for beside in ((1, 0, 0), (0, 1, 0), (0, 0, 1)):
        numbers = np.array([middle, middle + beside])
        T, other = map(Pose2.from_array, lattice.poses(lattice.coordinates(numbers, 0)))
        for side in problem.objective.sides:
            points = side.points + side.anchor
            if side.backward:
                moved = T.inverse().apply(points) - other.inverse().apply(points)
            else:
                moved = T.apply(points) - other.apply(points)
            assert np.linalg.norm(moved, axis=1).max(initial=0.0) <= lattice.cell * (1 + 1e-9)


@pytest.mark.parametrize("resolution", [0.02, 0.05, 0.4, 3.0])
def test_however_exact_a_sighting_and_coarse_a_map_the_lattice_has_a_transform_for_it(resolution):
    grid = GridMap(np.full((9, 9), 100, dtype=np.int8), resolution, Pose2(3, 4, 1))
    seen = Encounter(np.array([3.0, 4.0]), np.array([2.0, 5.0]), np.eye(2) * 1e-8)
    window = coupled_window([seen], WindowConfig("coupled", margin=0.0, deviations=1.0))
    objective = make_agreement(grid, grid, [seen], AugmentConfig(), AgreementConfig(), window)
    upper_bounds = UpperBounds(objective, window)
    numbers = members_of(upper_bounds.lattice.roots(), upper_bounds.lattice.levels)
    assert np.isfinite(upper_bounds(numbers, 0)).sum() == upper_bounds.lattice.turns


@pytest.mark.parametrize("threads", [1, 2, 3, 7])
def test_the_same_bounds_on_any_number_of_threads(threads, monkeypatch):
    ref, mov = drawn_map(T_REF_WORLD), drawn_map(T_MOV_WORLD)
    met = [encounter(sighting(T_REF_WORLD, T_MOV_WORLD, OBSERVER, OBSERVED))]
    window = coupled_window(met, WindowConfig("coupled"))
    upper_bounds = UpperBounds(
        make_agreement(ref, mov, met, AugmentConfig(), AgreementConfig(), window), window
    )
    lattice = upper_bounds.lattice
    for level in range(lattice.levels + 1):
        numbers = transforms_of(lattice, seed=0, most=1000)
        monkeypatch.setattr(kernels, "cores", lambda: 1)
        alone = upper_bounds(numbers >> level, level)
        monkeypatch.setattr(kernels, "cores", lambda: threads)
        assert np.array_equal(alone, upper_bounds(numbers >> level, level))


def test_a_bound_holds_where_only_a_part_of_a_large_map_can_be_looked_up():
    """The encounter lies far from the corner of the table, which is cut to what the lattice reaches."""
    cells = np.where(np.random.default_rng(1).random((400, 400)) < 0.1, 100, 0).astype(np.int8)
    grid = GridMap(cells, 0.1)
    met = [Encounter(np.array([20.0, 20.0]), np.array([20.0, 20.0]), np.eye(2) * 0.1**2)]
    window = coupled_window(met, WindowConfig("coupled"))
    objective = make_agreement(
        grid, grid, met, AugmentConfig(spread=2.0), AgreementConfig(), None, Lookup.NEAREST
    )
    bounds = UpperBounds(objective, window)
    lattice = bounds.lattice
    nodes = np.array([[0, lattice.side // 2, lattice.side // 2]]) + [[k, 0, 0] for k in range(4)]
    values = bounds(nodes, 0)
    assert np.isfinite(values).all()
    for level in range(1, 4):
        assert (bounds(nodes >> level, level) >= values).all()
    # no looser than need be: the same walls, no farther from the corner
    part = GridMap(cells[110:290, 110:290], 0.1, Pose2(11.0, 11.0))
    near = make_agreement(part, part, met, AugmentConfig(spread=2.0), AgreementConfig(), None, Lookup.NEAREST)
    assert np.allclose(UpperBounds(near, window)(nodes >> 2, 2), bounds(nodes >> 2, 2), rtol=1e-3)
