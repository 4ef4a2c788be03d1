"""Monte-Carlo optimisation (MCO): the best of many samples in the box, section III-D.1."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from algorithms.common.pose import FloatArray
from algorithms.optimisation.optimiser import SearchState, Value
from algorithms.optimisation.particle_swarm import SwarmConfig
from algorithms.optimisation.search_box import SearchBox


def monte_carlo(
    value: Value, box: SearchBox, config: SwarmConfig, settled: FloatArray, rng: np.random.Generator
) -> Iterator[SearchState]:
    """Yield a batch of ``config.particles`` samples per iteration, with the best so far.

    It takes what the swarm takes, so that both are compared at equal cost; ``settled`` has no
    meaning for samples that remember nothing.
    """
    best, best_value = box.centre, float(value(box.centre[None])[0])
    for iteration in range(config.iterations):
        poses = rng.uniform(box.low, box.high, (config.particles, 3))
        values = value(poses)
        top = int(values.argmax())
        if values[top] > best_value:
            best, best_value = poses[top], float(values[top])
        last = iteration == config.iterations - 1
        stopped = f"all {config.particles * config.iterations} samples drawn" if last else None
        own = poses.copy(), values.copy()
        yield SearchState(iteration, poses, values, *own, best.copy(), best_value, stopped)
