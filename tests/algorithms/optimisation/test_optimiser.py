import itertools

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from algorithms.optimisation.monte_carlo import monte_carlo
from algorithms.optimisation.optimiser import keep_inside
from algorithms.optimisation.particle_swarm import SwarmConfig, settled_within, swarm
from algorithms.optimisation.search_box import SearchBox

OPTIMISERS = [swarm, monte_carlo]
TOP = np.array([0.3, -0.2, 0.05])
BOX = SearchBox(np.array([-1.0, -1.0, -0.2]), np.array([1.0, 1.0, 0.2]), np.zeros(2))
SETTLED = settled_within(0.05)


def hill(poses):
    return np.exp(-np.sum(((poses - TOP) / (0.3, 0.3, 0.05)) ** 2, axis=1))


def search(optimiser, value=hill, box=BOX, seed=0, **settings_):
    config = SwarmConfig(**{"particles": 60, "iterations": 60, **settings_})
    return list(optimiser(value, box, config, SETTLED, np.random.default_rng(seed)))


@pytest.mark.parametrize("optimiser", OPTIMISERS)
def test_the_top_of_a_hill_is_found(optimiser):
    *_, last = search(optimiser)
    assert last.best_value > 0.9
    assert np.allclose(last.best, TOP, atol=0.1)


@pytest.mark.parametrize("optimiser", OPTIMISERS)
@settings(max_examples=10, deadline=None)
@given(seed=st.integers(0, 10_000))
def test_the_best_never_gets_worse_and_is_what_it_claims(optimiser, seed):
    states = search(optimiser, seed=seed, iterations=15)
    values = [state.best_value for state in states]
    assert values == sorted(values)
    assert hill(states[-1].best[None])[0] == pytest.approx(values[-1])
    assert max(state.values.max() for state in states) <= values[-1]


@pytest.mark.parametrize("optimiser", OPTIMISERS)
@settings(max_examples=10, deadline=None)
@given(seed=st.integers(0, 10_000), tau=st.floats(0.5, 4), omega=st.floats(0.3, 0.99))
def test_nobody_leaves_the_box(optimiser, seed, tau, omega):
    for state in search(optimiser, seed=seed, iterations=12, tau=tau, omega=omega):
        assert np.all(state.poses >= BOX.low)
        assert np.all(state.poses <= BOX.high)


@pytest.mark.parametrize("optimiser", OPTIMISERS)
def test_the_same_seed_gives_the_same_search(optimiser):
    once, again, other = (search(optimiser, seed=seed, iterations=10) for seed in (4, 4, 5))
    assert all(np.array_equal(a.poses, b.poses) for a, b in zip(once, again, strict=True))
    assert not np.array_equal(once[0].poses, other[0].poses)


@pytest.mark.parametrize("optimiser", OPTIMISERS)
def test_only_the_last_state_says_why_it_ended(optimiser):
    states = search(optimiser, iterations=8)
    assert [state.stopped is None for state in states] == [True] * (len(states) - 1) + [False]
    assert "8 iterations" in states[-1].stopped or "480 samples" in states[-1].stopped


def test_a_swarm_settles_before_its_iterations_are_used_up():
    states = search(swarm, iterations=300)
    assert len(states) < 300
    assert "settled" in states[-1].stopped
    near = np.abs(states[-1].poses - states[-1].best) <= SETTLED
    assert np.all(near.mean(axis=0) >= 0.5)


def test_a_personal_best_is_a_place_its_particle_has_been():
    states = search(swarm, iterations=10)
    for particle in range(5):
        trail = [state.poses[particle] for state in states]
        own = states[-1].own_poses[particle]
        assert min(np.abs(own - place).max() for place in trail) == 0
        assert states[-1].own_values[particle] == max(state.values[particle] for state in states)


def test_a_snapshot_is_not_touched_by_what_follows():
    states = swarm(hill, BOX, SwarmConfig(particles=20, iterations=5), SETTLED, np.random.default_rng(0))
    first = next(states)
    before = first.poses.copy(), first.own_poses.copy(), first.own_values.copy()
    list(states)
    assert all(
        np.array_equal(a, b)
        for a, b in zip(before, (first.poses, first.own_poses, first.own_values), strict=True)
    )


def test_in_a_box_of_a_whole_turn_the_swarm_finds_a_top_across_the_seam():
    box = SearchBox(np.array([-0.1, -0.1, -np.pi]), np.array([0.1, 0.1, np.pi]), np.zeros(2))

    def seam(poses):
        return np.cos(poses[:, 2] - 3.1) + 1

    *_, last = search(swarm, seam, box)
    assert last.best_value > 1.999


@given(st.lists(st.tuples(*3 * [st.floats(-30, 30)]), min_size=1, max_size=5).map(np.array))
def test_an_angle_that_runs_round_keeps_its_direction(poses):
    box = SearchBox(np.array([-1.0, -1.0, 0.0]), np.array([1.0, 1.0, 2 * np.pi]), np.zeros(2))
    inside = keep_inside(poses, box)
    assert np.allclose(np.cos(inside[:, 2]), np.cos(poses[:, 2]), atol=1e-9)
    assert np.all((inside[:, 2] >= 0) & (inside[:, 2] <= 2 * np.pi))


def test_monte_carlo_draws_as_many_samples_as_the_swarm_has_particle_steps():
    assert len(search(monte_carlo, particles=30, iterations=7)) == 7
    assert search(monte_carlo, particles=30, iterations=7)[0].poses.shape == (30, 3)


def test_the_three_pulls_are_what_moves_a_particle():
    states = search(swarm, seed=3, particles=20, iterations=12)
    assert states[0].pulls is None
    for before, after in itertools.pairwise(states):
        moved = before.poses + after.pulls.sum(axis=0)  # eqs. (21), (22)
        assert np.allclose(keep_inside(moved, BOX), after.poses)
        _, to_best, to_own = after.pulls
        most = 0.73 * 2.05
        assert np.all(np.abs(to_best) <= most * np.abs(before.best - before.poses) + 1e-12)
        assert np.all(np.abs(to_own) <= most * np.abs(before.own_poses - before.poses) + 1e-12)
    free = np.all((states[1].poses > BOX.low) & (states[1].poses < BOX.high), axis=1)
    came = states[1].poses - states[0].poses
    assert free.any()
    assert np.allclose(states[2].pulls[0][free], 0.73 * came[free])
