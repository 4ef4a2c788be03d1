"""Pairs of maps by the thousand, right and wrong, as easy and as hard as people meet them.

The model of the verdict is fitted to them. Real surveys bend by up to a metre in 15 m, doors are open in one
and shut in the other, furniture moves, walls are drawn thick or lose cells, and a depth sensor reaches a few
metres only: all of that is drawn here, robot by robot.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import lru_cache
from math import atan2, cos, hypot, sin
from typing import Literal

import numpy as np

from algorithms.common.pose import wrap_angle
from algorithms.maps.grid_map import GridMap
from algorithms.observations.observation import Observation
from algorithms.simulator.buildings.building_types import BUILDINGS, build
from algorithms.simulator.buildings.floor_plan import WALL, Building, FloorPlan
from algorithms.simulator.odometry_drift import OdometryDrift
from algorithms.simulator.portable_random import chance, pick, stream, uniform, whole
from algorithms.simulator.robot import Conditions
from algorithms.simulator.scenario import SimulatedCase, simulate
from algorithms.simulator.wear import Wear
from algorithms.simulator.wrong_pairs import mirrored, mismatch

Kind = Literal["right", "wrong sighting", "mirrored", "same plan", "other building"]

MIRRORED = 5  # every so manieth building is mirrored, too: it happens seldom
OTHERS = 4  # other buildings that a building is crossed with
LEAST, MOST = 0.05, 0.8  # overlap
SURVEYS = 0.3  # share of the buildings that are surveyed by hand
FROM, TO = 3.0, 8.0  # metres by which a wrong sighting is wrong: out of reach of a badly measured one
FROM_DOORS = 1.2  # metres from a jamb within which there is no pillar
WALL_PER_PILLAR = 1.0  # m² of wall, as seen from above: one in 8 m of a wall 0.12 m thick
HARDSHIPS = (0.0, 0.2, 0.2, 0.5, 0.8)  # how likely each hardship is, building by building
ONE_FLOOR = ("warehouse",)  # another floor of it would be the same one, furnished anew
ONE_PLAN = ("corridor",)  # all of them are drawn to one plan, as the floors of a building are


@dataclass(frozen=True, eq=False)
class TrainingPair:
    """A pair and what it is.

    buildings    : whose maps these are, by their seeds; pairs of one building must not be on both sides of a
                   cross-validation
    observations : the good or the bad ones of the case
    """

    case: SimulatedCase
    kind: Kind
    buildings: tuple[str, ...]
    observations: tuple[Observation, ...]


def training_pairs(seed: int) -> Iterator[TrainingPair]:
    """All pairs of one building: two right ones, and wrong ones of every kind.

    Those of the "same plan" are another floor of the building, or another building that is as like it.

    Neighbouring seeds are buildings of different kinds; ``len(BUILDINGS)`` seeds apart they are of one.
    """
    rng, name = stream(seed, "training pairs"), str(seed)
    cases = _cases(seed)
    for case in cases:
        yield _pair(case, "right", (name,), rng)
    one = pick(rng, cases)
    yield _pair(wrongly_seen(one, rng), "wrong sighting", (name,), rng)
    if seed % MIRRORED == 0:
        yield _pair(mirrored(one), "mirrored", (name,), rng)
    if _kind(seed) not in ONE_FLOOR:
        yield _pair(mismatch(cases[0], _cases(seed, floor=1)[0]), "same plan", (name,), rng)
    for step in (*range(1, OTHERS), len(BUILDINGS)):
        other = mismatch(pick(rng, cases), pick(rng, _cases(seed + step)))
        alike = _kind(seed) == _kind(seed + step) and _kind(seed) in ONE_PLAN
        kind: Kind = "same plan" if alike else "other building"
        yield _pair(other, kind, (name, str(seed + step)), rng)


def _pair(
    case: SimulatedCase, kind: Kind, buildings: tuple[str, ...], rng: np.random.Generator
) -> TrainingPair:
    return TrainingPair(case, kind, buildings, case.rough if chance(rng, 0.4) else case.observations)


def _kind(seed: int) -> str:
    return list(BUILDINGS)[seed % len(BUILDINGS)]


@lru_cache(maxsize=2 * len(BUILDINGS))
def _cases(seed: int, floor: int = 0) -> tuple[SimulatedCase, ...]:
    """The two cases of a building; the same seed gives the same robots on every floor."""
    rng = stream(seed, "conditions")
    survey = chance(rng, SURVEYS)
    hard = pick(rng, HARDSHIPS)
    draw = _survey if survey else _lidar
    conditions = draw(rng, hard), draw(rng, hard), draw(rng, hard)
    overlap = uniform(rng, LEAST, MOST), uniform(rng, LEAST, MOST)
    reach = uniform(rng, 3.5, 5.0) if survey else None
    kind = _kind(seed)
    building = with_pillars(build(kind, seed, floor), stream(seed, kind, f"pillars of floor {floor}"))
    return simulate(kind, seed, overlap, reach=reach, building=building, conditions=conditions).cases


def _lidar(rng: np.random.Generator, hard: float) -> Conditions:
    """A robot with a lidar; maps that are sent to and fro get worn.

    hard : 0 … 1, how likely each hardship is
    """

    def one_of(*worse: float) -> float:
        return pick(rng, worse) if chance(rng, hard) else 0.0

    wander = 1 + one_of(0, 1, 2)
    drift = _drift(wander, one_of(0.15, 0.3, 0.6) * uniform(rng, 0.5, 1.0))
    wear = Wear(
        thicker=int(one_of(0, 1, 1, 2)),
        lost=one_of(0.05, 0.1, 0.2),
        dotted=one_of(0, 0, 0, 0.2, 0.4),
        holes=one_of(0, 0, 0.05, 0.1),
        specks=one_of(0, 0, 0.002, 0.005, 0.01),
    )
    return Conditions(drift, changed=chance(rng, 0.6 * hard), wear=wear)


def _survey(rng: np.random.Generator, hard: float) -> Conditions:
    """A depth sensor carried by hand: it reaches a few metres, walls come out thick, and all of it bends."""
    drift = _drift(whole(rng, 1, 3), uniform(rng, 0.2, 1.0))
    return Conditions(drift, changed=chance(rng, 0.6 * hard), wear=Wear(thicker=whole(rng, 0, 2)))


def _drift(wander: float, bend: float) -> OdometryDrift:
    return OdometryDrift(metres=0.025 * wander, degrees=0.22 * wander, bend=bend)


def with_pillars(building: Building, rng: np.random.Generator) -> Building:
    """The building with pillars, radiators and cabinets before its walls, so that no two of its corridors are
    quite alike.
    """
    plan = FloorPlan.of(building)
    walls = np.argwhere(plan.cells == WALL)
    jambs = building.doors.reshape(-1, 2)
    for _ in range(int(len(walls) * building.resolution**2 / WALL_PER_PILLAR)):
        row, col = walls[whole(rng, 0, len(walls) - 1)].tolist()
        x, y = (col + 0.5) * building.resolution, (row + 0.5) * building.resolution
        half, deep = uniform(rng, 0.1, 0.35), uniform(rng, 0.15, 0.3)
        long, wide = (half, deep) if chance(rng, 0.5) else (deep, half)
        if np.hypot(*(jambs - (x, y)).T).min(initial=np.inf) > FROM_DOORS:
            plan.box(x - long, y - wide, x + long, y + wide)
    return replace(building, surface=plan.cells)


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
