"""What one tab merges, and what keeps it from merging."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property

from algorithms.common.robot_names import UNNAMED, RobotNames
from algorithms.common.source_file import SourceFile
from algorithms.files.case_folder import Case
from algorithms.files.map_file import MapMeta, parse_meta
from algorithms.files.truth_file import Truth
from algorithms.maps.grid_map import GridMap, remarks_on
from algorithms.observations.observation import Encounter, Observation, encounters_of, name_of
from algorithms.observations.pair_problem import Known
from algorithms.observations.priors import Prior
from app.model.knowledge import PRIORS, Choice, choice_of, kind_of, used

TO_PLACE: dict[Choice, str] = {
    "sighting": "Place the robots: where robot 1 saw robot 2. Or choose what else you know, or nothing.",
    "initial": "Drag map 2 to where it lies, roughly. Or choose what else you know, or nothing.",
    "turn": "Turn map 2 as it lies, roughly. Or choose what else you know, or nothing.",
    "near": "Drag each ring to the place that both maps show. Or choose what else you know, or nothing.",
}
"""What is to be done where a kind of knowledge is chosen that is not there yet."""


@dataclass(frozen=True)
class Upload:
    """One file as the browser sent it, or made by a form.

    name, folder : where it was, as it is shown; never used as a path
    modified     : when it was last written; seconds since 1970, None where that is not known
    """

    name: str
    content: bytes
    by_form: bool = False
    folder: str = ""
    modified: float | None = None

    @property
    def path(self) -> str:
        return f"{self.folder}/{self.name}" if self.folder else self.name

    @cached_property
    def digest(self) -> str:
        """The SHA-256 of its content."""
        return SourceFile.of(self.name, self.content).sha256

    @cached_property
    def meta(self) -> MapMeta:
        """What it says as a map's YAML file; raises InputFileError."""
        return parse_meta(self.name, self.content)


@dataclass(frozen=True, eq=False)
class OtherFile:
    """A file of which nothing stands on the page of two maps.

    told   : what was made of it, or why nothing was
    used   : whether anything was
    upload : the file itself where something may be made of it yet; None: there is but this word of it
    kind   : what it is where there is the file itself, one of ``file_kinds.KINDS``
    """

    name: str
    told: str
    used: bool = False
    upload: Upload | None = None
    kind: str = ""


@dataclass(frozen=True, eq=False)
class Files:
    """Where inputs came from: a sample by its name, or uploads by what they are for; and further files."""

    sample: str = ""
    uploads: Mapping[str, Upload] = field(default_factory=dict)
    others: tuple[OtherFile, ...] = ()


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
    """The maps of two robots and what is known of how they lie; empty for what is not there yet.

    maps         : by the numbers of the robots, from 1
    observations : one sighting or several
    priors       : what else is known
    name         : what to call the pair before a person
    truth        : the known answer of a sample
    choice       : which kind of knowledge is to be used
    aside        : what is known beside, and not used
    names        : what the two robots are called; what these inputs say is on robot 1 and robot 2
    read         : a file of what is known, and all that stood in it; None: there was none
    """

    maps: tuple[MapSlot, ...] = (MapSlot(), MapSlot())
    observations: tuple[Observation, ...] = ()
    name: str = ""
    truth: Truth | None = None
    priors: tuple[Prior, ...] = ()
    choice: Choice = "nothing"
    aside: tuple[Known, ...] = ()
    names: RobotNames = UNNAMED
    read: tuple[SourceFile, frozenset[Known]] | None = None

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
        inputs = MergeInputs((MapSlot(ref), MapSlot(mov)), name=name, truth=truth)
        return inputs.knowing((*observations, *priors))

    def knowing(self, known: Sequence[Known], choice: Choice | None = None) -> MergeInputs:
        """The same maps with other knowledge, of which a choice is used; None: all of it."""
        choice = choice_of(known) if choice is None else choice
        taken = used(known, choice)
        seen = tuple(one for one in taken if isinstance(one, Observation))
        priors = tuple(one for one in taken if not isinstance(one, Observation))
        aside = tuple(one for one in known if one not in taken)
        return replace(self, observations=seen, priors=priors, choice=choice, aside=aside)

    def named_as(self, before: MergeInputs) -> MergeInputs:
        """The same under the names that there were, as long as a map of theirs stays, or none had come."""
        pairs = zip(self.maps, before.maps, strict=True)
        stays = not before.grids or any(now.grid is not None and now.grid is old.grid for now, old in pairs)
        return replace(self, names=before.names) if stays and self.names == UNNAMED else self

    def read_from(self, file: SourceFile) -> MergeInputs:
        """The same, where that file is what all that is known was read from."""
        return replace(self, read=(file, frozenset(self.pool)))

    @property
    def files(self) -> dict[str, tuple[SourceFile, ...]]:
        """What was read, by map1, map2 and observation: that one as long as nothing of it was changed."""
        files = {f"map{number}": grid.files for number, grid in enumerate((self.ref, self.mov), 1) if grid}
        if self.read is not None and self.read[1] == frozenset(self.pool):
            files["observation"] = (self.read[0],)
        return {what: read for what, read in files.items() if read}

    @property
    def title(self) -> str:
        """What to call it before a person: its name, and with robots that have names what they did."""
        said = f"{self.names.ref} {'saw' if self.observations else 'and'} {self.names.mov}"
        if self.names == UNNAMED or said == self.name:
            return self.name
        return f"{self.name}: {said}" if self.name else said

    @property
    def pool(self) -> tuple[Known, ...]:
        """All that is known, used or not."""
        return (*self.known, *self.aside)

    @property
    def mixed(self) -> bool:
        """Whether more than one kind of thing is known."""
        return len({kind_of(one) for one in self.pool}) > 1

    @property
    def chosen_prior(self) -> Prior | None:
        """What is used where a single rough thing was chosen."""
        return self.priors[0] if self.priors and self.choice in PRIORS else None

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
        """All that is to be used of what is known of how the maps lie."""
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
        """Whether there is all that a merge needs: both maps, and of what is to be used something."""
        return len(self.grids) == len(self.maps) and (self.choice == "nothing" or bool(self.known))

    @property
    def sighted(self) -> bool:
        """Whether there is all that a method needs that cannot do without a sighting."""
        return self.complete and bool(self.observations)

    def case(self) -> Case | None:
        """The same as a case; None where a merge lacks something."""
        if self.ref is None or self.mov is None or not self.complete:
            return None
        name = self.name or "your maps"
        return Case(name, self.ref, self.mov, self.observations, "", self.truth, self.priors)

    def same_pair(self, other: MergeInputs) -> bool:
        """Whether these are the very maps of others, and the same is known of them."""
        same = (a.grid is b.grid for a, b in zip(self.maps, other.maps, strict=True))
        return self.known == other.known and all(same)

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
            return "Choose a sample, or load two maps and what is known of them."
        if absent:
            return f"Map {here[0]} is here. Load map {absent[0]}, too."
        return "" if self.complete else TO_PLACE[self.choice]

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
        pair = MergeInputs.pair(case.ref, case.mov, case.observations, case.name, case.truth, case.priors)
        return pair if case.read_from is None else pair.read_from(case.read_from)
