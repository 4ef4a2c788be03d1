"""What is known of how the maps lie: which kind is used; a rough one is typed, or moved on the map."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import partial

import numpy as np

from algorithms.common.errors import SettingError
from algorithms.common.pose import FloatArray, Pose2, wrap_angle
from algorithms.files.observation_file import OBSERVATION_FILE
from algorithms.maps.grid_map import GridMap
from algorithms.observations.pair_problem import Known
from algorithms.observations.priors import InitialPose, NearPlace, Prior, TurnPrior
from app.drawing.legend import legend
from app.drawing.scene import prior_symbols as signs
from app.drawing.scene_layout import lay_out
from app.model.knowledge import PRIORS, Choice, kind_of, laid, used, with_number
from app.model.merge_inputs import TO_PLACE
from app.model.run_state import RunState
from app.model.view_modes import MAP
from app.page.inputs_controller import InputsController
from app.page.modes import Mode
from app.page.run_controller import RunController
from app.page.tab import Tab
from app.page.undo.page_snapshot import PageSnapshot
from app.page.undo.undo_controller import UndoController
from app.report.result_files import known_file
from app.web.browser_events import Numbers

PLACES = ("near1", "near2")
MOVE = {
    "initial": "Drag map 2 to where it lies, roughly; turn it by its knob.",
    "turn": "Turn map 2 by its knob.",
    "near": "Drag each ring to the place that both maps show.",
}


class KnowledgeController:
    """Of one tab; ``place_robots``: begins to place them by hand."""

    def __init__(
        self,
        tab: Tab,
        undo: UndoController,
        runs: RunController,
        inputs: InputsController,
        place_robots: Callable[[], None],
    ) -> None:
        self._state, self._display, self._modes = tab.state, tab.display, tab.modes
        self._messages, self._maps = tab.display.messages, tab.display.views.map
        self._panels, self._panel, self._locks = tab.panels, tab.panels.knowledge, tab.state.locks
        self._undo, self._runs, self._inputs, self._place_robots = undo, runs, inputs, place_robots
        self._prior: Prior | None = None  # the one that is moved
        self._layout = lay_out(None, None, None)
        self._mode = tab.modes.add(Mode(self._end, leave=self._leave, redraw=self._show, resume=self._resume))
        self._panel.connect(self._choose, partial(tab.events.then, self._type), self._toggle, self._save)
        where = {"x": float, "y": float, "theta": float}
        tab.events.on("carry", lambda **at: self._lay(Pose2(**at), rests=False), latest=True, **where)
        tab.events.on("put", lambda knew, **at: self._lay(Pose2(**at), rests=True), knew=int, **where)
        tab.events.on("nudge", self._nudge, knew=int, **where)
        ring = {"id": PLACES, "at": Numbers(2, 2), "heading": Numbers(0, 1)}
        tab.events.on("drag", lambda **to: self._drag(**to, rests=False), latest=True, **ring)
        tab.events.on("drop", lambda **to: self._drag(**to, rests=True), **ring)

    @property
    def active(self) -> bool:
        return self._modes.current is self._mode

    # --- what is used -----------------------------------------------------------------------------

    def _choose(self, choice: Choice) -> None:
        """Another kind of knowledge is to be used; where nothing of it is there yet, it is placed."""
        with self._locks.action:
            if choice == self._state.inputs.choice:
                return
            self._modes.leave()
            before = self._state.inputs
            pool = before.pool
            if choice == "turn" and not used(pool, choice):
                pool = (*pool, TurnPrior(0.0))  # a number beside it says so
            with self._locks.drawing:
                if not self._know(pool, choice):
                    return
            if choice in PRIORS:
                self.begin()
            elif not self._state.inputs.complete:
                self._place_robots()

    def _know(self, pool: tuple[Known, ...], choice: Choice) -> bool:
        """The page goes by that from now on, with the maps side by side; whoever calls is drawing."""
        before = self._state.inputs
        inputs = before.knowing(pool, choice)
        if not self._inputs.show(inputs):
            return False
        self._inputs.follow(before, inputs)
        self._undo.history.note(self._state.snapshot())
        return True

    def _save(self) -> None:
        with self._locks.action:
            if self._state.inputs.known:
                self._panels.send(OBSERVATION_FILE, known_file(self._state.inputs))

    # --- the mode in which it is moved on the map -------------------------------------------------------

    def _toggle(self) -> None:
        with self._locks.action:
            if self.active:
                self._leave()
                return
            self._modes.leave()
            self._runs.thread.stop()
            self.begin()

    def begin(self) -> None:
        """Offer what was chosen to be moved: a pose with map 2 over map 1, else both side by side."""
        state, i = self._state, self._state.inputs
        with self._locks.action:
            if i.ref is None or i.mov is None or i.choice not in PRIORS:
                return
            side_by_side = lay_out(i.ref, i.mov, None)
            self._prior = i.chosen_prior or _first(i.choice, i.mov, *side_by_side.anchors)
            self._layout = side_by_side
            if isinstance(self._prior, InitialPose):  # it turns about the point of which the error is told
                self._layout = lay_out(i.ref, i.mov, None, mov_anchor=self._prior.about)
            self._modes.enter(self._mode)
            with self._locks.drawing:
                self._display.views.comparison.clear()
                self._display.withdraw_result()
                if state.turn_to_map():
                    self._display.show_view(self._show)
                self._maps.load(replace(i, observations=()), self._layout, state.palette)
                self._display.clear_read_out()
                shown = {"frames": self._layout.frames(), "legend": legend(state.palette, MAP, RunState())}
                self._messages.hud(progress=None, **shown)
                self._show()
                self._messages.look_down(self._maps.extent(), follow=True)
                self._messages.flush()

    def _end(self) -> None:
        with self._locks.drawing:
            self._maps.let_go()
            self._maps.clear("robots", "sight")
            self._messages.flush()

    def _leave(self) -> None:
        with self._locks.action, self._locks.drawing:
            self._modes.close()
            self._inputs.show(self._state.inputs)
            self._undo.restore_current()

    def _resume(self, snapshot: PageSnapshot, was_on: bool) -> bool:
        """Who takes a step back while moving it goes on moving it."""
        if was_on and snapshot.goal is None:
            self.begin()
        return self.active

    def _show(self) -> None:
        prior, layout, colours = self._prior, self._layout, self._state.palette
        if prior is None:
            return
        self._panel.show(self._state.inputs, prior, moving=True)
        if self._state.view != MAP:
            return
        if isinstance(prior, NearPlace):
            self._messages.layer("robots", signs.near_place(prior, layout, colours))
            places = (prior.ref_x, prior.ref_y), (prior.mov_x, prior.mov_y)
            grips = [
                {"id": name, "f": frame, "p": np.array(place) - anchor, "a": None}
                for name, frame, place, anchor in zip(
                    PLACES, ("scene", "map2"), places, layout.anchors, strict=True
                )
            ]
            self._messages.hand({"grips": grips})
        else:
            self._maps.hold(self._at(prior), turns_only=isinstance(prior, TurnPrior))
            self._messages.layer("sight", self._signs(prior))
        placed = prior in self._state.inputs.known
        kind = kind_of(prior)
        self._messages.hud(state=MOVE[kind] if placed else TO_PLACE[kind], mood="idle")
        self._messages.flush()

    def _at(self, prior: InitialPose | TurnPrior) -> Pose2:
        """Where map 2's anchor lies by it; a turn alone leaves it beside map 1."""
        if isinstance(prior, InitialPose):
            return self._layout.placed(prior.pose)
        return Pose2(self._layout.apart.x, self._layout.apart.y, prior.yaw)

    def _signs(self, prior: InitialPose | TurnPrior) -> list[signs.Item]:
        draw = signs.rough_pose if isinstance(prior, InitialPose) else signs.rough_turn
        return draw(prior, self._layout, self._state.palette)  # type: ignore[operator]

    # --- what a person does -----------------------------------------------------------------------

    def _type(self, name: str, value: float) -> None:
        with self._locks.action, self._locks.drawing:
            prior = self._prior if self.active else self._state.inputs.chosen_prior
            if prior is None:
                return
            try:
                prior = with_number(prior, name, value)
            except (SettingError, KeyError) as error:  # KeyError: of a kind that was chosen before
                self._panel.tell(str(error))
                return
            self._settle(prior)

    def _lay(self, at: Pose2, rests: bool) -> None:
        """Map 2 was laid there by the hand, or is on the way; the page has drawn it."""
        with self._locks.action, self._locks.drawing:
            if not self.active or not isinstance(self._prior, InitialPose | TurnPrior):
                return
            self._maps.mov_at = at
            prior = laid(self._prior, self._layout.transform(at))
            if rests:
                self._settle(prior)
                return
            self._prior = prior
            self._panel.show(self._state.inputs, prior, moving=True)

    def _nudge(self, x: float, y: float, theta: float, knew: int) -> None:
        """Map 2 was stepped by a key."""
        with self._locks.action:
            lay = self._maps.mov_at
            self._lay(Pose2(lay.x + x, lay.y + y, wrap_angle(lay.theta + theta)), rests=True)

    def _drag(self, id: str, at: list[float], heading: list[float], rests: bool) -> None:  # noqa: A002
        """A ring was put somewhere: relative to the anchor of the map it belongs to."""
        with self._locks.action, self._locks.drawing:
            if not self.active or not isinstance(self._prior, NearPlace):
                return
            number = PLACES.index(id)
            x, y = (np.array(at) + self._layout.anchors[number]).tolist()
            names = ("ref_x", "ref_y") if number == 0 else ("mov_x", "mov_y")
            prior = replace(self._prior, **dict(zip(names, (x, y), strict=True)))
            if rests:
                self._settle(prior)
            else:
                self._prior = prior
                self._show()

    def _settle(self, prior: Prior) -> None:
        """That is known from now on; whoever calls is drawing."""
        before = self._state.inputs
        others = (one for one in before.pool if kind_of(one) != kind_of(prior))
        if not self.active:
            self._know((*others, prior), before.choice)
            return
        self._prior = prior
        inputs = before.knowing((*others, prior), before.choice)
        self._inputs.follow(before, inputs)
        self._inputs.forget_results(inputs)
        self._panels.charts.clear()
        self._panels.run.merge.disabled = not inputs.complete
        self._undo.history.note(self._state.snapshot())
        self._show()


def _first(choice: Choice, mov: GridMap, middle_ref: FloatArray, middle_mov: FloatArray) -> Prior:
    """What is offered to be moved where nothing is known: the middles of the maps on each other.

    The error of a pose is that of map 2's origin, where its robot has begun; of its middle where that is off
    the map.
    """
    (x1, y1), (x2, y2) = middle_ref.tolist(), middle_mov.tolist()
    if choice == "near":
        return NearPlace(x1, y1, x2, y2)
    about = (0.0, 0.0) if mov.contains((0.0, 0.0)) else (x2, y2)
    return InitialPose(Pose2(x1 - x2, y1 - y2), about_x=about[0], about_y=about[1])
