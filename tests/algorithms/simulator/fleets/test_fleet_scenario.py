"""A simulated fleet is the same from one seed; its truth is true of its sightings that are no lies."""

from __future__ import annotations

import numpy as np
import pytest

from algorithms.observations.observation import encounter
from algorithms.simulator.fleets.fleet_scenario import SimulatedFleet, simulate_fleet


@pytest.fixture(scope="module")
def made() -> SimulatedFleet:
    return simulate_fleet("home", 0, 4, lies=0.3)


def test_true_sightings_agree_with_the_true_poses_and_lies_do_not(made):
    off = []
    for seen in made.fleet.sightings:
        T = made.T_anchor_robot[seen.observer].inverse() @ made.T_anchor_robot[seen.observed]
        at = encounter(seen.observation)
        off.append(float(np.linalg.norm(T.apply(at.x_mov) - at.x_ref)))
    lies = [metres for number, metres in enumerate(off) if number in made.lies]
    truths = [metres for number, metres in enumerate(off) if number not in made.lies]
    assert lies
    assert max(truths) < 0.6
    assert min(lies) > max(truths)


def test_true_sightings_tie_every_robot_to_the_anchor(made):
    assert made.tied == set(made.fleet.maps) == {"r1", "r2", "r3", "r4"}


def test_one_seed_gives_one_fleet(made):
    again = simulate_fleet("home", 0, 4, lies=0.3)
    assert again.fleet.sightings == made.fleet.sightings
    assert again.lies == made.lies
    for name, grid in made.fleet.maps.items():
        assert np.array_equal(grid.cells, again.fleet.maps[name].cells)


def test_every_robot_was_where_its_map_knows_floor(made):
    for name, place in made.at.items():
        assert 0 <= made.fleet.maps[name].value_at(np.array(place)) < 50
