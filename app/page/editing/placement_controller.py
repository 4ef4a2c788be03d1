"""Placing the robots by hand: three touches make an observation, and every sign can be dragged afterwards."""

from __future__ import annotations

from functools import partial
from threading import RLock
from typing import Protocol

import numpy as np

from algorithms.common.errors import MapMergeError
from algorithms.common.pose import FloatArray, Pose2
from algorithms.maps.grid_map import GridMap
from algorithms.observations.observation import Observation
from app.drawing.browser_messages import BrowserMessages
from app.drawing.scene import robot_symbols as signs
from app.drawing.scene.map_view import MapView
from app.drawing.scene_layout import SceneLayout, lay_out
from app.model import status_text as words
from app.model.observation_draft import ObservationDraft, Part
from app.page.editing.observation_panel import ObservationPanel, PlacingWishes
from app.page.host import MapHost, PageHost
from app.web.browser_events import BrowserEvents, Numbers

PARTS: tuple[Part, ...] = ("observer", "seen", "observed")


class Host(PageHost, MapHost, Protocol):
    """The page, as far as it is asked from here."""

    def placing_asked(self) -> None:
        """The robots are to be placed: whatever else is going on ends."""

    def placing_begins(self, layout: SceneLayout) -> None:
        """The maps are shown side by side, and stay so."""

    def observed(self, observations: tuple[Observation, ...]) -> None:
        """These are the observations now."""

    def placing_ends(self) -> None:
        """Everything as usual, with the observations there are."""

    def save_observations(self, observations: tuple[Observation, ...]) -> None:
        """Send a file."""


