"""What one tab merges, and what keeps it from merging."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from algorithms.files.case_folder import Case
from algorithms.files.truth_file import Truth
from algorithms.maps.grid_map import GridMap, remarks_on
from algorithms.observations.observation import Encounter, Observation, encounters_of, name_of
from algorithms.observations.pair_problem import Known
from algorithms.observations.priors import Prior


@dataclass(frozen=True)
class Upload:
    """One file as the browser sent it, or made by a form; its name is never used as a path."""

    name: str
    content: bytes
    by_form: bool = False


@dataclass(frozen=True, eq=False)
class Files:
    """Where inputs came from: a sample by its name, or uploads by what they are for."""

    sample: str = ""
    uploads: Mapping[str, Upload] = field(default_factory=dict)


@dataclass(frozen=True, eq=False)
class MapSlot:
    """One robot's map, as far as its files are there.

    grid    : None while one of its files is missing
    missing : what to load next, as a sentence; "" where nothing is missing
    doubt   : what is odd about the files that were loaded, as a sentence; "" where nothing is
    """

    grid: GridMap | None = None
    missing: str = ""
    doubt: str = ""


@dataclass(frozen=True, eq=False)
class MergeInputs:
    """The maps of two robots and what robot 1 saw; empty for what is not there yet.

    maps         : by the numbers of the robots, from 1
    observations : one sighting or several
    priors       : what else is known
    name         : what to call the pair before a person
    truth        : the known answer of a sample
    """

    maps: tuple[MapSlot, ...] = (MapSlot(), MapSlot())
    observations: tuple[Observation, ...] = ()
    name: str = ""
    truth: Truth | None = None
    priors: tuple[Prior, ...] = ()

    @staticmethod
    def pair(
        ref: GridMap | None = None,
        mov: GridMap | None = None,
        observations: tuple[Observation, ...] = (),
        name: str = "",
        truth: Truth | None = None,
        priors: tuple[Prior, ...] = (),
    ) -> MergeInputs:
        """The inputs of two maps."""
        return MergeInputs((MapSlot(ref), MapSlot(mov)), observations, name, truth, priors)

    @property
    def ref(self) -> GridMap | None:
        """Map 1, in whose frame everything ends."""
        return self.maps[0].grid

    @property
    def mov(self) -> GridMap | None:
        """Map 2, which is moved."""
        return self.maps[1].grid

    @property
    def grids(self) -> tuple[GridMap, ...]:
        """The maps that are there."""
        return tuple(slot.grid for slot in self.maps if slot.grid is not None)

    @property
    def known(self) -> tuple[Known, ...]:
        """All that is known of how the maps lie."""
        return (*self.observations, *self.priors)

    @property
    def encounters(self) -> tuple[Encounter, ...]:
        """Where robot 2 was seen, in both maps; a place per sighting."""
        return encounters_of(self.observations, self.ref, self.mov)

    @property
    def at(self) -> Encounter | None:
        """Where robot 2 was seen first."""
        return self.encounters[0] if self.observations else None

    @property
    def complete(self) -> bool:
        """Whether there is all that a merge needs."""
        return len(self.grids) == len(self.maps) and bool(self.observations)

    def case(self) -> Case | None:
        """The same as a case; None where a merge lacks something."""
        if self.ref is None or self.mov is None or not self.observations:
            return None
        name = self.name or "your maps"
        return Case(name, self.ref, self.mov, self.observations, "", self.truth, self.priors)

    def same_pair(self, other: MergeInputs) -> bool:
        """Whether these are the very maps and sightings of others."""
        same = (a.grid is b.grid for a, b in zip(self.maps, other.maps, strict=True))
        return self.observations is other.observations and all(same)

    def missing(self) -> str:
        """What to load next, as a sentence; empty where nothing is missing."""
        for slot in self.maps:
            if slot.missing:
                return slot.missing
        here = [number for number, slot in enumerate(self.maps, 1) if slot.grid is not None]
        absent = [number for number, slot in enumerate(self.maps, 1) if slot.grid is None]
        if not here and self.observations:
            return "Now load the two maps: a YAML file and an image each."
        if not here:
            return "Choose a sample, or load two maps and an observation."
        if absent:
            return f"Map {here[0]} is here. Load map {absent[0]}, too."
        if not self.observations:
            return "Both maps are here. Load the observation, or place the robots: where robot 1 saw robot 2."
        return ""

    def doubt(self) -> str:
        """What is odd about the inputs, in sentences; empty where nothing is."""
        return " ".join(filter(None, (*(slot.doubt for slot in self.maps), *self.readings(), *self.doubts())))

    def readings(self) -> tuple[str, ...]:
        """What is odd about how the maps were read, in sentences."""
        return remarks_on(tuple(slot.grid for slot in self.maps))

    def doubts(self) -> tuple[str, ...]:
        """What is odd about each sighting, as a sentence; empty where nothing is."""
        return tuple(self._doubt(number) for number in range(1, len(self.observations) + 1))

    def _doubt(self, number: int) -> str:
        o = self.observations[number - 1]
        for robot, grid, point, key in (
            (1, self.ref, (o.observer.x, o.observer.y), "observer.pose"),
            (2, self.mov, (o.observed_x, o.observed_y), "observed.pose"),
        ):
            if grid is not None and not grid.contains(point):
                return (
                    f"Robot {robot} at ({point[0]:.2f}, {point[1]:.2f}) m is outside map {robot}. "
                    f"Check {key} in {name_of(number, self.observations)}."
                )
        return ""

    @staticmethod
    def of(case: Case) -> MergeInputs:
        """The inputs of a case folder."""
        return MergeInputs.pair(case.ref, case.mov, case.observations, case.name, case.truth, case.priors)
