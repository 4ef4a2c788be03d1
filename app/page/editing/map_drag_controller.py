"""Map 2 in a person's hand: where it lies, and what becomes of it."""

from __future__ import annotations

from dataclasses import replace
from functools import partial

from algorithms.common.errors import MapMergeError
from algorithms.common.pose import Pose2, wrap_angle
from algorithms.methods.manual_merge import ManualMerge, known_answers, refine
from algorithms.methods.merge_result import BY_HAND, CHOSEN, MergeResult
from algorithms.methods.plane_method import PlaneMethodConfig
from algorithms.methods.spectra_config import PipelineConfig
from algorithms.methods.steps import ObservationDetail, Step
from algorithms.methods.suggestions import suggested
from algorithms.observations.pair_problem import PairProblem
from app.model.run_state import RunState
from app.page.editing.live_verdict import LiveVerdict
from app.page.modes import Mode
from app.page.panels.html_widgets import box
from app.page.run_controller import RunController
from app.page.tab import Tab
from app.page.undo.page_snapshot import PageSnapshot
from app.page.undo.undo_controller import UndoController

GLIDE = 180.0  # milliseconds in which map 2 goes where a number puts it


class MapDragController:
    """Of one tab."""

    def __init__(self, tab: Tab, undo: UndoController, runs: RunController) -> None:
        self._state, self._display, self._modes = tab.state, tab.display, tab.modes
        self._panels, self._notices = tab.panels, tab.notices
        self._panel, self._locks = tab.panels.transform, tab.state.locks
        self._messages, self._maps = tab.display.messages, tab.display.views.map
        self._undo, self._runs = undo, runs
        self._manual: ManualMerge | None = None
        self._at = Pose2()  # where map 2's anchor lies; scene
        self._verdict = LiveVerdict(tab.state, tab.display, self._panel)
        self._mode = tab.modes.add(
            Mode(self._end, redraw=self._redraw, changed=self._settings_changed, resume=self._resume)
        )
        typed = partial(tab.events.then, self._type)  # in order with what the page tells of the hand
        self._panel.connect(self._toggle, typed, self._refine, self._snap, self._take, self._about_another)
        where = {"x": float, "y": float, "theta": float}
        tab.events.on("carry", lambda **at: self._carry(Pose2(**at)), latest=True, **where)
        tab.events.on("put", lambda knew, **at: self._put(Pose2(**at), knew), knew=int, **where)
        tab.events.on("nudge", self._nudge, knew=int, **where)
        tab.events.on("take", self._take)

    def close(self) -> None:
        self._verdict.close()

    @property
    def active(self) -> bool:
        """Whether map 2 is in the hand."""
        return self._state.hand is not None

    def begin(self, T_ref_mov: Pose2 | None = None) -> None:
        """Take map 2 up: at a transform, or where it lies."""
        with self._locks.action:
            manual = self._new_manual()
            if manual is not None:
                with self._locks.drawing:
                    self.take_up(manual, T_ref_mov)

    def preview(self, T_ref_mov: Pose2, label: str) -> None:
        """Take map 2 up at a transform, as a step of its own in the history."""
        with self._locks.action:
            self._runs.thread.stop()
            self.begin(T_ref_mov)
            if self.active:
                with self._locks.drawing:
                    self._messages.look_down(self._maps.extent(), need=True)
                    self._messages.flush()
                self._undo.history.note(self._state.snapshot(), label)

    def take_up(self, manual: ManualMerge, T_ref_mov: Pose2 | None) -> None:
        """The same with what it is weighed on; whoever calls is drawing."""
        self._modes.enter(self._mode)
        self._manual = manual
        self._verdict.weigh_on(manual)
        self._at = self._maps.mov_at if T_ref_mov is None else self._maps.layout.placed(T_ref_mov)
        self._state.update(hand=self._maps.layout.transform(self._at))
        proves = isinstance(manual.config, PipelineConfig)
        climbs = isinstance(manual.config, PlaneMethodConfig)
        seen = self._state.inputs.at is not None
        self._panel.open(True, refine=proves or climbs, prove=proves, seen=seen)
        self._display.views.comparison.offer(None, self._state.palette)
        if self._state.turn_to_map():
            self._display.show_view(self._redraw)
        self._display.withdraw_result()
        self._display.show_legend()
        self._redraw()

    def _new_manual(self) -> ManualMerge | None:
        """What a transform is weighed on; None where an input is missing, or wrong, which is reported."""
        state, i = self._state, self._state.inputs
        if i.ref is None or i.mov is None or not i.complete:
            return None
        search = self._known_search
        known = known_answers(search.get(MergeResult)) if search is not None else ()
        try:
            return ManualMerge(PairProblem(i.ref, i.mov, i.observations, i.priors), state.config, known)
        except MapMergeError as error:
            self._notices.report(error)
            return None

    @property
    def _known_search(self) -> RunState | None:
        """The last run of the method, if it ran with the settings of now."""
        search = self._state.search
        return search if search is not None and search.config == self._state.config else None

    # --- what the mode does -----------------------------------------------------------------------

    def _end(self) -> None:
        with self._locks.drawing:
            self._state.update(hand=None)
            self._verdict.drop()
            self._panel.open(False)
            self._maps.let_go()
            self._messages.flush()

    def _redraw(self) -> None:
        self._maps.hold(self._at)
        self._show_numbers()
        self._messages.flush()
        self._verdict.ask(self._at, rests=True)

    def _settings_changed(self) -> None:
        self.begin(self._state.hand)

    def _resume(self, snapshot: PageSnapshot, was_on: bool) -> bool:
        if snapshot.held and snapshot.other is None:
            self.begin(snapshot.hand)
            return True
        return snapshot.outcome is None and self._answer_again(snapshot)

    def _answer_again(self, snapshot: PageSnapshot) -> bool:
        """Show the answer that a person took, which was let go of; whether there is one."""
        manual = self._new_manual() if snapshot.taken else None
        if manual is None or snapshot.hand is None:
            return False
        try:
            result = manual.weigh(snapshot.hand, method=snapshot.taken)
        except MapMergeError as error:
            self._notices.report(error)
            return False
        self._show_taken(result)
        return True

    def _show_taken(self, result: MergeResult) -> None:
        """Show what a person took for the answer, which comes of the step at hand."""
        run = RunState(self._state.config)
        run.add(Step("observe", ObservationDetail(result.encounters), 0.0))
        run.add(Step("fuse", result.fusion, 0.0))
        run.add(Step("verdict", result, 0.0))
        self._runs.show_answer(run, result, self._state.config, live=False)
        self._undo.history.amend(run)
        self._messages.flush()

    # --- what a person does -----------------------------------------------------------------------

    def _toggle(self) -> None:
        with self._locks.action:
            if self.active:
                self._modes.close()  # everything as it was before
                self._undo.go_to(replace(self._state.snapshot(), outcome=self._known_search))
                return
            self._modes.leave()
            self._runs.thread.stop()
            self.begin()
            if self.active:
                self._note()

    def _carry(self, at: Pose2) -> None:
        """Map 2 is on the way; the page draws it by itself."""
        with self._locks.action:
            if self.active:
                self._move(at)
                self._show_numbers()
                self._verdict.ask(at, rests=False)

    def _put(self, at: Pose2, knew: int) -> None:
        """Map 2 was put down by the hand."""
        with self._locks.action:
            if self.active:
                self._rest(at, self._known(knew))

    def _nudge(self, x: float, y: float, theta: float, knew: int) -> None:
        """Map 2 was stepped by a key, from where it lies: perhaps not where the page took it to be."""
        with self._locks.action:
            if self.active:
                lay = self._at
                at = Pose2(lay.x + x, lay.y + y, wrap_angle(lay.theta + theta))
                self._rest(at, self._known(knew), look=True)

    def _type(self, field: str, value: float) -> None:
        """One number was typed; the others stay."""
        with self._locks.action:
            if self.active:
                at = self._maps.layout.with_number(self._at, field, value, self._panel.of_origin)
                self._rest(at, GLIDE, look=True)

    def _show_numbers(self) -> None:
        layout = self._maps.layout
        self._panel.show(layout.transform(self._at), self._at.xy + layout.anchor_ref)

    def _about_another(self) -> None:
        """The numbers are to be those of another point; map 2 stays."""
        with self._locks.action:
            if self.active:
                self._show_numbers()

    def _known(self, knew: int) -> float | None:
        """The time in which the page has to be put right, if it went by an older message than the last."""
        return None if knew == self._messages.placed else GLIDE

    def _move(self, at: Pose2) -> None:
        self._at = at
        self._state.update(hand=self._maps.layout.transform(at))
        self._maps.mov_at = at  # the page has moved it by itself

    def _rest(self, at: Pose2, glide: float | None, look: bool = False) -> None:
        """Map 2 lies there from now on; whoever calls holds the action lock.

        glide : milliseconds in which the page takes it there; None where it did so by itself
        look  : the camera takes it in
        """
        self._move(at)
        with self._locks.drawing:
            if glide is not None:
                self._messages.place_map(2, at, glide)
            if look and self._panels.run.follow:
                self._messages.look_down(self._maps.extent(), need=True)
            self._messages.flush()
        self._show_numbers()
        self._verdict.ask(at, rests=True)
        self._note()

    def _note(self) -> None:
        self._undo.history.note(self._state.snapshot())

    def _refine(self) -> None:
        """Search from there; where it ends, map 2 is in the hand again."""
        with self._locks.action:
            manual, T = self._manual, self._state.hand
            if manual is None or T is None:
                return
            self._modes.close()
            search = partial(refine, manual, T, self._state.seed)
            job = self._state.job(pace=self._panels.run.pace, steps=search)
            if job is not None:
                self._runs.search(job, partial(self._refined, manual, T))

    def _refined(self, manual: ManualMerge, before: Pose2, run: RunState | None) -> None:
        result = run.get(MergeResult) if run is not None else None
        if run is None or result is None:
            self.take_up(manual, before)
            return
        self._panels.charts.show(run, follow=False)
        self.take_up(manual, result.T_ref_mov)
        self._undo.history.note(self._state.snapshot(), "refine by hand")

    def _snap(self) -> None:
        """Take the best of the whole circle: known already, or looked for."""
        with self._locks.action:
            if not self.active:
                return
            self._modes.close()
            state, search = self._state, self._known_search
            result = search.get(MergeResult) if search is not None else None
            if result is None or not result.proven_optimal:
                search = None
                proof = replace(state.config.proof, whole_circle=True)
                self._runs.set_method(state.method, replace(state.config, proof=proof))
            snapshot = replace(state.snapshot(), outcome=search, goal="merge")
            self._undo.go_to(snapshot, "snap to the proven optimum")

    def _take(self) -> None:
        with self._locks.action:
            manual, T, state = self._manual, self._state.hand, self._state
            if manual is None or T is None:
                return
            searched = self._known_search.get(MergeResult) if self._known_search is not None else None
            chosen = searched is not None and suggested(searched, T) is not None
            try:
                result = manual.weigh(T, method=CHOSEN if chosen else BY_HAND)
            except MapMergeError as error:
                self._panel.tell(box(state.inputs.names.told(str(error)), "refused"))
                return
            self._modes.close()
            with self._locks.drawing:
                snapshot = replace(state.snapshot(), hand=result.T_ref_mov, taken=result.method)
                self._undo.history.note(snapshot, "take it by hand")
                self._show_taken(result)
