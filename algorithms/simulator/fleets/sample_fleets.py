"""The sample fleets that ship with mapmeld: a chain, one with a lie and an island, and a loop."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from algorithms.files.case_folder import FIRST_MAP_FILE, SECOND_MAP_FILE
from algorithms.files.fleet_file import FLEET_FILE, fleet_to_bytes
from algorithms.files.fleet_truth_file import FleetTruth, fleet_truth_to_bytes
from algorithms.files.map_file import map_to_bytes
from algorithms.files.truth_file import TRUTH_FILE
from algorithms.observations.fleet import Fleet, FleetSighting
from algorithms.simulator.fleets.fleet_scenario import SimulatedFleet, simulate_fleet
from algorithms.simulator.scenario import SimulatedCase

VAGUE = 4.0, 1.5  # metres and radians; standard deviations of "somewhere over there"


def fleet_files(made: SimulatedFleet) -> dict[str, bytes]:
    """The files of a fleet's folder by name. Equal fleets give equal bytes."""
    names = list(made.fleet.maps)
    loose = [name for name in names if name not in made.tied]
    truth = FleetTruth(
        {name: T for name, T in made.T_anchor_robot.items() if name != made.fleet.anchor},
        made.at,
        _islands(made.fleet, loose),
        made.lies,
    )
    maps = [map_to_bytes(grid, name) for name, grid in made.fleet.maps.items()]
    return {
        **{name: data for files in maps for name, data in files.items()},
        FLEET_FILE: fleet_to_bytes(made.fleet, {name: f"{name}.yaml" for name in names}),
        TRUTH_FILE: fleet_truth_to_bytes(truth),
    }


def sample_fleets(office: Sequence[SimulatedCase]) -> dict[str, dict[str, bytes]]:
    """The files of all shipped fleets, by the names of their folders.

    office : the office's two sample cases, whose three robots are the paper's: R2 saw R1, R3 saw R2
    """
    return {
        "office_fleet_chain": _chain(office),
        # one sighting of r4 by r3 lies; r5 and r6 saw each other and nobody else
        "home_fleet_island": fleet_files(cut_off(simulate_fleet("home", 5, 6, lies=0.1), {"r5", "r6"})),
        # turned by 180° the corridor looks alike, and r1 saw r2 only vaguely: the way round by r3 decides
        "corridor_fleet_loop": fleet_files(vague(simulate_fleet("corridor", 37, 3, lies=0.0), ("r1", "r2"))),
    }


def cut_off(made: SimulatedFleet, island: set[str]) -> SimulatedFleet:
    """The same fleet without the sightings between these robots and the others."""
    f = made.fleet
    kept = [k for k, seen in enumerate(f.sightings) if (seen.observer in island) == (seen.observed in island)]
    sightings = tuple(f.sightings[k] for k in kept)
    lies = tuple(kept.index(lie) for lie in made.lies if lie in kept)
    tied = frozenset(made.tied - island)
    return replace(made, fleet=replace(f, sightings=sightings), lies=lies, tied=tied)


def vague(made: SimulatedFleet, pair: tuple[str, str]) -> SimulatedFleet:
    """The same fleet, in which the first of two robots is hardly sure of where it saw the second."""
    sightings = tuple(
        _vaguer(seen) if (seen.observer, seen.observed) == pair else seen for seen in made.fleet.sightings
    )
    return replace(made, fleet=replace(made.fleet, sightings=sightings))


def _vaguer(seen: FleetSighting) -> FleetSighting:
    sigma_range, sigma_bearing = VAGUE
    o = replace(seen.observation, sigma_range=sigma_range, sigma_bearing=sigma_bearing)
    return replace(seen, observation=o)


def _chain(office: Sequence[SimulatedCase]) -> dict[str, bytes]:
    """The office's three robots; its maps lie in the folders of its two cases."""
    first, second = office
    assert first.T_ref_mov is not None
    assert second.T_ref_mov is not None
    (seen_1, *_), (seen_2, *_) = first.observations, second.observations
    T_r1_r2 = first.T_ref_mov.inverse()
    T = {"r2": T_r1_r2, "r3": T_r1_r2 @ second.T_ref_mov.inverse()}
    sightings = FleetSighting("r2", "r1", seen_1), FleetSighting("r3", "r2", seen_2)
    fleet = Fleet({"r1": first.mov, "r2": first.ref, "r3": second.ref}, sightings)
    files = {
        "r1": f"../{first.name}/{SECOND_MAP_FILE}",
        "r2": f"../{first.name}/{FIRST_MAP_FILE}",
        "r3": f"../{second.name}/{FIRST_MAP_FILE}",
    }
    stood = {"r2": seen_1.observer.xy, "r3": seen_2.observer.xy}
    at = {name: (float(x), float(y)) for name, (x, y) in stood.items()}
    truth = FleetTruth(T, at, (), ())
    return {FLEET_FILE: fleet_to_bytes(fleet, files), TRUTH_FILE: fleet_truth_to_bytes(truth)}


def _islands(fleet: Fleet, loose: Sequence[str]) -> tuple[tuple[str, ...], ...]:
    """Robots that nothing ties to the anchor, those together that saw each other."""
    islands: list[set[str]] = [{name} for name in loose]
    for seen in fleet.sightings:
        both = [island for island in islands if {seen.observer, seen.observed} & island]
        if len(both) == 2:
            islands = [island for island in islands if island not in both] + [both[0] | both[1]]
    return tuple(tuple(sorted(island)) for island in islands)
