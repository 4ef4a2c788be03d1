"""What a tab holds, written down: a document, and the contents of files that it names by their hashes."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from functools import lru_cache, partial
from hashlib import sha256
from typing import Any, Generic, TypeVar
from weakref import WeakKeyDictionary

import msgspec

from algorithms.files.fleet_file import fleet_to_bytes
from algorithms.files.map_file import map_to_bytes
from algorithms.files.observation_file import known_to_bytes
from algorithms.fleets.pair_hypotheses import PairFinding
from algorithms.maps.grid_map import GridMap
from algorithms.methods.registry import METHODS
from algorithms.observations.pair_problem import Known
from app.model.fleet_state import FindingKey, FleetState
from app.model.merge_inputs import Files, MergeInputs, Upload
from app.model.settings import settings_of, value_at
from app.page.project import project_parts as parts
from app.page.undo.page_snapshot import PageSnapshot
from app.page.undo.undo_history import SavedTab, UndoStep
from app.system.version import version

Written = TypeVar("Written")
Read = TypeVar("Read")
Contents = dict[str, Callable[[], bytes]]

IMAGE = "map"  # what the image of each map is called in its YAML file
_DIGESTS: WeakKeyDictionary[GridMap, tuple[str, str]] = WeakKeyDictionary()  # each is worked out once


@dataclass(frozen=True, eq=False)
class Project:
    """document : JSON
    contents : of the images of maps, and of files that came, made by a call each; by their SHA-256
    """

    document: bytes
    contents: Contents


def project_of(saved: SavedTab) -> Project:
    """What a tab leaves behind, but for what can be worked out again: the same seed gives the same answer.

    Its comparisons and sweeps are left out.
    """
    return _Writer().project(saved)


def bounded_project(saved: SavedTab) -> Project:
    """The same; where its history would be too long to be read again, the step at hand alone."""
    project = project_of(saved)
    if len(project.document) <= parts.MOST_DOCUMENT:
        return project
    return project_of(replace(saved, steps=(saved.steps[saved.position],), position=0))


class _Table(Generic[Read, Written]):
    """What is written once each, and named by its place."""

    def __init__(self, write: Callable[[Read], Written]) -> None:
        self._write = write
        self._places: dict[int, int] = {}
        self.parts: list[Written] = []

    def place(self, value: Read, key: object = None) -> int:
        """``key``: what tells it from others; None: itself."""
        same = id(value if key is None else key)
        if same not in self._places:
            part = self._write(value)
            self._places[same] = len(self.parts)
            self.parts.append(part)
        return self._places[same]


class _Writer:
    def __init__(self) -> None:
        self._contents: Contents = {}
        self._maps = _Table(self._map)
        self._inputs, self._files = _Table(self._inputs_part), _Table(self._files_part)
        self._fleets, self._findings = _Table(self._fleet_part), _Table(self._finding_part)

    def project(self, saved: SavedTab) -> Project:
        steps = tuple(map(self._step, saved.steps))
        document = parts.ProjectPart(
            format=parts.FORMAT,
            mapmeld=version(),
            position=saved.position,
            steps=steps,
            inputs=tuple(self._inputs.parts),
            files=tuple(self._files.parts),
            fleets=tuple(self._fleets.parts),
            findings=tuple(self._findings.parts),
            maps=tuple(self._maps.parts),
            dark=saved.dark,
            speed=saved.speed,
        )
        return Project(msgspec.json.format(msgspec.json.encode(document), indent=1), self._contents)

    def _step(self, step: UndoStep) -> parts.StepPart:
        s: PageSnapshot = step.snapshot
        return parts.StepPart(
            label=step.label,
            inputs=self._inputs.place(s.inputs),
            files=self._files.place(s.files),
            method=s.method,
            settings=settings_by_name(s.method, s.config),
            seed=s.seed,
            goal=s.goal,
            hand=s.hand,
            taken=s.taken,
            fleet=None if s.fleet is None else self._fleets.place(s.fleet),
            export=s.export,
            corrections=s.corrections,
        )

    def _map(self, grid: GridMap) -> parts.MapPart:
        image = f"{IMAGE}.pgm"

        def content() -> bytes:
            return map_to_bytes(grid, IMAGE)[image]

        if grid not in _DIGESTS:
            files = map_to_bytes(grid, IMAGE)
            _DIGESTS[grid] = sha256(files[image]).hexdigest(), files[f"{IMAGE}.yaml"].decode()
        digest, text = _DIGESTS[grid]
        self._contents[digest] = content
        return parts.MapPart(digest, text, grid.name, grid.remarks, grid.files, grid.made)

    def _upload(self, upload: Upload) -> parts.UploadPart:
        self._contents[upload.digest] = partial(getattr, upload, "content")
        return parts.UploadPart(upload.name, upload.digest, upload.by_form, upload.folder, upload.modified)

    def _files_part(self, files: Files) -> parts.FilesPart:
        others = tuple(
            parts.OtherPart(
                other.name,
                other.told,
                other.used,
                None if other.upload is None else self._upload(other.upload),
                other.kind,
            )
            for other in files.others
        )
        uploads = {key: self._upload(upload) for key, upload in files.uploads.items()}
        return parts.FilesPart(files.sample, uploads, others)

    def _inputs_part(self, inputs: MergeInputs) -> parts.InputsPart:
        first, second = (
            parts.SlotPart(
                None if slot.grid is None else self._maps.place(slot.grid), slot.missing, slot.doubt
            )
            for slot in inputs.maps
        )
        read = None
        if inputs.read is not None:
            file, known = inputs.read
            read = parts.ReadPart(file, tuple(sorted(_texts(known))))
        return parts.InputsPart(
            (first, second),
            inputs.name,
            _texts(inputs.known),
            _texts(inputs.aside),
            inputs.choice,
            inputs.truth,
            inputs.names,
            read,
        )

    def _fleet_part(self, state: FleetState) -> parts.FleetPart:
        places = {name: str(self._maps.place(grid)) for name, grid in state.fleet.maps.items()}
        found = tuple(self._findings.place(item, item[1]) for item in state.found.items())
        return parts.FleetPart(
            fleet_to_bytes(state.fleet, places).decode(),
            state.name,
            tuple(sorted(state.hidden)),
            found,
            state.result is not None or state.again,
            state.opened,
        )

    def _finding_part(self, item: tuple[FindingKey, PairFinding]) -> parts.FindingPart:
        (ref, mov, known), found = item
        x, y = found.pivot.tolist()
        return parts.FindingPart(
            self._maps.place(ref),
            self._maps.place(mov),
            found.order,
            (x, y),
            found.reason,
            _texts(known),
            tuple(
                parts.HypothesisPart(
                    each.T_ref_mov,
                    tuple(map(tuple, each.covariance.tolist())),
                    each.probability,
                    each.weight,
                )
                for each in found.hypotheses
            ),
            found.accepted,
            found.accept_from,
            found.failed,
        )


@lru_cache(maxsize=256)  # those of a history are asked for at every step
def settings_by_name(method: str, config: Any) -> dict[str, Any]:
    """The settings that are not the method's defaults, by the names of their flags; options in words."""
    defaults = METHODS[method].defaults
    return {
        ".".join(each.path): getattr(each.default, "value", each.default)  # of an option its word
        for each in settings_of(config)
        if each.default != value_at(defaults, each.path)
    }


def _texts(known: Iterable[Known]) -> tuple[str, ...]:
    return tuple(known_to_bytes([one]).decode() for one in known)
