"""A run in the map view, step by step: levels, windows, candidates, the swarm, the proof, the answer."""

from __future__ import annotations

from typing import Any

import numpy as np

from algorithms.common.pose import Pose2
from algorithms.maps.map_fusion import Fusion
from algorithms.methods.merge_result import MergeResult
from algorithms.methods.steps import (
    AnswersDetail,
    AugmentDetail,
    CandidatesDetail,
    HoughDetail,
    MatchesDetail,
    PlaneDetail,
    ProofDetail,
    ProvenDetail,
    RefineDetail,
    ShiftDetail,
    TurnsDetail,
    WindowDetail,
)
from algorithms.observations.search_window import CoupledWindow
from app.drawing.browser_messages import BrowserMessages
from app.drawing.draw_items import cloud, mark
from app.drawing.palette import css
from app.drawing.scene import search_symbols as signs
from app.drawing.scene.map_layers import Which
from app.drawing.scene.map_view import OF_A_RUN, SLIDE_MS, MapView
from app.drawing.scene_layout import Rect, known_hull, union
from app.model import verdict_text as words
from app.model.run_state import RunState

TURN_MS, FOLLOW_MS = 900.0, 70.0
MOST_PARTICLES = 600  # drawn; more would be a blot


class RunView:
    """Draws the newest step of a run over both maps, and says where the camera goes."""

    def __init__(self, maps: MapView, messages: BrowserMessages) -> None:
        self._maps, self._messages = maps, messages

    def show(self, run: RunState, config: Any, camera: bool, live: bool) -> None:
        """Draw the newest state of a run.

        config : of the method that runs; Σ_aug is drawn from it
        camera : whether the camera goes along
        live   : the run is shown at a pace: map 2 glides from place to place
        """
        detail = run.last.detail if run.last else None
        self._maps.ground.lift(run.get(AugmentDetail))
        glide = 1.0 if live else 0.0
        look: Rect | None = None
        if isinstance(detail, (AugmentDetail, HoughDetail)):
            turn = detail.match.turns[0] if isinstance(detail, HoughDetail) else 0.0
            look = self._beside(turn, glide * TURN_MS, "levels")
            self._rings(config)
        elif isinstance(detail, (WindowDetail, ShiftDetail, CandidatesDetail)):
            look = self._candidates(run, glide)
        elif isinstance(detail, RefineDetail):
            look = self._refine(run, detail, glide)
        elif isinstance(detail, ProofDetail):
            look = self._prove(run, detail, glide)
        elif isinstance(detail, MatchesDetail):
            look = self._matches(detail)
        elif isinstance(detail, TurnsDetail):
            look = self._turned_best(detail, glide)
        elif isinstance(detail, PlaneDetail):
            look = self._best_places(detail, glide)
        elif isinstance(detail, (AnswersDetail, ProvenDetail, Fusion, MergeResult)):
            look = self._answer(run, glide)
        if camera and look is not None:
            self._messages.look_down(look)

    def preview(self, run: RunState, config: Any) -> None:
        """Draw what a moved slider does before there is a merge: levels, Σ_aug, windows, the box's size."""
        self._maps.ground.lift(run.get(AugmentDetail))
        self._beside(0.0, 0.0, "levels" if run.reached(AugmentDetail) else "sources")
        self._rings(config)
        box = getattr(config, "box", None)
        if box is not None:
            self._messages.layer("box", signs.margins(box.sigma_x, box.sigma_y, self._maps.palette))
        self._windows(run, self._maps.layout.view())

    def _windows(self, run: RunState, view: Rect) -> None:
        window, at_hand = run.get(WindowDetail), run.at_hand
        if window is None or self._maps.inputs.at is None:
            return
        turn = at_hand.T_ref_mov.theta if at_hand else 0.0
        layout, colours = self._maps.layout, self._maps.palette
        self._messages.layer("window", signs.windows(window, turn, layout, colours, view))

    def _rings(self, config: Any) -> None:
        augment = getattr(config, "augment", None)
        if augment is not None:
            self._messages.layer("aug", signs.rings(augment.covariance(), self._maps.palette))

    def _candidates(self, run: RunState, glide: float) -> Rect:
        colours, found = self._maps.palette, run.get(CandidatesDetail)
        self._maps.ground.show("sources")
        self._maps.clear("aug", "swarm", "rival", "best")
        self._windows(run, self._maps.layout.swept())
        tried = found.candidates if found else [shift.candidate for shift in run.shifts]
        places = [self._maps.layout.placed(candidate.T_ref_mov) for candidate in tried]
        marks = [mark("diamond", place.xy, colours.particle, r=5) for place in places]
        if found:
            marks[0] = mark("diamond", places[0].xy, colours.best, r=6)
        self._messages.layer("box", marks[::-1])  # the best on top
        if places:
            self._maps.place(places[0] if found else places[-1], glide * SLIDE_MS)
        self._maps.draw_robots(together=bool(places))
        return self._maps.layout.swept()

    def _matches(self, detail: MatchesDetail) -> Rect:
        """Both maps side by side, with lines between the features that look alike; once there is a transform,
        map 2 is turned by it, and the lines that agree run side by side.
        """
        look, maps = self._beside(detail.T_ref_mov.theta if detail.T_ref_mov else 0.0, 0.0), self._maps
        self._messages.layer("matches", signs.matches(detail, maps.mov_at, maps.layout, maps.palette))
        return look

    def _turned_best(self, detail: TurnsDetail, glide: float) -> Rect:
        """Map 2 beside map 1, turned as agrees best so far."""
        turn = detail.best
        if turn is None:
            tried = np.where(np.isfinite(detail.scores), detail.scores, -np.inf)
            turn = float(detail.turns[tried.argmax()])
        return self._beside(turn, glide * SLIDE_MS)

    def _best_places(self, detail: PlaneDetail, glide: float) -> Rect:
        """Map 2 at the best place so far, and where its anchor goes at all of them."""
        colours, layout = self._maps.palette, self._maps.layout
        self._maps.ground.show("sources")
        self._maps.clear(*OF_A_RUN)
        places = [layout.placed(Pose2.from_array(pose)) for pose in detail.poses]
        marks = [mark("diamond", place.xy, colours.particle, r=4) for place in places]
        if places:
            marks[0] = mark("diamond", places[0].xy, colours.best, r=6)
            self._maps.place(places[0], glide * SLIDE_MS)
        self._messages.layer("box", marks[::-1])  # the best on top
        self._maps.draw_robots(together=bool(places))
        return layout.swept()

    def _beside(self, turn: float, milliseconds: float, which: Which = "sources") -> Rect:
        turned = Pose2(self._maps.layout.apart.x, self._maps.layout.apart.y, turn)
        self._maps.ground.show(which)
        self._maps.place(turned, milliseconds)
        self._maps.clear(*OF_A_RUN)
        self._maps.draw_robots(together=False)
        return union(self._maps.layout.view(), self._maps.layout.view(turned))

    def _refine(self, run: RunState, detail: RefineDetail, glide: float) -> Rect | None:
        layout, colours, state = self._maps.layout, self._maps.palette, detail.state
        self._maps.ground.show("sources")
        self._maps.clear("aug", "rival")
        window = run.get(WindowDetail)
        coupled = window is not None and isinstance(window.window, CoupledWindow)
        discs = signs.discs(window.coupled, layout, colours, below=True) if window and coupled else None
        self._messages.layer("window", discs)
        best = layout.placed(detail.box.transform(state.best))
        self._maps.place(best, glide * FOLLOW_MS)
        self._maps.draw_robots(together=True, seen=False)  # the swarm's best stands there
        step = -(-len(state.poses) // MOST_PARTICLES)
        where = signs.seen_robot(detail.box.transforms(state.poses[::step]), layout)
        particles = cloud(where, colours.particle, r=2.6, alpha=0.8, glide=str(detail.index))
        self._messages.layer("swarm", [particles])
        self._messages.layer("best", [mark("diamond", best.xy, colours.best, r=6, rim="#ffffff")])
        if self._maps.boxed is detail.box:
            return None
        self._maps.boxed = detail.box
        self._messages.layer("box", signs.box(detail.box, layout, colours))
        return signs.footprint(detail.box, layout)

    def _prove(self, run: RunState, detail: ProofDetail, glide: float) -> Rect | None:
        self._maps.ground.show("sources")
        self._maps.clear("aug", "swarm", "box", "rival")
        if run.answer is None:
            return None
        at = self._maps.layout.placed(run.answer)
        self._maps.place(at, glide * SLIDE_MS)
        self._maps.draw_robots(together=True)
        self._messages.layer("window", signs.discs(detail.window, self._maps.layout, self._maps.palette))
        self._messages.layer("best", signs.proof(detail.state, self._maps.layout, self._maps.palette))
        return self._maps.layout.view(at)

    def _answer(self, run: RunState, glide: float) -> Rect | None:
        fusion, result = run.get(Fusion), run.get(MergeResult)
        if run.answer is None:
            return None
        at = self._maps.layout.placed(run.answer)
        self._maps.clear("aug", "window", "swarm", "box", "rival", "matches")
        self._maps.place(at, glide * SLIDE_MS)
        self._maps.draw_robots(together=True)
        star = mark("star", at.xy, self._maps.palette.answer, r=9, rim=css(self._maps.palette.rim))
        self._messages.layer("best", [star])
        if fusion is not None:
            self._maps.ground.merge(fusion)
        mov = self._maps.inputs.mov
        if result is None or result.verdict.rival is None or mov is None or self._maps.mode != "overlay":
            return self._maps.layout.view(at)
        rival = self._maps.layout.placed(result.verdict.rival)
        self._maps.ground.ghost(rival)
        seen = next(iter(self._maps.inputs.observations), None)
        hull = known_hull(mov) - self._maps.layout.anchor_mov
        doubt = signs.rival(rival, hull, seen, words.rival(result), self._maps.palette)
        self._messages.layer("rival", doubt)
        return union(self._maps.layout.view(at), self._maps.layout.view(rival))
