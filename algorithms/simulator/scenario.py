"""Three robots map one building and meet in turn: two pairs of maps with their ground truth."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from algorithms.common.pose import Pose2
from algorithms.maps.grid_map import GridMap
from algorithms.observations.observation import SIGMA_BEARING, SIGMA_RANGE, Observation
from algorithms.simulator.buildings.building_types import build
from algorithms.simulator.buildings.floor_plan import Building
from algorithms.simulator.path_planning import PathPlanner
from algorithms.simulator.portable_random import chance, stream, uniform
from algorithms.simulator.robot import Conditions, Robot, drive, make_body
from algorithms.simulator.room_tours import TourPlanner
from algorithms.simulator.sighting import (
    ROUGH_BEARING,
    ROUGH_RANGE,
    RobotSighting,
    find_meetings,
    fit,
    in_belief,
    measured_overlap,
    observe,
)
from algorithms.simulator.views.pictured_encounters import PicturedEncounter, pictured

LEAST, MOST = 0.05, 0.6  # overlaps that are drawn where none is asked for
TOLERANCE = 0.02  # an overlap this near to the one asked for is good enough
LOOSE = 0.08  # the same where nobody asked: it saves most of the rounds
ROUNDS = 6  # of choosing tours anew where the measured overlap is off
USUAL = Conditions()


@dataclass(frozen=True, eq=False)
class SimulatedCase:
    """Two maps, one sighting or several, and the truth: all that a case folder holds.

    ref, mov     : maps of observer and observed robot, each in its own frame
    observations : the sightings; ``rough`` are the same ones measured badly (0.3 m, 6°)
    T_ref_mov    : truth, a least-squares fit over the walls both saw; None where the two maps are
                   not of one place and the merge is to be refused
    overlap      : share of the smaller map's occupied cells that the other has too, 0 … 1
    truth_rms    : what the fit leaves, because each map is bent in its own way; metres
    source       : which building of which seed
    encounters   : what the observer's camera and laser measured, where somebody had a look
    """

    name: str
    ref: GridMap
    mov: GridMap
    observations: tuple[Observation, ...]
    rough: tuple[Observation, ...]
    T_ref_mov: Pose2 | None
    overlap: float
    truth_rms: float
    source: str
    encounters: tuple[PicturedEncounter, ...] = ()


@dataclass(frozen=True, eq=False)
class Pair:
    """An observer, the robot it observed, and how their frames lie.

    meetings  : the scans at which they saw one another, at least one
    T_ref_mov, truth_rms, overlap : as in ``SimulatedCase``
    """

    observer: Robot
    observed: Robot
    meetings: tuple[RobotSighting, ...]
    T_ref_mov: Pose2
    truth_rms: float
    overlap: float


@dataclass(frozen=True, eq=False)
class Scenario:
    """A building, the robots R1, R2, R3 in it, and what they saw of one another.

    pairs, cases : R2 → R1 and R3 → R2 (observer → observed)
    """

    building: Building
    robots: tuple[Robot, ...]
    pairs: tuple[Pair, ...]
    cases: tuple[SimulatedCase, ...]

    def pictured_case(self, n: int, seed: int) -> SimulatedCase:
        """The n-th case, with what its observer saw at every meeting; that takes a second or so.

        seed : of the building
        """
        pair = self.pairs[n]
        encounters = pictured(self.building, seed, pair.observer, pair.observed, pair.meetings)
        return replace(self.cases[n], encounters=encounters)


def simulate(
    kind: str,
    seed: int,
    overlap: float | tuple[float, float] | None = None,
    *,
    both_ways: bool | None = None,
    reach: float | None = None,
    sightings: int = 1,
    building: Building | None = None,
    conditions: tuple[Conditions, Conditions, Conditions] = (USUAL, USUAL, USUAL),
) -> Scenario:
    """Simulate three robots in a building: R2 sees R1, R3 sees R2.

    Parameters
    ----------
    kind : a key of ``BUILDINGS``, as "office" or "apartment".
    seed : any integer >= 0. One seed, one scenario, bit for bit on every machine; seeds differ in
        building, drives, frames and noise.
    overlap : share of the smaller map's occupied cells that the other map has within 0.1 m, 0 … 1,
        of R2 → R1 and R3 → R2. Aimed at, not promised: ``SimulatedCase.overlap`` holds what was measured.
        Without it, drawn from 0.05 … 0.6.
    both_ways : whether the observed robots measured a bearing back (``Observation.bearing_back``).
        Without it one scenario in four has it.
    reach : range of the lidars in metres. Without it drawn from 6 … 9.
    sightings : how often an observer sees the other robot, at places well apart; less often where the
        two meet less often. All else is the same for any number, the first sightings included.
    building : in which they drive. Without it that of the kind and the seed.
    conditions : under which R1, R2 and R3 drive: drift, wear, furniture moved, cells of the map.

    Returns
    -------
    Scenario
        ``cases`` (R2 → R1, R3 → R2) are named ``kind_r2_r1`` and ``kind_r3_r2``. Each robot's frame
        is turned by any angle against the building and lies up to tens of metres off.

    Notes
    -----
    The world frame is the building's: metres, x right, y up, origin at the lower-left corner of its
    raster. No robot's frame coincides with it.
    """
    rng = stream(seed, kind, "scenario")
    drawn = uniform(rng, LEAST, MOST), uniform(rng, LEAST, MOST)
    reach = reach or uniform(rng, 6.0, 9.0)
    back = chance(stream(seed, kind, "both ways"), 0.25) if both_ways is None else both_ways
    asked = overlap if isinstance(overlap, tuple) else (overlap, overlap)
    near_1, near_2 = (LOOSE if a is None else TOLERANCE for a in asked)
    aim_1, aim_2 = (d if a is None else a for a, d in zip(asked, drawn, strict=True))
    b1, b2, b3 = (make_body(f"R{n}", seed, kind, reach, under) for n, under in enumerate(conditions, 1))
    building = building or build(kind, seed)
    planner = PathPlanner(building)
    tour_planner = TourPlanner(building, planner, reach)
    stops = len(planner.stops)
    sizes = max(3, stops // 7), max(5, stops * 2 // 5)  # fewest and most stops of a tour

    def two_robots(aim: float, rng: np.random.Generator) -> tuple[Robot, Robot]:
        tours = tour_planner.pair(rng, aim, sizes)
        r2, r1 = (drive(building, planner, t, b) for t, b in zip(tours, (b2, b1), strict=True))
        return r2, r1

    nearest_pair = partial(_nearest_pair, building, planner, sightings)
    pair_1 = nearest_pair(two_robots, aim_1, near_1, stream(seed, kind, "R2 and R1"))
    r2 = pair_1.observer

    def third_robot(aim: float, rng: np.random.Generator) -> tuple[Robot, Robot]:
        tour = tour_planner.partner(rng, r2.tour, aim, sizes)
        return drive(building, planner, tour, b3), r2

    pair_2 = nearest_pair(third_robot, aim_2, near_2, stream(seed, kind, "R3 and R2"))
    source = f"mapmeld simulator, {kind} seed {seed}"
    pairs = (pair_1, pair_2)
    cases = tuple(
        case_of(pair, kind, source, stream(seed, kind, f"case {n}"), back) for n, pair in enumerate(pairs)
    )
    return Scenario(building, (pair_1.observed, r2, pair_2.observer), pairs, cases)


def _nearest_pair(
    building: Building,
    planner: PathPlanner,
    sightings: int,
    propose: Callable[[float, np.random.Generator], tuple[Robot, Robot]],
    target: float,
    tolerance: float,
    rng: np.random.Generator,
) -> Pair:
    """Let robots drive until their maps overlap as asked; the nearest of a few rounds.

    The overlap of tours is only a forecast of the overlap of maps, so what it missed by is taken
    off the next aim.
    """
    best, aim = None, target
    for round_ in range(4 * ROUNDS):
        if best is not None and (round_ >= ROUNDS or abs(best.overlap - target) <= tolerance):
            break
        pair = pair_up(building, planner, *propose(aim, rng), sightings)
        if pair is None:
            aim = min(0.95, aim + 0.03)  # drives that share more are likelier to meet
            continue
        if best is None or abs(pair.overlap - target) < abs(best.overlap - target):
            best = pair
        aim = min(0.95, max(0.01, aim - 0.7 * (pair.overlap - target)))
    if best is None:
        raise RuntimeError(f"no two drives meet in this {building.name}")
    return best


def pair_up(
    building: Building, planner: PathPlanner, observer: Robot, observed: Robot, sightings: int = 1
) -> Pair | None:
    """Let two robots meet and find how their frames truly lie; None where they never do."""
    in_view = np.argwhere(observer.tour.seen & observed.tour.seen)[:, ::-1]  # wall nodes
    if len(in_view) < 10:
        return None
    walls = np.asarray((in_view + 0.5) * planner.node, dtype=np.float64)  # metres, world frame
    meetings = find_meetings(building, observer.true, observed.true, walls, sightings)
    if not meetings:
        return None
    T_ref_mov, rms = fit(
        in_belief(observer.true, observer.believed, walls),
        in_belief(observed.true, observed.believed, walls),
    )
    overlap = measured_overlap(observer.grid, observed.grid, T_ref_mov)
    return Pair(observer, observed, meetings, T_ref_mov, round(rms, 4), round(overlap, 3))


def case_of(pair: Pair, kind: str, source: str, rng: np.random.Generator, both_ways: bool) -> SimulatedCase:
    a, b = pair.observer, pair.observed
    true, believed = (a.true, b.true), (a.believed, b.believed)
    good, bad = (SIGMA_RANGE, SIGMA_BEARING), (ROUGH_RANGE, ROUGH_BEARING)
    seen = [[observe(true, believed, at, rng, s, both_ways) for s in (good, bad)] for at in pair.meetings]
    return SimulatedCase(
        name=f"{kind}_{a.body.name}_{b.body.name}".lower(),
        ref=a.grid,
        mov=b.grid,
        observations=tuple(well for well, _ in seen),
        rough=tuple(badly for _, badly in seen),
        T_ref_mov=pair.T_ref_mov,
        overlap=pair.overlap,
        truth_rms=pair.truth_rms,
        source=source,
    )
