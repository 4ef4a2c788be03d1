"""A fleet maps one building: robots that meet here and there, some sightings that lie, and the truth."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from itertools import combinations
from math import pi

import numpy as np

from algorithms.common.pose import Pose2, wrap_angle
from algorithms.observations.fleet import Fleet, FleetSighting
from algorithms.observations.observation import SIGMA_BEARING, SIGMA_RANGE, Observation
from algorithms.simulator.buildings.building_types import build
from algorithms.simulator.buildings.floor_plan import Building
from algorithms.simulator.path_planning import PathPlanner
from algorithms.simulator.portable_random import chance, stream, uniform, whole
from algorithms.simulator.robot import Conditions, Robot, drive, make_body
from algorithms.simulator.room_tours import TourPlanner
from algorithms.simulator.scenario import USUAL, pair_up
from algorithms.simulator.sighting import RobotSighting, fit, in_belief, observe

OVERLAP = (0.15, 0.5)  # of two robots that met; share of the smaller map's walls
LEAST_OVERLAP = 0.1  # robots that share less have not met
OF_LOOPS = 0.35  # of the further pairs that could have met, so many have
RANGE_OFF = (1.5, 6.0)  # metres by which the range of a lie is off
BEARING_OFF = (0.7, pi)  # radians
ATTEMPTS = 12  # tours that are drawn until a robot meets another


@dataclass(frozen=True, eq=False)
class SimulatedFleet:
    """A fleet and what is true of it.

    T_anchor_robot : by name
    at             : (2,) the middle of each robot's drive, in its own frame; metres
    lies           : numbers of the false sightings, from 0
    tied           : names of the robots that true sightings tie to the anchor
    building       : that they map
    robots         : their drives and scans, by name
    met            : observer and observed robot of every true sighting, and at which of their scans it was
    """

    fleet: Fleet
    T_anchor_robot: Mapping[str, Pose2]
    at: Mapping[str, tuple[float, float]]
    lies: tuple[int, ...]
    tied: frozenset[str]
    building: Building
    robots: Mapping[str, Robot]
    met: tuple[tuple[str, str, RobotSighting], ...]


def simulate_fleet(
    kind: str,
    seed: int,
    robots: int,
    lies: float = 0.2,
    conditions: Conditions = USUAL,
    building: Building | None = None,
) -> SimulatedFleet:
    """Simulate robots in a building, each of which meets at least one of those before it.

    kind, seed : as in ``simulate``
    robots     : how many, named r1, r2, …
    lies       : share of the sightings that are false: range or bearing off, or another robot's name
    """
    rng = stream(seed, kind, f"fleet of {robots}")
    building = building or build(kind, seed)
    planner = PathPlanner(building)
    reach = uniform(rng, 6.0, 9.0)
    tours = TourPlanner(building, planner, reach)
    stops = len(planner.stops)
    sizes = max(3, stops // 7), max(5, stops * 2 // 5)
    made: list[Robot] = []
    sightings: list[FleetSighting] = []
    met: list[tuple[str, str, RobotSighting]] = []
    paired: set[frozenset[int]] = set()

    def meet(first: Robot, other: Robot, twice: bool) -> bool:
        """Note what they saw of each other, in a direction that is drawn; whether they met."""
        a, b = (first, other) if chance(rng, 0.5) else (other, first)
        pair = pair_up(building, planner, a, b, 2 if twice else 1)
        if pair is None or pair.overlap < LEAST_OVERLAP:
            return False
        for at in pair.meetings:
            true, believed = (a.true, b.true), (a.believed, b.believed)
            seen = observe(true, believed, at, rng, (SIGMA_RANGE, SIGMA_BEARING), False)
            seen = replace(seen, observed_heading=None)
            names = a.body.name.lower(), b.body.name.lower()
            sightings.append(FleetSighting(*names, seen))
            met.append((*names, at))
        return True

    for number in range(1, robots + 1):
        body = make_body(f"R{number}", seed, kind, reach, conditions)
        for attempt in range(ATTEMPTS):
            before = made[whole(rng, 0, len(made) - 1)] if made else None
            aim = uniform(rng, *OVERLAP) + 0.04 * attempt
            if before is None:
                tour, _ = tours.pair(rng, aim, sizes)
            else:
                tour = tours.partner(rng, before.tour, min(0.95, aim), sizes)
            robot = drive(building, planner, tour, body)
            if before is None or meet(robot, before, chance(rng, 0.25)):
                if before is not None:
                    paired.add(frozenset((len(made), made.index(before))))
                made.append(robot)
                break
        else:
            raise RuntimeError(f"robot {number} meets nobody in this {building.name}")
    for i, j in combinations(range(robots), 2):
        if frozenset((i, j)) not in paired and chance(rng, OF_LOOPS):
            meet(made[i], made[j], chance(rng, 0.25))
    names = [robot.body.name.lower() for robot in made]
    told, false = _with_lies(sightings, names, lies, rng)
    T = {name: _in_world(robot, planner) for name, robot in zip(names, made, strict=True)}
    middles = {
        name: tuple(robot.believed.xy[len(robot.believed) // 2].tolist())
        for name, robot in zip(names, made, strict=True)
    }
    fleet = Fleet({name: robot.grid for name, robot in zip(names, made, strict=True)}, tuple(told))
    tied = _tied(names, [seen for k, seen in enumerate(told) if k not in false])
    T_anchor = {name: T["r1"].inverse() @ T[name] for name in names}
    drives = dict(zip(names, made, strict=True))
    return SimulatedFleet(fleet, T_anchor, middles, false, tied, building, drives, tuple(met))


def _in_world(robot: Robot, planner: PathPlanner) -> Pose2:
    """T_world_robot: the least-squares fit over the walls that it saw."""
    walls = np.asarray((np.argwhere(robot.tour.seen)[:, ::-1] + 0.5) * planner.node, dtype=np.float64)
    T, _ = fit(walls, in_belief(robot.true, robot.believed, walls))
    return T


def _with_lies(
    sightings: list[FleetSighting], names: list[str], share: float, rng: np.random.Generator
) -> tuple[list[FleetSighting], tuple[int, ...]]:
    """The true sightings with lies among them, so that these are that share; numbers of the lies."""
    count = round(len(sightings) * share / (1 - share)) if share < 1 else 0
    told = list(sightings)
    for _ in range(count):
        seen = sightings[whole(rng, 0, len(sightings) - 1)]
        told.insert(whole(rng, 0, len(told)), _lie(seen, names, rng))
    true = {id(seen) for seen in sightings}
    return told, tuple(k for k, seen in enumerate(told) if id(seen) not in true)


def _lie(seen: FleetSighting, names: list[str], rng: np.random.Generator) -> FleetSighting:
    o: Observation = seen.observation
    others = [name for name in names if name not in (seen.observer, seen.observed)]
    kind = whole(rng, 0, 2 if others else 1)
    if kind == 0:
        return replace(seen, observation=replace(o, range=o.range + uniform(rng, *RANGE_OFF)))
    if kind == 1:
        off = uniform(rng, *BEARING_OFF) * (1 if chance(rng, 0.5) else -1)
        return replace(seen, observation=replace(o, bearing=wrap_angle(o.bearing + off)))
    return replace(seen, observed=others[whole(rng, 0, len(others) - 1)])


def _tied(names: list[str], sightings: list[FleetSighting]) -> frozenset[str]:
    """Whom sightings tie to the first robot."""
    tied = {names[0]}
    while True:
        more = {
            name
            for seen in sightings
            if {seen.observer, seen.observed} & tied
            for name in (seen.observer, seen.observed)
        }
        if more <= tied:
            return frozenset(tied)
        tied |= more
