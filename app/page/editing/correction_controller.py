"""The merged map is corrected: by rules, in the list of contradictions, and with tools on the map."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import Any, get_args

import numpy as np

from algorithms.common.errors import SettingError
from algorithms.maps.grid_map import GridMap
from algorithms.maps.map_corrections import (
    MOST_POINTS,
    NO_CORRECTIONS,
    Corrections,
    Does,
    Edit,
    Point,
    ghosts,
)
from algorithms.maps.map_fusion import ConflictRule
from app.drawing.scene.map_layers import Mode as Comparison
from app.page.editing.correction_panel import Tool
from app.page.modes import Mode
from app.page.tab import Tab
from app.page.undo.page_snapshot import PageSnapshot
from app.report.correction_text import said, why
from app.report.result_files import ResultFiles
from app.web.browser_events import Numbers

TOOLS: tuple[Tool, ...] = get_args(Tool)
CHOICES: tuple[Does, ...] = ("map1", "map2", "unknown")
ASKED: dict[Tool, str] = {
    "brush": "Drag over what is to become floor. The wheel zooms; Esc ends it.",
    "box": "Drag from corner to corner: every wall between becomes floor. Esc ends it.",
    "line": "Drag along what no robot may cross. Esc ends it.",
}


class CorrectionController:
    """Of one tab; ``compare``: looks at both maps in another way."""

    def __init__(self, tab: Tab, compare: Callable[[Comparison], None]) -> None:
        self._state, self._display, self._modes = tab.state, tab.display, tab.modes
        self._history, self._notices, self._locks = tab.history, tab.notices, tab.state.locks
        self._panel, self._export, self._messages = (
            tab.panels.correction,
            tab.panels.export,
            tab.display.messages,
        )
        self._compare = compare
        self._tool: Tool | None = None  # that is taken up
        self._before: dict[str, Any] = {}  # the words above the map
        self._mode = tab.modes.add(Mode(self._end, resume=self._resume))
        later = tab.events.then  # in a thread of their own: a large map takes a while
        self._panel.connect(
            partial(later, self._choose_rule),
            partial(later, self._toggle),
            partial(later, self._hold),
            partial(later, self._clear_robots),
            partial(later, self._crop),
            partial(later, self._set, NO_CORRECTIONS),
        )
        tab.display.views.map.ground.corrected = self._grid
        points = Numbers(2, 2 * MOST_POINTS)
        tab.events.on("draw", self._drawn, id=TOOLS, points=points)
        tab.events.on("keep", self._keep, n=int, does=CHOICES)
        tab.events.on("cancel", self._cancel)
        tell = partial(later, self._tell)
        tab.state.subscribe("result", tell)
        tab.state.subscribe("corrections", tell)

    @property
    def _active(self) -> bool:
        return self._modes.current is self._mode

    @property
    def _harvest(self) -> ResultFiles | None:
        harvest: ResultFiles | None = self._export.harvest
        return harvest

    def _grid(self) -> GridMap | None:
        """The merged map as it is given away, in map 1's frame; None while there is none."""
        return None if self._harvest is None else self._harvest.corrected.grid

    # --- what is corrected ------------------------------------------------------------------------

    def _choose_rule(self, rule: ConflictRule) -> None:
        if self._harvest is not None:
            as_merged = rule is self._harvest.result.fusion.rule
            self._set(replace(self._state.corrections, rule=None if as_merged else rule))

    def _crop(self, yes: bool) -> None:
        self._set(replace(self._state.corrections, crop=yes))

    def _keep(self, n: int, does: Does) -> None:
        """What counts at a place of the list; pressed again, nothing that was chosen does."""
        with self._locks.action:
            found, now = self._state.contradictions, self._state.corrections
            if found is None or self._harvest is None or not 0 < n <= len(found.places):
                return
            place = found.places[n - 1]
            at = (place.x, place.y)
            reach = place.radius + self._harvest.result.fusion.merged.resolution
            self._set(now.choosing(None if now.chosen_at(at) == does else does, at, reach))

    def _clear_robots(self) -> None:
        with self._locks.action:
            edits, cells = self._ghosts()
            if cells:
                self._add(*edits)

    def _drawn(self, id: Tool, points: list[float]) -> None:  # noqa: A002
        """A tool was drawn over the map: x and y in turn, metres of the scene."""
        with self._locks.action:
            if not self._active or id != self._tool or len(points) % 2:
                return
            anchor = self._display.views.map.layout.anchor_ref
            at: list[Point] = [(x, y) for x, y in (np.reshape(points, (-1, 2)) + anchor).tolist()]
            try:
                if id == "line":
                    self._add(Edit("keep-out", tuple(at)))
                elif id == "brush":
                    self._add(Edit("erase", tuple(at), self._panel.radius))
                else:
                    self._add(Edit("erase", (at[0], at[-1]), box=True))
            except SettingError as error:
                self._notices.report(error)

    def _add(self, *edits: Edit) -> None:
        now = self._state.corrections
        self._set(replace(now, edits=(*now.edits, *edits)))

    def _ghosts(self) -> tuple[tuple[Edit, ...], int]:
        """What erases walls around the robots, and how many cells that would be."""
        grid, result = self._grid(), self._state.result
        seen = self._state.inputs.observations
        if grid is None or result is None or not seen:
            return (), 0
        observed = np.array([(one.observed_x, one.observed_y) for one in seen])
        places = [*(one.observer.xy for one in seen), *result.T_ref_mov.apply(observed)]
        return ghosts(grid, np.unique(np.round(places, 6), axis=0))

    def _set(self, corrections: Corrections) -> None:
        """The merged map is corrected like that from now on, as a step of its own."""
        with self._locks.action:
            harvest, snapshot = self._harvest, self._history.snapshot
            if harvest is None or snapshot is None or corrections == harvest.corrections:
                self._tell()
                return
            with self._locks.drawing:
                self._export.reframe(replace(harvest, corrections=corrections))
                self._state.update(corrections=corrections)
                self._history.note(replace(snapshot, corrections=corrections))
                self._compare("result")
                self._display.show_result_text(self._state.result)
                self._messages.flush()
            self._export.offered()

    def _tell(self) -> None:
        """Show what is corrected."""
        with self._locks.action, self._locks.drawing:
            harvest = self._harvest
            self._panel.offer(harvest is not None)
            if harvest is None:
                return
            fusion, corrections = harvest.result.fusion, harvest.corrections
            rule = corrections.rule or fusion.rule
            told = said(corrections, harvest.corrected.changed)
            around = self._ghosts()[1]
            self._panel.show(corrections, rule, harvest.inputs.names, why(rule, fusion), told, around)

    # --- tools ------------------------------------------------------------------------------------

    def _toggle(self, tool: Tool) -> None:
        """Take up a tool, or lay it down."""
        with self._locks.action:
            if self._active and self._tool == tool:
                self._modes.close()
            elif self._harvest is not None:
                self._modes.close()
                self._begin(tool)

    def _begin(self, tool: Tool) -> None:
        self._modes.enter(self._mode)
        self._tool = tool
        with self._locks.drawing:
            if self._state.turn_to_map():
                self._display.show_view()
            self._before = self._messages.said("state", "mood")
            self._compare("result")
            self._panel.hold(tool)
            self._messages.hud(state=ASKED[tool], mood="idle")
            self._hold()

    def _hold(self) -> None:
        """Have the browser draw with it."""
        with self._locks.drawing:
            if self._active:
                radius = self._panel.radius if self._tool == "brush" else 0.0
                self._messages.hand({"draw": {"id": self._tool, "r": radius}})
                self._messages.flush()

    def _cancel(self) -> None:
        """Escape."""
        with self._locks.action:
            if self._active:
                self._modes.close()

    def _end(self) -> None:
        with self._locks.drawing:
            self._panel.hold(None)
            self._messages.hand(None)
            self._messages.hud(**self._before)
            self._messages.flush()

    def _resume(self, snapshot: PageSnapshot, was_on: bool) -> bool:
        """Who takes a step back while correcting goes on correcting."""
        if was_on and snapshot.result is not None and self._tool is not None:
            self._begin(self._tool)
            return True
        return False
