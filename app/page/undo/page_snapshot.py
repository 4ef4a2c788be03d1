"""All that a person has on the page, as one value: what undo goes back to, and what a reload brings back."""

from __future__ import annotations

from collections.abc import Hashable
from dataclasses import dataclass, field, replace
from typing import Any

from algorithms.common.pose import Pose2
from algorithms.maps.map_corrections import NO_CORRECTIONS, Corrections
from algorithms.methods.merge_result import MergeResult
from algorithms.methods.registry import METHODS
from app.model.fleet_state import FleetState
from app.model.knowledge import CHOICES
from app.model.merge_inputs import Files, MergeInputs
from app.model.merge_job import Goal
from app.model.run_state import RunState
from app.model.settings import settings_of, text_for, value_at
from app.page.research.other_result import OtherResult
from app.report.correction_text import step_label
from app.report.export_frame import AS_MERGED, ExportFrame


@dataclass(frozen=True, eq=False)
class PageSnapshot:
    """One state of the page; nothing in it is ever changed.

    files   : what the folder "Maps" says of where the inputs came from
    method, config, seed : how to merge
    goal    : how far it was asked for; None: nothing was asked for yet
    hand    : where map 2 was put by hand, T_ref_mov; None where a method says it
    taken   : by what a person took that for the answer, BY_HAND or CHOSEN; "" where they did not
    outcome : of the run that came to its end with all this; None before
    other   : another method's answer that is looked at in its place
    fleet   : the fleet that is shown, or of which a pair is
    export  : in which frame and cells the merged map is given away
    corrections : what was corrected in it
    """

    inputs: MergeInputs
    files: Files
    method: str
    config: Any
    seed: int
    goal: Goal | None = None
    hand: Pose2 | None = None
    outcome: RunState | None = field(default=None, repr=False)
    other: OtherResult | None = None
    fleet: FleetState | None = None
    export: ExportFrame = AS_MERGED
    taken: str = ""
    corrections: Corrections = NO_CORRECTIONS

    @property
    def held(self) -> bool:
        """Whether map 2 is in a person's hand: it was put somewhere, and is not the answer yet."""
        return self.hand is not None and self.outcome is None and not self.taken

    @property
    def result(self) -> MergeResult | None:
        """The answer; None where there is none (yet)."""
        return self.outcome.get(MergeResult) if self.outcome is not None else None

    def same_request(self, other: PageSnapshot) -> bool:
        """Whether both ask for the same, whatever came of it."""
        return not change(self, other)[0] and self.goal == other.goal

    def without_outcome(self) -> PageSnapshot:
        """The same, to be worked out again when it is needed: the same seed gives the same answer."""
        return replace(self, outcome=None)

    def held_bytes(self) -> dict[int, int]:
        """Bytes by the identity of what holds them, so that what two snapshots share counts once."""
        held: list[Any] = [grid.cells for grid in self.inputs.grids]
        if self.fleet is not None:
            held += [grid.cells for grid in self.fleet.fleet.maps.values()]
            held += [island.fusion.merged.cells for island in self.fleet.islands]
        held += [upload.content for upload in self.files.uploads.values()]
        held += [other.upload.content for other in self.files.others if other.upload is not None]
        if self.result is not None:
            fusion = self.result.fusion
            held += [fusion.merged.cells, fusion.ref_cells, fusion.mov_cells]
        return {id(each): memoryview(each).nbytes for each in held}


def change(before: PageSnapshot, after: PageSnapshot) -> tuple[str, Hashable]:
    """What a person did between two snapshots, and what more of the same is called; "" for nothing."""
    old, new = before.inputs, after.inputs
    if before.fleet is not after.fleet and (before.fleet is None or after.fleet is None):
        return "another fleet" if after.fleet is not None else f"load {new.name}", None
    if old is not new:
        if old.grids == new.grids:
            if old.names != new.names:
                return f"names: {new.names.ref}, {new.names.mov}", "names"
            read = new.files.get("observation")
            if read and read != old.files.get("observation"):
                return f"what is known from {read[0].name}", None
            if old.choice != new.choice:
                return f"known: {CHOICES[new.choice]}", None
            if old.observations == new.observations:
                return f"{CHOICES[new.choice]} by hand", "prior"
            count = len(new.observations)
            said = "observation by hand" if count == 1 else f"{count} observations by hand"
            return (said if count else "no observation"), "observation"
        return (f"load {new.name}" if new.name else "forget the files"), None
    if before.method != after.method:
        return f"method: {METHODS[after.method].title}", None
    if before.config != after.config:
        return _moved(before.config, after.config)
    if before.seed != after.seed:
        return f"seed {before.seed} → {after.seed}", "seed"
    if before.hand != after.hand:
        return (new.names.told("map 2 by hand") if after.hand is not None else "not by hand"), "hand"
    if before.corrections != after.corrections:
        return new.names.told(step_label(before.corrections, after.corrections)), None
    if before.export != after.export:
        return new.names.told(f"export: {after.export.how}"), "export"
    if before.other is not after.other:
        return (f"look at {after.other.title}" if after.other is not None else "back to one's own"), None
    return "", None


def _moved(before: Any, after: Any) -> tuple[str, Hashable]:
    moved = [s for s in settings_of(after) if value_at(before, s.path) != value_at(after, s.path)]
    if len(moved) != 1:
        return f"{len(moved)} settings", None
    (setting,) = moved
    shown = [text_for(setting, value_at(config, setting.path), "on", "off") for config in (before, after)]
    unit = f" {setting.bounds.unit}" if setting.bounds and setting.bounds.unit else ""
    label = setting.label.removesuffix(f"({unit.strip()})").strip()
    return f"{label} {shown[0]} → {shown[1]}{unit}", setting.path
