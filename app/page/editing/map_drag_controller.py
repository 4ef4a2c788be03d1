"""Map 2 in a person's hand: where it lies, what the walls say of it meanwhile, what becomes of it."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from threading import RLock
from time import perf_counter
from typing import Protocol

import viser

from algorithms.common.errors import MapMergeError
from algorithms.common.pose import Pose2, wrap_angle
from algorithms.methods.manual_merge import ManualMerge
from algorithms.methods.merge_result import MergeResult
from algorithms.methods.spectra_config import PipelineConfig
from algorithms.verdict.cell_agreement import WallLookup
from app.drawing.browser_messages import BrowserMessages
from app.drawing.scene.map_view import MapView
from app.jobs.latest_request import LatestRequest
from app.model import verdict_text as words
from app.page.editing.transform_panel import HandWishes, TransformPanel, weighed_html
from app.page.host import MapHost
from app.page.panels.html_widgets import box
from app.web.browser_events import BrowserEvents

PATIENCE = 0.1  # seconds; weighing that takes longer waits until the hand rests
REST = 0.15  # seconds in which a hand that rests does not move
GLIDE = 180.0  # milliseconds in which map 2 goes where a number puts it


class Host(MapHost, Protocol):
    """The page, as far as it is asked from here."""

    @property
    def scales(self) -> ManualMerge | None:
        """What a transform is weighed on; None where something is missing."""

    @property
    def found(self) -> Pose2 | None:
        """What the method has found; None before."""

    @property
    def follows(self) -> bool:
        """Whether the camera is to go along."""

    def hand_asked(self) -> None:
        """A person wants map 2 in their hand: whatever else is going on ends."""

    def hand_begins(self) -> None:
        """What was found is out of the way from now on."""

    def hand_moved(self, T_ref_mov: Pose2) -> None:
        """Map 2 was put there."""

    def hand_taken(self, result: MergeResult) -> None:
        """This is to be the answer."""

    def hand_refines(self, scales: ManualMerge, T_ref_mov: Pose2) -> None:
        """Search from there."""

    def hand_snaps(self) -> None:
        """Take the best of the whole circle."""

    def hand_leaves(self) -> None:
        """Everything as it was before."""


class MapDragController:
    """Of one tab. ``turn`` and ``drawing`` as in the page: the first is taken before the second."""

    def __init__(
        self,
        gui: viser.GuiApi,
        channel: BrowserEvents,
        stage: BrowserMessages,
        maps: MapView,
        turn: RLock,
        drawing: RLock,
        host: Host,
    ) -> None:
        self._stage, self._maps, self._turn, self._drawing, self._host = stage, maps, turn, drawing, host
        self._scales: ManualMerge | None = None
        self._walls: tuple[WallLookup, WallLookup] | None = None
        self._at = Pose2()  # where map 2's anchor lies; scene
        self._slow = 0.0  # seconds that weighing took last
        self.active = False
        typed = partial(channel.then, self._type)  # in order with what the page tells of the hand
        wishes = HandWishes(self._toggle, typed, self._refine, self._snap, self._take)
        self.panel = TransformPanel(gui, wishes)
        self._work = LatestRequest(self._weigh, "mapmeld-hand")
        where = {"x": float, "y": float, "theta": float}
        channel.on("carry", lambda **at: self._carry(Pose2(**at)), latest=True, **where)
        channel.on("put", lambda knew, **at: self._put(Pose2(**at), knew), knew=int, **where)
        channel.on("nudge", self._nudge, knew=int, **where)

    def close(self) -> None:
        """The tab is gone."""
        self._work.close()

    @property
    def pose(self) -> Pose2 | None:
        """T_ref_mov as map 2 is held; None while it is not."""
        return self._maps.layout.transform(self._at) if self.active else None

    def begin(self, T_ref_mov: Pose2 | None = None) -> None:
        """Take map 2 up: at a transform, or where it lies."""
        with self._turn:
            scales = self._host.scales
            if scales is None:
                return
            with self._drawing:
                self.take_up(scales, T_ref_mov)

    def take_up(self, scales: ManualMerge, T_ref_mov: Pose2 | None) -> None:
        """The same on these scales; whoever calls is drawing."""
        self._scales = scales
        if self._walls is None or (self._walls[0].grid, self._walls[1].grid) != (
            scales.problem.ref,
            scales.problem.mov,
        ):
            self._walls = WallLookup(scales.problem.ref), WallLookup(scales.problem.mov)
        self._at = self._maps.mov_at if T_ref_mov is None else self._maps.layout.placed(T_ref_mov)
        self.active = True
        searches = isinstance(scales.config, PipelineConfig)
        self.panel.open(True, refine=searches, prove=searches)
        self._host.hand_begins()
        self.redraw()

    def end(self) -> None:
        """Let go of map 2, whatever becomes of it."""
        with self._turn, self._drawing:
            if self.active:
                self.active = False
                self._work.drop()
                self.panel.open(False)
                self._maps.let_go()
                self._stage.flush()

    def redraw(self) -> None:
        """Draw map 2 where it is held."""
        self._maps.hold(self._at)
        self.panel.show(self._maps.layout.transform(self._at))
        self._stage.flush()
        self._work.ask((self._at, True))

    # --- what a person does -----------------------------------------------------------------------

    def _toggle(self) -> None:
        with self._turn:
            if not self.active:
                self._host.hand_asked()
                self.begin()
                if self.active:
                    self._host.hand_moved(self._maps.layout.transform(self._at))
            else:
                self.end()
                self._host.hand_leaves()

    def _carry(self, at: Pose2) -> None:
        """Map 2 is on the way; the page draws it by itself."""
        with self._turn:
            if self.active:
                self._at = at
                self._maps.carried(at)
                self.panel.show(self._maps.layout.transform(at))
                self._work.ask((at, False))

    def _put(self, at: Pose2, knew: int) -> None:
        """Map 2 was put down by the hand."""
        with self._turn:
            if self.active:
                self._rest(at, self._known(knew))

    def _nudge(self, x: float, y: float, theta: float, knew: int) -> None:
        """Map 2 was stepped by a key, from where it lies: perhaps not where the page took it to be."""
        with self._turn:
            if self.active:
                lay = self._at
                at = Pose2(lay.x + x, lay.y + y, wrap_angle(lay.theta + theta))
                self._rest(at, self._known(knew), look=True)

    def _type(self, field: str, value: float) -> None:
        """One number of T was typed; a turn is about robot 2, so it leaves robot 2 where it is."""
        with self._turn:
            if not self.active:
                return
            if field == "theta":
                at = replace(self._at, theta=wrap_angle(value))
            else:
                T = self._maps.layout.transform(self._at)
                at = self._maps.layout.placed(replace(T, **{field: value}))
            self._rest(at, GLIDE, look=True)

    def _known(self, knew: int) -> float | None:
        """The time in which the page has to be put right, if it went by an older word than the last."""
        return None if knew == self._stage.placed else GLIDE

    def _rest(self, at: Pose2, glide: float | None, look: bool = False) -> None:
        """Map 2 lies there from now on; whoever calls has the turn.

        glide : milliseconds in which the page takes it there; None where it did so by itself
        look  : the camera takes it in
        """
        self._at = at
        self._maps.carried(at)
        T = self._maps.layout.transform(at)
        with self._drawing:
            if glide is not None:
                self._stage.place_mov(at, glide)
            if look and self._host.follows:
                self._stage.look_down(self._maps.extent(), need=True)
            self._stage.flush()
        self.panel.show(T)
        self._work.ask((at, True))
        self._host.hand_moved(T)

    def _refine(self) -> None:
        with self._turn:
            if self.active and self._scales is not None:
                scales, T = self._scales, self._maps.layout.transform(self._at)
                self.end()
                self._host.hand_refines(scales, T)

    def _snap(self) -> None:
        with self._turn:
            if self.active:
                self.end()
                self._host.hand_snaps()

    def _take(self) -> None:
        with self._turn:
            if not self.active or self._scales is None:
                return
            try:
                result = self._scales.weigh(self._maps.layout.transform(self._at))
            except MapMergeError as error:
                self.panel.tell(box(str(error), "refused"))
                return
            self.end()
            self._host.hand_taken(result)

    # --- what the walls say -----------------------------------------------------------------------

    def _weigh(self, wanted: tuple[Pose2, bool]) -> None:
        """The colours at once; the verdict with them where it is quick, and always where the hand rests."""
        at, rests = wanted
        scales, walls = self._scales, self._walls
        if scales is None or walls is None:
            return
        T = self._maps.layout.transform(at)
        ref, mov = walls
        told = ref.agreement_with(mov, T.inverse()), mov.agreement_with(ref, T)
        with self._drawing:
            if not self.active or not self._host.on_map:
                return
            self._maps.touch(walls, told)
        if not rests and self._work.newer_within(REST if self._slow > PATIENCE else 0.0):
            return
        scales.value(T)  # what is made once for a pair of maps is not counted
        began = perf_counter()
        try:
            result = scales.weigh(T)
        except MapMergeError as error:
            with self._drawing:
                if self.active:
                    self.panel.tell(box(str(error), "refused"))
                    self._stage.hud(state=str(error), mood="refused")
                    self._stage.flush()
            return
        self._slow = perf_counter() - began
        with self._drawing:
            if not self.active:
                return
            self.panel.tell(weighed_html(result, scales.config, self._host.found))
            mood = words.mood(result.verdict)
            self._stage.hud(state=words.of_hand(result), mood=mood, progress=None)
            self._stage.flush()
