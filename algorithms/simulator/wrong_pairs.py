"""Pairs to which the only right answer is to refuse, made of right ones."""

from __future__ import annotations

from dataclasses import replace
from math import atan2, cos, hypot, sin

import numpy as np

from algorithms.common.pose import wrap_angle
from algorithms.maps.grid_map import GridMap
from algorithms.observations import observation
from algorithms.observations.observation import Observation
from algorithms.simulator.portable_random import chance, uniform
from algorithms.simulator.scenario import SimulatedCase

FROM, TO = 3.0, 8.0  # metres by which a wrong sighting is wrong: out of reach of a badly measured one


def mismatch(a: SimulatedCase, b: SimulatedCase) -> SimulatedCase:
    """The observer of one case and the observed robot of another building's, or of another floor.

    The sightings, as many as both have, are forged from halves.
    """
    return SimulatedCase(
        name=f"wrong_{a.name}_{b.name}",
        ref=a.ref,
        mov=b.mov,
        observations=tuple(map(crossed, a.observations, b.observations)),
        rough=tuple(map(crossed, a.rough, b.rough)),
        T_ref_mov=None,
        overlap=0.0,
        truth_rms=0.0,
        source=f"{a.source}; {b.source}",
    )


def crossed(a: Observation, b: Observation) -> Observation:
    """What the observer of ``a`` measured, as if it had seen the robot of ``b``."""
    return replace(
        a,
        observed_x=b.observed_x,
        observed_y=b.observed_y,
        observed_heading=b.observed_heading,
        bearing_back=b.bearing_back,
    )


def mirrored(case: SimulatedCase) -> SimulatedCase:
    """The same case, map 2 flipped left to right, and what robot 2 knows of itself with it."""
    return replace(
        case,
        name=f"mirrored_{case.name}",
        mov=case.mov.mirrored(),
        observations=tuple(map(observation.mirrored, case.observations)),
        rough=tuple(map(observation.mirrored, case.rough)),
        T_ref_mov=None,
    )


def wrongly_seen(case: SimulatedCase, rng: np.random.Generator) -> SimulatedCase:
    """The same case with sightings that put robot 2 metres away from where it was, along a wall.

    In a corridor that is a door or two further on.
    """
    assert case.T_ref_mov is not None
    sign = 1.0 if chance(rng, 0.5) else -1.0
    along, far = _longest_wall(case.ref), sign * uniform(rng, FROM, TO)
    dx, dy = far * cos(along), far * sin(along)

    def put_off(o: Observation) -> Observation:
        direction = o.observer.theta + o.bearing
        x, y = o.range * cos(direction) + dx, o.range * sin(direction) + dy
        bearing = wrap_angle(atan2(y, x) - o.observer.theta)
        return replace(o, range=round(hypot(x, y), 6), bearing=round(bearing, 6))

    return replace(
        case,
        name=f"misseen_{case.name}",
        observations=tuple(map(put_off, case.observations)),
        rough=tuple(map(put_off, case.rough)),
        T_ref_mov=None,
    )


def _longest_wall(grid: GridMap) -> float:
    """Direction in which most wall of a map runs; radians, the map's frame."""
    points = grid.points - grid.points.mean(axis=0)
    spread = np.linalg.eigh(points.T @ points)[1][:, -1]
    return float(atan2(spread[1], spread[0]))
