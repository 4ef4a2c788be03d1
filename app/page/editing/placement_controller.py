"""Placing the robots by hand: three touches make an observation, and every sign can be dragged afterwards."""

from __future__ import annotations

from dataclasses import replace
from functools import partial

import numpy as np

from algorithms.common.errors import MapMergeError
from algorithms.common.pose import Pose2
from algorithms.observations.observation import Observation
from app.drawing.legend import legend
from app.drawing.scene import robot_symbols as signs
from app.drawing.scene_layout import lay_out
from app.model import status_text as words
from app.model.knowledge import Choice
from app.model.observation_draft import ObservationDraft, Part
from app.model.run_state import RunState
from app.model.view_modes import MAP
from app.page.inputs_controller import InputsController
from app.page.modes import Mode
from app.page.run_controller import RunController
from app.page.tab import Tab
from app.page.undo.page_snapshot import PageSnapshot
from app.page.undo.undo_controller import UndoController
from app.web.browser_events import Numbers

PARTS: tuple[Part, ...] = ("observer", "seen", "observed")


class PlacementController:
    """Of one tab."""

    def __init__(self, tab: Tab, undo: UndoController, runs: RunController, inputs: InputsController) -> None:
        self._state, self._display, self._modes = tab.state, tab.display, tab.modes
        self._messages, self._maps = tab.display.messages, tab.display.views.map
        self._panels, self._panel, self._locks = tab.panels, tab.panels.knowledge.observation, tab.state.locks
        self._undo, self._runs, self._inputs = undo, runs, inputs
        self._drafts: list[ObservationDraft] = [ObservationDraft()]
        self._chosen = 0
        self._layout = lay_out(None, None, None)
        self._mode = tab.modes.add(Mode(self._end, leave=self._leave, redraw=self._show, resume=self._resume))
        typed = partial(tab.events.then, self._type)  # in order with what the page tells of the signs
        self._panel.connect(self._toggle, typed, self._choose, self._add, self._remove)
        sign = {"id": PARTS, "at": Numbers(2, 2), "heading": Numbers(0, 1)}
        tab.events.on("drag", lambda **to: self._move(**to, rests=False), latest=True, **sign)
        tab.events.on("drop", lambda **to: self._move(**to, rests=True), **sign)
        tab.events.on("cancel", self._cancel)

    @property
    def active(self) -> bool:
        return self._modes.current is self._mode

    # --- what the mode does -----------------------------------------------------------------------

    def _end(self) -> None:
        with self._locks.drawing:
            self._messages.hand(None)
            for layer in ("robots", "sight"):
                self._messages.layer(layer, None)

    def _leave(self) -> None:
        """Everything as usual, with the observations there are."""
        with self._locks.action, self._locks.drawing:
            self._modes.close()
            self._inputs.show(self._state.inputs)
            self._undo.restore_current()

    def _resume(self, snapshot: PageSnapshot, was_on: bool) -> bool:
        """Who takes a step back while placing goes on placing."""
        if was_on and snapshot.goal is None:
            self.begin()
        return self.active

    # --- what a person does -----------------------------------------------------------------------

    def _toggle(self) -> None:
        with self._locks.action:
            if self.active:
                self._leave()
                return
            self._modes.leave()
            self._runs.thread.stop()
            self.begin()

    def begin(self) -> None:
        """Offer the robots of the inputs, or none yet, to be placed: both maps side by side."""
        state = self._state
        with self._locks.action:
            i = state.inputs
            if i.ref is None or i.mov is None:
                return
            self._drafts = [ObservationDraft.of(o) for o in i.observations] or [ObservationDraft()]
            self._chosen = 0
            self._modes.enter(self._mode)
            with self._locks.drawing:
                self._layout = lay_out(i.ref, i.mov, None)
                self._display.views.comparison.clear()
                self._display.withdraw_result()
                if state.turn_to_map():
                    self._display.show_view(self._show)
                self._maps.load(replace(i, observations=()), self._layout, state.palette)
                self._display.clear_read_out()
                shown = {"frames": self._layout.frames(), "legend": legend(state.palette, MAP, RunState())}
                self._messages.hud(mood="idle", progress=None, **shown)
                self._show()

    def _choose(self, number: int) -> None:
        with self._locks.action, self._locks.drawing:
            if self.active and 0 <= number < len(self._drafts):
                self._chosen = number
                self._show()

    def _add(self) -> None:
        with self._locks.action, self._locks.drawing:
            if self.active and self._drafts[-1].missing is None:
                self._drafts.append(ObservationDraft())
                self._chosen = len(self._drafts) - 1
                self._show()

    def _remove(self) -> None:
        with self._locks.action, self._locks.drawing:
            if not self.active:
                return
            del self._drafts[self._chosen]
            self._drafts = self._drafts or [ObservationDraft()]
            self._chosen = min(self._chosen, len(self._drafts) - 1)
            self._settle()

    def _cancel(self) -> None:
        """Escape: a half-placed observation goes."""
        with self._locks.action:
            if self.active and self._drafts[self._chosen].missing is not None:
                self._remove()

    def _type(self, field: str, value: float) -> None:
        with self._locks.action, self._locks.drawing:
            if self.active:
                self._drafts[self._chosen] = self._drafts[self._chosen].typed(field, value)
                self._settle()

    def _move(self, id: Part, at: list[float], heading: list[float], rests: bool) -> None:  # noqa: A002
        """A sign was put somewhere: relative to the anchor of the map it belongs to."""
        with self._locks.action, self._locks.drawing:
            if not self.active:
                return
            before = self._drafts[self._chosen]
            inputs, layout = self._state.inputs, self._layout
            grid, number, anchor = inputs.ref, 1, layout.anchor_ref
            if id == "observed":
                grid, number, anchor = inputs.mov, 2, layout.anchor_mov
            point = np.array(at) + anchor
            if rests and before.missing == id and not (grid is not None and grid.contains(point)):
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

    # --- what comes of it -------------------------------------------------------------------------

    def _made(self) -> tuple[Observation, ...]:
        made = (draft.observation for draft in self._drafts)
        return tuple(one for one in made if one is not None)

    def _settle(self) -> None:
        """The hand rests: the observations that are whole are the page's."""
        try:
            made = self._made()
        except MapMergeError as error:  # a number that no observation can have
            self._show(str(error))
            return
        if made != self._state.inputs.observations:
            before = self._state.inputs
            choice: Choice = "all" if before.choice == "all" else "sighting"
            inputs = replace(before, observations=made, choice=choice)
            self._inputs.follow(before, inputs)
            self._inputs.forget_results(inputs)
            self._panels.charts.clear()
            self._panels.run.merge.disabled = not inputs.complete
            self._undo.history.note(self._state.snapshot())
        self._show()

    def _show(self, trouble: str = "") -> None:
        draft = self._drafts[self._chosen]
        self._panel.edit(self._drafts, self._chosen, trouble)
        self._panels.knowledge.savable(all(one.missing is None for one in self._drafts))
        if self._state.view != MAP:
            return
        others = [one for number, one in enumerate(self._drafts) if number != self._chosen]
        items = signs.drafts(draft, others, self._layout, self._state.palette)
        self._messages.layer("robots", items)
        state, mood = trouble or words.PLACING[draft.missing], "refused" if trouble else "idle"
        self._messages.hud(state=state, mood=mood)
        hand: dict[str, object] = {"grips": self._grips(draft)}
        if draft.missing is not None:
            frame = "map2" if draft.missing == "observed" else "scene"
            hand["place"] = {"id": draft.missing, "f": frame}
        self._messages.hand(hand)
        self._messages.flush()

    def _grips(self, draft: ObservationDraft) -> list[dict[str, object]]:
        layout, grips = self._layout, []
        if draft.observer is not None:
            at = draft.observer.xy - layout.anchor_ref
            grips.append({"id": "observer", "f": "scene", "p": at, "a": draft.observer.theta})
        if draft.seen is not None:
            at = np.array(draft.seen) - layout.anchor_ref
            grips.append({"id": "seen", "f": "scene", "p": at, "a": None})
        if draft.observed is not None:
            at = np.array(draft.observed) - layout.anchor_mov
            vague = draft.heading is None  # a heading that is not known can be given by its knob
            a = draft.heading or 0.0
            grips.append({"id": "observed", "f": "map2", "p": at, "a": a, "vague": vague})
        return grips
