"""One pair of very large maps, for measuring speed and memory."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from algorithms.common.pose import FloatArray
from algorithms.simulator.buildings.office import floor
from algorithms.simulator.path_planning import PathPlanner
from algorithms.simulator.portable_random import stream, ticks_of_degrees, whole
from algorithms.simulator.robot import Conditions, drive, make_body
from algorithms.simulator.room_tours import TourPlanner
from algorithms.simulator.scenario import SimulatedCase, case_of, pair_up

RESOLUTION = 0.05  # metres per cell
STOPS = 90  # of the many rooms, those that robots may visit
VISITS = 40  # of these, by each robot


def simulate_large(cells: int = 4000, seed: int = 0) -> SimulatedCase:
    """Two robots that each drove through most of one huge office floor; takes about a minute.

    cells   : rows and columns of each map, to within a few percent; up to 4000, a floor of 190 m
    returns : a case whose observer is R2 and whose observed robot is R1, 0.05 m per cell; the frames
              are turned by about 0°, 90°, 180° or 270° so that the raster stays tight
    """
    rng = stream(seed, "campus", "large")
    metres = cells * RESOLUTION / 1.03  # a turn by 1.5° makes the raster 3 % wider
    shell = stream(seed, "campus", "building")
    building = floor(shell, shell, metres, metres, 0.05, "campus")
    chosen = _spread_out(building.stops, rng)
    planner = PathPlanner(replace(building, stops=building.stops[chosen]))
    reach = 9.0
    tour_planner = TourPlanner(building, planner, reach)
    n = len(planner.stops)
    robots = []
    for name in ("R2", "R1"):
        body = make_body(name, seed, "campus", reach, Conditions(resolution=RESOLUTION))
        quarter = ticks_of_degrees(90) * whole(rng, 0, 3) + whole(rng, -270, 270)
        visits = sorted({whole(rng, 0, n - 1) for _ in range(VISITS)})
        tour = tour_planner.tour(visits, visits[0])
        robots.append(drive(building, planner, tour, replace(body, turn=quarter), step=0.4))
    observer, observed = robots
    pair = pair_up(building, planner, observer, observed)
    if pair is None:
        raise RuntimeError("the two robots never meet")
    source = f"mapmeld simulator, campus of {metres:.0f} m seed {seed}"
    return case_of(pair, "campus", source, stream(seed, "campus", "case"), both_ways=False)


def _spread_out(stops: FloatArray, rng: np.random.Generator) -> list[int]:
    """Indices of STOPS stops, each the farthest from those before it."""
    chosen = [whole(rng, 0, len(stops) - 1)]
    nearest = np.full(len(stops), np.inf)
    while len(chosen) < min(STOPS, len(stops)):
        dx, dy = (stops - stops[chosen[-1]]).T
        nearest = np.minimum(nearest, dx * dx + dy * dy)
        chosen.append(int(nearest.argmax()))
    return chosen
