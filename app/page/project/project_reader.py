"""A project's document read back, with the contents of the files that it names; nothing in it is trusted."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from hashlib import sha256
from typing import Any, TypeVar

import msgspec
import numpy as np

from algorithms.common.display_text import show_hidden
from algorithms.common.errors import InputFileError, SettingError, TooLargeError
from algorithms.common.robot_names import UNNAMED, RobotNames
from algorithms.common.source_file import SourceFile
from algorithms.files.fleet_archive import MOST_CELLS
from algorithms.files.fleet_file import fleet_from_bytes
from algorithms.files.map_file import map_from_bytes
from algorithms.files.observation_file import known_from_bytes
from algorithms.fleets.pair_hypotheses import Hypothesis, PairFinding, PairOrder
from algorithms.maps.grid_map import COARSEST, FINEST, GridMap
from algorithms.methods.registry import METHODS
from algorithms.observations.fleet import Fleet
from algorithms.observations.observation import Observation
from algorithms.observations.pair_problem import Known
from app.evaluation.sweep.sweep_axes import setting_named
from app.model.fleet_state import FindingKey, FleetState
from app.model.merge_inputs import Files, MapSlot, MergeInputs, OtherFile, Upload
from app.model.settings import with_value
from app.page.project import project_parts as parts
from app.page.undo.page_snapshot import PageSnapshot
from app.page.undo.undo_history import SavedTab, UndoStep
from app.report.export_frame import ExportFrame
from app.system.cancellation import Check, never_cancelled

T = TypeVar("T")
PGM = b"P5"  # how the images begin that are written here
ANEW = "save the project anew"


def saved_tab(
    source: str, document: bytes, content: Callable[[str], bytes | None], check: Check = never_cancelled
) -> SavedTab:
    """What ``project_of`` wrote down.

    source  : what the project is called before a person
    content : of a file, by its SHA-256; None: it is not there
    check   : is called now and then, and may leave the work by raising
    raises  : InputFileError, TooLargeError
    """
    if len(document) > parts.MOST_DOCUMENT:
        raise TooLargeError(f"{source}: its document has more than {parts.MOST_DOCUMENT / 1e6:.0f} MB")
    try:
        head = msgspec.json.decode(document, type=parts.Head)
        if head.format != parts.FORMAT:
            found = f"is of format {head.format}, which mapmeld {show_hidden(head.mapmeld)} wrote"
            raise InputFileError(source, found, f"open it with that version; this one reads {parts.FORMAT}")
        project = msgspec.json.decode(document, type=parts.ProjectPart)
    except (msgspec.MsgspecError, UnicodeDecodeError, RecursionError) as error:
        raise InputFileError(source, f"is no project that can be read ({error})", ANEW) from error
    except SettingError as error:  # a value of ours that cannot be so
        raise InputFileError(source, f"cannot be used: {error}", ANEW) from error
    return _Reader(source, project, content, check).saved()


class _Reader:
    def __init__(
        self,
        source: str,
        project: parts.ProjectPart,
        content: Callable[[str], bytes | None],
        check: Check,
    ) -> None:
        self._source, self._project, self._content, self._check = source, project, content, check
        self._contents: dict[str, bytes] = {}
        self._cells = 0

    def saved(self) -> SavedTab:
        p = self._project
        try:
            self._maps = [self._map(part) for part in p.maps]
            self._findings = [self._finding(part) for part in p.findings]
            self._inputs = [self._inputs_of(part) for part in p.inputs]
            self._files = [self._files_of(part) for part in p.files]
            self._fleets = [self._fleet(part) for part in p.fleets]
            steps = tuple(UndoStep(show_hidden(step.label), self._snapshot(step)) for step in p.steps)
        except SettingError as error:
            raise self._wrong(f"cannot be used: {error}") from error
        self._one(p.steps, p.position, "step")
        return SavedTab(steps, p.position, p.dark, p.speed)

    def _wrong(self, found: str) -> InputFileError:
        return InputFileError(self._source, found, ANEW)

    def _one(self, of: Sequence[T], place: int, what: str) -> T:
        if place >= len(of):
            raise self._wrong(f"names {what} {place}, which is not there")
        return of[place]

    def _bytes(self, digest: str) -> bytes:
        """The content of a file, which is what it was."""
        if digest not in self._contents:
            self._check()
            content = self._content(digest)
            if content is None:
                raise self._wrong(f"lacks the file {digest[:12]}…")
            if sha256(content).hexdigest() != digest:
                raise self._wrong(f"holds a file {digest[:12]}… that has changed")
            self._contents[digest] = content
        return self._contents[digest]

    def _map(self, part: parts.MapPart) -> GridMap:
        self._check()
        image = self._bytes(part.image)
        if not image.startswith(PGM):  # others unpack to more than the zip does
            raise self._wrong(f"names the file {part.image[:12]}… for the image of a map, which it is not")
        grid = map_from_bytes(f"{self._source}: a map", part.text.encode(), part.name, image)
        self._cells += grid.cells.size
        if self._cells > 2 * MOST_CELLS:
            raise TooLargeError(f"{self._source}: its maps have more than {2 * MOST_CELLS:,} cells together")
        remarks = tuple(map(show_hidden, part.remarks))
        files = tuple(SourceFile(show_hidden(file.name), file.sha256) for file in part.files)
        return replace(
            grid, name=show_hidden(part.name) or "map", remarks=remarks, files=files, made=part.made
        )

    def _known(self, texts: Sequence[str]) -> tuple[Known, ...]:
        known: list[Known] = []
        for text in texts:
            self._check()
            known += known_from_bytes(f"{self._source}: what is known", text.encode())
        return tuple(known)

    def _inputs_of(self, part: parts.InputsPart) -> MergeInputs:
        known, names = self._known(part.known), RobotNames.of(part.names.ref, part.names.mov)
        slots = tuple(
            MapSlot(
                None if slot.map is None else self._one(self._maps, slot.map, "map"), slot.missing, slot.doubt
            )
            for slot in part.maps
        )
        read = None
        if part.read is not None:
            read = part.read.file, frozenset(self._known(part.read.known))
        return MergeInputs(
            slots,
            tuple(one for one in known if isinstance(one, Observation)),
            show_hidden(part.name),
            part.truth,
            tuple(one for one in known if not isinstance(one, Observation)),
            part.choice,
            self._known(part.aside),
            names if names != UNNAMED else UNNAMED,  # the one that documents leave out
            read,
        )

    def _upload(self, part: parts.UploadPart) -> Upload:
        name, folder = show_hidden(part.name), show_hidden(part.folder)
        return Upload(name, self._bytes(part.content), part.by_form, folder, part.modified)

    def _files_of(self, part: parts.FilesPart) -> Files:
        others = tuple(
            OtherFile(
                show_hidden(other.name),
                show_hidden(other.told),
                other.used,
                None if other.upload is None else self._upload(other.upload),
                other.kind,
            )
            for other in part.others
        )
        uploads = {key: self._upload(upload) for key, upload in part.uploads.items()}
        return Files(show_hidden(part.sample), uploads, others)

    def _finding(self, part: parts.FindingPart) -> tuple[FindingKey, PairFinding]:
        maps = (self._one(self._maps, place, "map") for place in (part.ref, part.mov))
        hypotheses = tuple(
            Hypothesis(each.T_ref_mov, np.array(each.covariance), each.probability, each.weight)
            for each in part.hypotheses
        )
        finding = PairFinding(
            part.order,
            np.array(part.pivot),
            hypotheses,
            show_hidden(part.reason),
            part.accepted,
            part.accept_from,
            part.failed,
        )
        ref, mov = maps
        return (ref, mov, self._known(part.known)), finding

    def _fleet(self, part: parts.FleetPart) -> FleetState:
        def read(name: str) -> GridMap:
            if not name.isdecimal():
                raise self._wrong(f"names {name} for a map")
            return self._one(self._maps, int(name), "map")

        fleet = fleet_from_bytes(f"{self._source}: a fleet", part.text.encode(), read)
        found = [self._one(self._findings, place, "finding") for place in part.findings]
        for order in (part.opened, *(finding.order for _, finding in found)):
            if order is not None:
                self._check_order(fleet, order)
        hidden = frozenset(part.hidden) & set(fleet.maps)
        name = show_hidden(part.name)
        return FleetState(fleet, name, hidden, dict(found), None, part.opened, again=part.merged)

    def _check_order(self, fleet: Fleet, order: PairOrder) -> None:
        there = all(0 <= number < len(fleet.sightings) for number in order.sightings)
        if not (there and order.ref in fleet.maps and order.mov in fleet.maps):
            raise self._wrong("names a pair of robots that is not in its fleet")

    def _snapshot(self, step: parts.StepPart) -> PageSnapshot:
        if step.method not in METHODS:
            raise self._wrong(f"merges by {show_hidden(step.method)}, a method that there is not")
        if step.hand is not None:
            ExportFrame(step.hand)  # it lies where a frame may lie
        cells = step.export.resolution
        if cells is not None and not FINEST <= cells <= COARSEST:
            raise self._wrong(f"gives the merged map away in cells of {cells:g} m")
        return PageSnapshot(
            self._one(self._inputs, step.inputs, "inputs"),
            self._one(self._files, step.files, "files"),
            step.method,
            config_with(step.method, step.settings),
            step.seed,
            step.goal,
            step.hand,
            fleet=None if step.fleet is None else self._one(self._fleets, step.fleet, "fleet"),
            export=step.export,
            taken=step.taken,
            corrections=step.corrections,
        )


def config_with(method: str, settings: Mapping[str, Any]) -> Any:
    """The method's defaults but for these settings, options in words; raises SettingError."""
    config = METHODS[method].defaults
    for name, given in settings.items():
        setting = setting_named(name, config)
        value = setting.options.get(str(given)) if setting.choices is not None else given
        whole = isinstance(value, int) and not isinstance(value, bool)
        fits = {
            bool: isinstance(value, bool),
            int: whole,
            float: whole or isinstance(value, float),
        }
        kind = int if setting.whole else float if setting.bounds is not None else bool
        if value is None or (setting.choices is None and not fits[kind]):
            raise SettingError(f"{name} is {show_hidden(str(given))}, which it cannot be")
        config = with_value(config, setting.path, value)
    return config
