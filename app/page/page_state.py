"""What is on one tab of the page, and the locks under which it changes."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from threading import RLock
from typing import Any, Literal

from algorithms.common.pose import Pose2
from algorithms.maps.map_corrections import NO_CORRECTIONS, Corrections
from algorithms.methods.merge_result import MergeResult
from algorithms.methods.registry import DEFAULT_METHOD, METHODS
from algorithms.verdict.contradictions import Contradictions
from app.drawing.palette import LIGHT, Palette
from app.model.fleet_state import FleetState
from app.model.merge_inputs import Files, MergeInputs
from app.model.merge_job import Goal, MergeJob
from app.model.run_state import RunState
from app.model.view_modes import MAP
from app.page.research.other_result import OtherResult
from app.page.undo.page_snapshot import PageSnapshot
from app.report.export_frame import AS_MERGED, ExportFrame
from app.report.result_files import ResultFiles

Topic = Literal["setup", "result", "other", "palette", "fleet", "export", "corrections"]
"""What can be subscribed to: inputs or settings; the result; what is looked at in its place; and so on."""

TOPICS: dict[str, Topic] = {
    "inputs": "setup",
    "method": "setup",
    "config": "setup",
    "seed": "setup",
    "result": "result",
    "other": "other",
    "palette": "palette",
    "fleet": "fleet",
    "export": "export",
    "corrections": "corrections",
}


class TabLocks:
    """Both locks of a tab, always taken in this order.

    action  : one action of a person is carried out after another
    drawing : who draws holds it, so that nothing of a run is drawn after Stop
    """

    def __init__(self) -> None:
        self.action, self.drawing = RLock(), RLock()


@dataclass(eq=False)
class PageState:
    """One tab. Only controllers change it, with ``update``.

    inputs, files : what is loaded, and where it came from
    method, config, seed : how to merge
    goal          : how far the method was asked for; None: not at all
    run           : the run that is drawn
    search        : the last run whose answer was not made by hand; None before
    result, result_config, contradictions : of the last run that came to its end
    hand          : T_ref_mov of map 2 while a person holds it
    other         : another method's result that is looked at
    fleet         : the fleet that the page shows, or of which it shows a pair; None: there is none
    export        : in which frame and cells the merged map is given away
    corrections   : what was corrected in it
    research      : settings, stages and comparisons are shown, and not only what operators need
    closed        : the tab is gone
    """

    inputs: MergeInputs = field(default_factory=MergeInputs)
    files: Files = field(default_factory=Files)
    method: str = DEFAULT_METHOD
    config: Any = METHODS[DEFAULT_METHOD].defaults
    seed: int = 0
    goal: Goal | None = None
    run: RunState = field(default_factory=RunState)
    search: RunState | None = None
    result: MergeResult | None = None
    result_config: Any = None
    contradictions: Contradictions | None = None
    hand: Pose2 | None = None
    other: OtherResult | None = None
    fleet: FleetState | None = None
    export: ExportFrame = AS_MERGED
    corrections: Corrections = NO_CORRECTIONS
    view: str = MAP
    research: bool = False
    palette: Palette = LIGHT
    closed: bool = False
    locks: TabLocks = field(default_factory=TabLocks)
    _callbacks: dict[Topic, list[Callable[[], None]]] = field(default_factory=dict)

    def subscribe(self, topic: Topic, callback: Callable[[], None]) -> None:
        """Call back after every change of that kind."""
        self._callbacks.setdefault(topic, []).append(callback)

    def update(self, **changes: Any) -> None:
        """Set these attributes, then call back who subscribed to them."""
        topics = {TOPICS[name] for name in changes if name in TOPICS}
        for name, value in changes.items():
            setattr(self, name, value)
        for topic in sorted(topics):
            for callback in self._callbacks.get(topic, ()):
                callback()

    def turn_to_map(self) -> bool:
        """Choose the map as the view; whether it was another one."""
        other, self.view = self.view != MAP, MAP
        return other

    def snapshot(self) -> PageSnapshot:
        """What a person has set, before anything has come of it."""
        return PageSnapshot(
            self.inputs,
            self.files,
            self.method,
            self.config,
            self.seed,
            self.goal,
            self.hand,
            fleet=self.fleet,
            export=self.export,
            corrections=self.corrections,
        )

    def files_of(self, result: MergeResult) -> ResultFiles:
        """What can be taken away of a result, as it is set now."""
        return ResultFiles(result, self.inputs, self.result_config, self.export, self.corrections)

    def job(self, **how: Any) -> MergeJob | None:
        """A run as it is set now; None where an input is missing."""
        i = self.inputs
        if i.ref is None or i.mov is None or not i.complete:
            return None
        return MergeJob(i.ref, i.mov, i.known, self.config, self.method, self.seed, **how)

    def config_for(self, method: str) -> Any:
        """The settings that a method would run with: of the chosen one as set, of others the defaults."""
        return self.config if method == self.method else METHODS[method].defaults
