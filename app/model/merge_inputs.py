"""What one tab merges, and what keeps it from merging."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from algorithms.files.case_folder import Case
from algorithms.files.truth_file import Truth
from algorithms.maps.grid_map import GridMap, remarks_on
from algorithms.observations.observation import Encounter, Observation, encounters_of, name_of


@dataclass(frozen=True)
class Upload:
    """One file as the browser sent it; its name is never used as a path.

    by_form : it was not sent but made of what a person filled in
    """

    name: str
    content: bytes
    by_form: bool = False


@dataclass(frozen=True, eq=False)
class Files:
    """Where inputs came from.

    sample  : name of the sample; "" where they are uploads
    uploads : files by what they are for
    """

    sample: str = ""
    uploads: Mapping[str, Upload] = field(default_factory=dict)


@dataclass(frozen=True, eq=False)
class MergeInputs:
    """Two maps and what robot 1 saw; None or empty for what is not there yet.

    observations : one sighting or several
    name         : what to call the pair before a person
    truth        : the known answer of a sample
    bare         : numbers of the maps whose image is there, and nothing that says what it shows
    imageless    : numbers of the maps whose YAML file is there, and the image it names is not
    unnamed      : a sentence for each YAML file that names another image than the one that was loaded
    """

    ref: GridMap | None = None
    mov: GridMap | None = None
    observations: tuple[Observation, ...] = ()
    name: str = ""
    truth: Truth | None = None
    bare: tuple[int, ...] = ()
    imageless: Mapping[int, str] = field(default_factory=dict)
    unnamed: tuple[str, ...] = ()

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
        return self.ref is not None and self.mov is not None and bool(self.observations)

    def case(self) -> Case | None:
        """The same as a case; None where a merge lacks something."""
        if self.ref is None or self.mov is None or not self.observations:
            return None
        return Case(self.name or "your maps", self.ref, self.mov, self.observations, "", self.truth)

    def same_pair(self, other: MergeInputs) -> bool:
        """Whether these are the very maps and sightings of others."""
        mine, theirs = (self.ref, self.mov, self.observations), (other.ref, other.mov, other.observations)
        return all(a is b for a, b in zip(mine, theirs, strict=True))

    def missing(self) -> str:
        """What to load next, as a sentence; empty where nothing is missing."""
        if self.bare:
            return (
                f"Map {self.bare[0]}'s image has no YAML file yet: load it, or fill in the form below the "
                "image and press “Use this map”."
            )
        if self.imageless:
            number, image = next(iter(self.imageless.items()))
            return f"Map {number}'s YAML file is here. Load its image, too: {image}."
        if self.ref is None and self.mov is None:
            if not self.observations:
                return "Choose a sample, or load two maps and an observation."
            return "Now load the two maps: a YAML file and an image each."
        if self.ref is None or self.mov is None:
            return (
                f"Map {1 if self.mov is None else 2} is here. Load map {2 if self.mov is None else 1}, too."
            )
        if not self.observations:
            return "Both maps are here. Load the observation, or place the robots: where robot 1 saw robot 2."
        return ""

    def doubt(self) -> str:
        """What is odd about the inputs, in sentences; empty where nothing is."""
        return " ".join(filter(None, (*self.unnamed, *self.readings(), *self.doubts())))

    def readings(self) -> tuple[str, ...]:
        """What is odd about how the maps were read, in sentences."""
        return remarks_on((self.ref, self.mov))

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
        return MergeInputs(case.ref, case.mov, case.observations, case.name, case.truth)
