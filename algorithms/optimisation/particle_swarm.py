"""Particle swarm optimisation (PSO), eqs. (21), (22)."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from math import pi
from typing import Annotated

import numpy as np

from algorithms.common.pose import FloatArray, wrap_angles
from algorithms.common.setting_bounds import Bounds, CheckedConfig
from algorithms.optimisation.optimiser import SearchState, Value, keep_inside
from algorithms.optimisation.search_box import SearchBox

SETTLED_CELLS = 0.1  # a swarm that stays within a tenth of a cell cannot tell two answers apart
SETTLED_ANGLE = 0.05 * pi / 180


@dataclass(frozen=True)
class SwarmConfig(CheckedConfig):
    """Settings of the swarm, eq. (21); the Monte-Carlo search draws as many samples."""

    particles: Annotated[int, Bounds(10, 2000, 10, "", "N_p", "particles")] = 400
    """Transforms alive at once. More find the best place more surely and take longer."""
    iterations: Annotated[int, Bounds(1, 300, 1, "", "", "iterations")] = 80
    """At most so many; the swarm stops earlier once it has settled."""
    omega: Annotated[float, Bounds(0.1, 0.99, 0.01, "", "ω", "constriction")] = 0.73
    """Friction on the whole step. High: the swarm roams; low: it settles early."""
    tau: Annotated[float, Bounds(0.1, 4.0, 0.05, "", "τ", "attraction")] = 2.05
    """Pull towards the swarm's best and each particle's own best."""


def settled_within(cell: float) -> FloatArray:
    """(3,) spread below which a swarm has settled; metres, metres, radians."""
    return np.array([SETTLED_CELLS * cell, SETTLED_CELLS * cell, SETTLED_ANGLE])


def swarm(
    value: Value, box: SearchBox, config: SwarmConfig, settled: FloatArray, rng: np.random.Generator
) -> Iterator[SearchState]:
    """Yield the swarm once per iteration; the caller may leave the loop at any time.

    settled : (3,) metres, metres, radians; the swarm has settled once half of it is this near to its
              best. Stragglers are left out: a few roam long after nothing better can be found
    """
    whole_turn = box.high[2] - box.low[2] >= 2 * pi
    shape = (config.particles, 3)
    poses = rng.uniform(box.low, box.high, shape)
    velocity = np.zeros(shape)
    own, own_values = poses.copy(), np.full(config.particles, -np.inf)
    pulls: FloatArray | None = None
    for iteration in range(config.iterations):
        values = value(poses)
        better = values > own_values
        own[better], own_values[better] = poses[better], values[better]
        best = own[int(own_values.argmax())]
        to_best, to_own = best - poses, own - poses
        if whole_turn:
            to_best[:, 2], to_own[:, 2] = wrap_angles(to_best[:, 2]), wrap_angles(to_own[:, 2])
        spread = np.median(np.abs(to_best), axis=0)
        stopped = None
        if np.all(spread <= settled):
            stopped = f"the swarm settled after {iteration + 1} iterations"
        elif iteration == config.iterations - 1:
            stopped = f"all {config.iterations} iterations used; the swarm had not settled"
        yield SearchState(
            iteration, poses.copy(), values, own.copy(), own_values.copy(), best.copy(),
            float(own_values.max()), stopped, pulls,
        )  # fmt: skip
        if stopped:
            return
        kappa_best, kappa_own = rng.random((2, *shape))
        by_best, by_own = kappa_best * config.tau * to_best, kappa_own * config.tau * to_own
        pulls = config.omega * np.stack([velocity, by_best, by_own])
        velocity = config.omega * (velocity + (by_best + by_own))  # eq. (21)
        moved = poses + velocity  # eq. (22)
        poses = keep_inside(moved, box)
        at_border = (moved < box.low) | (moved > box.high)
        at_border[:, 2] &= not whole_turn
        velocity[at_border] = 0.0  # who runs into the border stands there, and can turn round at once