class PlacementController:
    """Of one tab. ``turn`` and ``drawing`` as in the page: the first is taken before the second."""

    def __init__(
        self,
        panel: ObservationPanel,
        channel: BrowserEvents,
        stage: BrowserMessages,
        maps: MapView,
        turn: RLock,
        drawing: RLock,
        host: Host,
    ) -> None:
        self._panel, self._stage, self._maps, self._host = panel, stage, maps, host
        self._turn, self._drawing = turn, drawing
        self._drafts: list[ObservationDraft] = [ObservationDraft()]
        self._chosen = 0
        self._layout = lay_out(None, None, None)
        self.active = False
        typed = partial(channel.then, self._type)  # in order with what the page tells of the signs
        panel.listen(PlacingWishes(self._toggle, typed, self._choose, self._add, self._remove, self._save))
        sign = {"id": PARTS, "at": Numbers(2, 2), "heading": Numbers(0, 1)}
        channel.on("drag", lambda **to: self._move(**to, rests=False), latest=True, **sign)
        channel.on("drop", lambda **to: self._move(**to, rests=True), **sign)
        channel.on("cancel", self._cancel)

    def end(self) -> None:
        """Leave it, with what there is."""
        with self._turn, self._drawing:
            if self.active:
                self.active = False
                self._stage.hand(None)
                for layer in ("robots", "sight"):
                    self._stage.layer(layer, None)

    def redraw(self) -> None:
        """Draw the signs as they are now; whoever calls is drawing."""
        self._show()

    # --- what a person does -----------------------------------------------------------------------

    def _toggle(self) -> None:
        with self._turn:
            if self.active:
                self.end()
                self._host.placing_ends()
                return
            self._host.placing_asked()
            self.begin()

    def begin(self) -> None:
        """Offer the robots of the inputs, or none yet, to be placed."""
        with self._turn:
            inputs = self._host.inputs
            if inputs.ref is None or inputs.mov is None:
                return
            self._drafts = [ObservationDraft.of(o) for o in inputs.observations] or [ObservationDraft()]
            self._chosen, self.active = 0, True
            with self._drawing:
                self._layout = lay_out(inputs.ref, inputs.mov, None)
                self._host.placing_begins(self._layout)
                self._show()

    def _choose(self, number: int) -> None:
        with self._turn, self._drawing:
            if self.active and 0 <= number < len(self._drafts):
                self._chosen = number
                self._show()

    def _add(self) -> None:
        with self._turn, self._drawing:
            if self.active and self._drafts[-1].missing is None:
                self._drafts.append(ObservationDraft())
                self._chosen = len(self._drafts) - 1
                self._show()

    def _remove(self) -> None:
        with self._turn, self._drawing:
            if not self.active:
                return
            del self._drafts[self._chosen]
            self._drafts = self._drafts or [ObservationDraft()]
            self._chosen = min(self._chosen, len(self._drafts) - 1)
            self._settle()

    def _cancel(self) -> None:
        """Escape: a half-placed observation goes."""
        with self._turn:
            if self.active and self._drafts[self._chosen].missing is not None:
                self._remove()

    def _type(self, field: str, value: float) -> None:
        with self._turn, self._drawing:
            if self.active:
                self._drafts[self._chosen] = self._drafts[self._chosen].typed(field, value)
                self._settle()

    def _move(self, id: Part, at: list[float], heading: list[float], rests: bool) -> None:  # noqa: A002
        """A sign was put somewhere: relative to the anchor of the map it belongs to."""
        with self._turn, self._drawing:
            if not self.active:
                return
            before = self._drafts[self._chosen]
            inputs, layout = self._host.inputs, self._layout
            grid, number, anchor = inputs.ref, 1, layout.anchor_ref
            if id == "observed":
                grid, number, anchor = inputs.mov, 2, layout.anchor_mov
            point = np.array(at) + anchor
            if rests and before.missing == id and not _on(grid, point):
                self._show(f"That is not in map {number}.")
                return
            x, y = point.tolist()
            turned = heading[0] if heading else None
            if id == "observer":
                theta = turned if turned is not None else before.observer.theta if before.observer else 0.0
                after = before.stood(Pose2(x, y, theta))
            elif id == "seen":
                after = before if before.observer is None else before.saw((x, y))
            else:
                after = before.was((x, y), turned)
            if before.missing == id and not rests:
                return  # it is not there before it is let go of
            self._drafts[self._chosen] = after
            self._settle() if rests else self._show()

    def _save(self) -> None:
        with self._turn:
            told = self._told() if self.active else self._host.inputs.observations
            if told:
                self._host.save_observations(told)

    # --- what comes of it -------------------------------------------------------------------------

    def _told(self) -> tuple[Observation, ...]:
        made = (draft.observation for draft in self._drafts)
        return tuple(one for one in made if one is not None)

    def _settle(self) -> None:
        """The hand rests: the observations that are whole are the page's."""
        try:
            told = self._told()
        except MapMergeError as error:  # a number that no observation can have
            self._show(str(error))
            return
        if told != self._host.inputs.observations:
            self._host.observed(told)
        self._show()

    def _show(self, trouble: str = "") -> None:
        draft = self._drafts[self._chosen]
        self._panel.edit(self._drafts, self._chosen, trouble)
        if not self._host.on_map:
            return
        others = [one for number, one in enumerate(self._drafts) if number != self._chosen]
        items = signs.drafts(draft, others, self._layout, self._host.palette)
        self._stage.layer("robots", items)
        self._stage.hud(state=trouble or words.PLACING[draft.missing], mood="refused" if trouble else "idle")
        self._stage.hand({"grips": self._grips(draft), **self._place(draft)})
        self._stage.flush()

    def _place(self, draft: ObservationDraft) -> dict[str, object]:
        if draft.missing is None:
            return {}
        return {"place": {"id": draft.missing, "f": "map2" if draft.missing == "observed" else "scene"}}

    def _grips(self, draft: ObservationDraft) -> list[dict[str, object]]:
        layout, grips = self._layout, []
        if draft.observer is not None:
            at = draft.observer.xy - layout.anchor_ref
            grips.append({"id": "observer", "f": "scene", "p": at, "a": draft.observer.theta})
        if draft.seen is not None:
            grips.append(
                {"id": "seen", "f": "scene", "p": np.array(draft.seen) - layout.anchor_ref, "a": None}
            )
        if draft.observed is not None:
            at = np.array(draft.observed) - layout.anchor_mov
            known = draft.heading is not None  # a heading that is not known can be given by its knob
            grips.append(
                {"id": "observed", "f": "map2", "p": at, "a": draft.heading or 0.0, "vague": not known}
            )
        return grips


def _on(grid: GridMap | None, point: FloatArray) -> bool:
    return grid is not None and grid.contains(point)
