"""The sample pairs that ship with mapmeld, and how any number of others is written."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from itertools import permutations, product
from pathlib import Path

from algorithms.files.atomic_write import write_files
from algorithms.files.case_folder import FIRST_MAP_FILE, SECOND_MAP_FILE
from algorithms.files.map_file import map_to_bytes
from algorithms.files.observation_file import OBSERVATION_FILE, ROUGH_OBSERVATION_FILE, known_to_bytes
from algorithms.files.truth_file import TRUTH_FILE, Truth, truth_to_bytes
from algorithms.simulator.fleets.fleet_scenario import simulate_fleet
from algorithms.simulator.fleets.sample_fleets import fleet_files, sample_fleets
from algorithms.simulator.odometry_drift import OdometryDrift
from algorithms.simulator.poster_sample import POSTER_SAMPLE, poster_encounter, poster_files
from algorithms.simulator.robot import Conditions
from algorithms.simulator.scenario import Scenario, SimulatedCase, simulate
from algorithms.simulator.views.pictured_encounters import encounter_files
from algorithms.simulator.wrong_pairs import mismatch


@dataclass(frozen=True)
class Sample:
    """Three robots in one building that make one shipped case or two.

    overlaps : asked for, of R2 → R1 and R3 → R2
    pairs    : those that ship, as "OBSERVER_OBSERVED"
    bend     : of R1's map, as ``OdometryDrift`` has it
    title    : what the folders' names begin with; the kind unless given
    pictured : R2 → R1 ships with what R2's camera and laser saw
    """

    kind: str
    seed: int
    overlaps: tuple[float, float]
    pairs: tuple[str, ...] = ("r2_r1", "r3_r2")
    resolutions: tuple[float, float, float] = (0.05, 0.05, 0.05)
    both_ways: bool = False
    reach: float | None = None
    bend: float = 0.0
    title: str = ""
    pictured: bool = False

    @property
    def names(self) -> tuple[str, ...]:
        return tuple(f"{self.title or self.kind}_{pair}" for pair in self.pairs)

    def drives(self) -> Scenario:
        """Let the three robots drive."""
        first, second, third = self.resolutions
        conditions = (
            Conditions(OdometryDrift(bend=self.bend), resolution=first),
            Conditions(resolution=second),
            Conditions(resolution=third),
        )
        both_ways, reach = self.both_ways, self.reach
        return simulate(
            self.kind, self.seed, self.overlaps, both_ways=both_ways, reach=reach, conditions=conditions
        )

    def cases(self, made: Scenario | None = None) -> tuple[SimulatedCase, ...]:
        """The cases that ship; ``made``: of which drives, where they are made already."""
        made = made or self.drives()
        cases = made.cases
        if self.pictured:
            cases = (made.pictured_case(0, self.seed), *cases[1:])
        named = zip(self.names, cases, strict=False)
        return tuple(replace(case, name=name) for name, case in named)


SAMPLES = (
    # both robots saw one another; half of the smaller map is in the other, then one cross corridor alone
    Sample("office", 14, (0.5, 0.2), both_ways=True, pictured=True),
    # small rooms, all at right angles: four turns look right, one is
    Sample("apartment", 21, (0.6, 0.4), resolutions=(0.04, 0.05, 0.05), pictured=True),
    # the aisles nearly repeat, so a merge one rack too far looks good: only missing pallets tell them apart
    Sample("warehouse", 12, (0.3, 0.15)),
    # it looks alike turned by 180°; a twentieth shared is at the edge of what can be merged at all
    Sample("corridor", 30, (0.1, 0.04), reach=6.0, pictured=True),
    # robot 1 has bent it: no one transform lays the maps on each other everywhere
    Sample("apartment", 2, (0.7, 0.7), pairs=("r2_r1",), bend=1.0, title="bent"),
)


def case_files(case: SimulatedCase) -> dict[str, bytes]:
    """The files of a case folder by name. Equal cases give equal bytes."""
    truth = Truth(
        T_ref_mov=case.T_ref_mov,
        expected="refuse" if case.T_ref_mov is None else "merge",
        overlap=case.overlap,
        truth_rms=case.truth_rms,
        source=case.source,
        licence="MIT",
    )
    return {
        **map_to_bytes(case.ref, Path(FIRST_MAP_FILE).stem),
        **map_to_bytes(case.mov, Path(SECOND_MAP_FILE).stem),
        OBSERVATION_FILE: known_to_bytes(case.observations),
        ROUGH_OBSERVATION_FILE: known_to_bytes(case.rough),
        TRUTH_FILE: truth_to_bytes(truth),
        **encounter_files(case.encounters),
    }


def write_case(folder: Path, case: SimulatedCase) -> None:
    """Write a case into a folder, which is made where it is missing; raises OutputError."""
    write_files({Path(folder) / name: data for name, data in case_files(case).items()})


def regenerate(folder: Path) -> list[SimulatedCase]:
    """Make all shipped samples, fleets and the poster again, one folder each; the same bytes every time.

    JPEG files are as equal as the library is that writes them.
    """
    made = [sample.drives() for sample in SAMPLES]
    cases = [case for sample, drives in zip(SAMPLES, made, strict=True) for case in sample.cases(drives)]
    for case in cases:
        write_case(Path(folder) / case.name, case)
    deceived = {POSTER_SAMPLE: poster_files(poster_encounter(made[0], SAMPLES[0].seed))}
    for name, files in {**sample_fleets(cases[:2]), **deceived}.items():
        write_files({Path(folder) / name / file: data for file, data in files.items()})
    return cases


def generate_cases(
    kind: str, seeds: Iterable[int], folder: Path, overlap: float | None = None, sightings: int = 1
) -> list[Path]:
    """Write two cases per seed, in folders ``kind_SEED_r2_r1`` and ``kind_SEED_r3_r2``, with pictures."""
    folders = []
    for seed in seeds:
        for name, case in _named_cases(kind, seed, overlap, sightings, pictured=True):
            folders.append(Path(folder) / name)
            write_case(folders[-1], case)
    return folders


def generate_fleets(kind: str, seeds: Iterable[int], robots: int, folder: Path) -> Iterator[Path]:
    """Write a fleet of so many robots per seed, in folders ``KIND_SEED_fleet_N``."""
    for seed in seeds:
        path = Path(folder) / f"{kind}_{seed:04d}_fleet_{robots}"
        files = fleet_files(simulate_fleet(kind, seed, robots))
        write_files({path / name: data for name, data in files.items()})
        yield path


def generate_wrong_pairs(
    kinds: Iterable[str],
    seeds: Iterable[int],
    folder: Path,
    overlap: float | None = None,
    sightings: int = 1,
) -> Iterator[Path]:
    """Write every pairing of an observer with a robot that was observed in another building.

    The only right answer to each is to refuse. Folders are named ``wrong_OBSERVER_OBSERVED``; n buildings
    give 4·n·(n − 1) of them.
    """
    buildings = [_named_cases(kind, seed, overlap, sightings) for kind in kinds for seed in seeds]
    for here, there in permutations(buildings, 2):
        for (name, case), (other_name, other) in product(here, there):
            path = Path(folder) / f"wrong_{name}_{other_name}"
            write_case(path, mismatch(case, other))
            yield path


def _named_cases(
    kind: str, seed: int, overlap: float | None, sightings: int, pictured: bool = False
) -> list[tuple[str, SimulatedCase]]:
    made = simulate(kind, seed, overlap, sightings=sightings)
    cases = [made.pictured_case(n, seed) for n in range(len(made.cases))] if pictured else made.cases
    return [(f"{kind}_{seed:04d}_{case.name.split('_', 1)[1]}", case) for case in cases]
