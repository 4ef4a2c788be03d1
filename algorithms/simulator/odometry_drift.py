"""What a robot believes of its own drive: how its odometry drifts, and its map bends."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from algorithms.common.pose import FloatArray
from algorithms.simulator.path_planning import STEP, Track
from algorithms.simulator.portable_random import TURN, cosine, normals, sine, snap, uniform, whole

WAVE = 30.0  # metres; how long the waves of a bent map are


@dataclass(frozen=True)
class OdometryDrift:
    """How far a robot that corrects itself goes astray."""

    metres: float = 0.025  # standard deviation of the slow position error
    degrees: float = 0.22  # of the slow heading error
    memory: float = 12.0  # metres driven until an error is forgotten by a factor of e
    jitter_metres: float = 0.01  # of the error of a single scan
    jitter_degrees: float = 0.12
    bend: float = 0.0  # metres by which a straight wall of 15 m becomes a bow, in its middle, at most


def _wander(rng: np.random.Generator, n: int, deviation: float, memory: float) -> FloatArray:
    """(n,) a random walk on a lead: starts at 0, keeps near it; unit of ``deviation``."""
    kept = 1.0 - STEP / memory
    push = deviation * float(np.sqrt(1.0 - kept * kept))
    values, value = [], 0.0
    for kick in normals(rng, n).tolist():
        values.append(value)
        value = kept * value + push * kick
    return np.array(values)


def _bow(xy: FloatArray, bend: float, rng: np.random.Generator) -> tuple[FloatArray, FloatArray]:
    """(N, 2) metres and (N,) degrees by which two waves, each across its own direction, put places off.

    A wave is 30 m long: a wall of half of it along the wave becomes a bow, ``bend`` off in the middle.
    """
    off, degrees = np.zeros_like(xy), np.zeros(len(xy))
    heading = whole(rng, 0, TURN - 1)
    for ahead, share in ((heading, uniform(rng, 0.5, 1.0)), (heading + TURN // 4, uniform(rng, 0.0, 0.7))):
        c, s = float(cosine(ahead)), float(sine(ahead))
        along = xy[:, 0] * c + xy[:, 1] * s
        phase = whole(rng, 0, TURN - 1) + np.rint(along * (TURN / WAVE)).astype(np.int64)
        off += (bend * share) * sine(phase)[:, None] * np.array([-s, c])
        degrees += (bend * share * 360 / WAVE) * cosine(phase)  # the slope of the bow
    return off, degrees


def believe(
    true: Track, turn: int, shift: FloatArray, drift: OdometryDrift, rng: np.random.Generator
) -> Track:
    """The drive as the robot believes it, in its own frame.

    turn, shift : T_robot_world without drift; ticks and (2,) metres
    """
    n = len(true)
    off = [
        _wander(rng, n, drift.metres, drift.memory) + drift.jitter_metres * normals(rng, n) for _ in range(2)
    ]
    degrees = _wander(rng, n, drift.degrees, drift.memory) + drift.jitter_degrees * normals(rng, n)
    if drift.bend > 0:
        bent, turned = _bow(true.xy, drift.bend, rng)
        off, degrees = [off[0] + bent[:, 0], off[1] + bent[:, 1]], degrees + turned
    c, s = float(cosine(turn)), float(sine(turn))
    x, y = true.xy[:, 0] + off[0], true.xy[:, 1] + off[1]
    xy = np.stack([x * c - y * s + shift[0], x * s + y * c + shift[1]], axis=-1)
    tick = 360 / TURN
    heading = (true.heading + turn + np.rint(degrees / tick).astype(np.int64)) % TURN
    return Track(snap(xy), heading)
