"""Pairs to which the only right answer is to refuse, made of right ones."""

from __future__ import annotations

from dataclasses import replace

from algorithms.observations import observation
from algorithms.observations.observation import Observation
from algorithms.simulator.scenario import SimulatedCase


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
        encounters=(),
    )
