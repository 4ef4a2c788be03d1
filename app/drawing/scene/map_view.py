"""The view a person reads like a map: both maps, robots, what the search tries, what came out."""

from __future__ import annotations

from typing import Any

import numpy as np
import viser

from algorithms.common.pose import FloatArray, Pose2
from algorithms.maps.grid_map import FREE, OCCUPIED_FROM
from algorithms.maps.map_fusion import Fusion
from algorithms.methods.merge_result import MergeResult
from algorithms.methods.steps import (
    AnswersDetail,
    AugmentDetail,
    CandidatesDetail,
    HoughDetail,
    MatchesDetail,
    ProofDetail,
    ProvenDetail,
    RefineDetail,
    ShiftDetail,
    TurnsDetail,
    WindowDetail,
)
from algorithms.observations.search_window import CoupledWindow
from algorithms.verdict.cell_agreement import CellAgreement, WallLookup
from algorithms.verdict.contradictions import Contradictions
from app.drawing.browser_messages import BrowserMessages
from app.drawing.draw_items import cloud, mark
from app.drawing.palette import LIGHT, Palette, css
from app.drawing.scene import search_symbols as signs
from app.drawing.scene.grid_image import Size
from app.drawing.scene.map_layers import LAID_OVER, MapLayers, Mode
from app.drawing.scene_layout import Rect, SceneLayout, known_hull, union
from app.model import status_text as words
from app.model.merge_inputs import MergeInputs
from app.model.run_state import RunState

TURN_MS, SLIDE_MS, FOLLOW_MS = 900.0, 330.0, 70.0
MOST_PARTICLES = 600  # drawn; more would be a blot
OF_A_RUN = ("aug", "window", "box", "swarm", "rival", "best", "matches")


class MapView:
    """Draws a story over the ground, and says where the camera goes."""

    def __init__(self, client: viser.ClientHandle, stage: BrowserMessages, size: Size = LAID_OVER) -> None:
        self._stage = stage
        self.ground = MapLayers(client.scene, size, stage)
        self._inputs = MergeInputs()
        self._palette = LIGHT
        self._mov_at = Pose2()
        self._mode: Mode = "overlay"
        self._boxed: object = None  # the box that is drawn and looked at
        self.layout = SceneLayout(np.zeros(2), np.zeros(2), None, None, Pose2())

    # --- what was loaded --------------------------------------------------------------------------

    def load(self, inputs: MergeInputs, layout: SceneLayout, palette: Palette) -> None:
        """Show maps side by side, before any merge."""
        self._inputs, self.layout, self._palette = inputs, layout, palette
        self.ground.load(inputs.ref, inputs.mov, layout, palette)
        self.apart()

    def apart(self) -> None:
        """Put map 2 beside map 1, with nothing of a search over them, and look at both."""
        self.ground.show("sources")
        self._place(self.layout.apart, 0)
        self._clear(*OF_A_RUN)
        self._robots(together=False)
        self._stage.look_down(self.layout.view(), follow=True)

    def turned(self, turn: float) -> None:
        """Turn map 2 where it lies beside map 1."""
        self._place(Pose2(self.layout.apart.x, self.layout.apart.y, turn), SLIDE_MS)

    def recolour(self, palette: Palette, story: RunState) -> None:
        """Draw everything again in other colours."""
        which, self._palette = self.ground.which, palette
        self.ground.load(self._inputs.ref, self._inputs.mov, self.layout, palette)
        self.ground.lift(story.get(AugmentDetail))
        self.ground.show(which)

    def visible(self, yes: bool) -> None:
        """Show or hide everything of this view; ink comes back with the next ``show``."""
        if yes:
            self.ground.show(self.ground.which)
            self._robots(together=self._mov_at != self.layout.apart)
        else:
            self.ground.hide()
            self._clear(*OF_A_RUN, "robots", "sight", "grip")

    # --- map 2 in a person's hand -----------------------------------------------------------------

    @property
    def mov_at(self) -> Pose2:
        """Where map 2's anchor lies, and its turn; scene."""
        return self._mov_at

    def hold(self, at: Pose2) -> None:
        """Put map 2 in a person's hand, at a place of the scene."""
        mov = self._inputs.mov
        if mov is None:
            return
        self.ground.show("sources")
        self._clear(*OF_A_RUN)
        self._place(at, 0)
        self._robots(together=True)
        hull = known_hull(mov) - self.layout.anchor_mov
        self._stage.layer("grip", signs.grip(hull, self._palette))
        self._stage.hand({"mov": {"hull": hull, "arm": signs.TURN_ARM, "cell": mov.resolution}})

    def carried(self, at: Pose2) -> None:
        """The page has moved map 2 by itself."""
        self._mov_at = at

    def touch(self, walls: tuple[WallLookup, WallLookup], told: tuple[CellAgreement, CellAgreement]) -> None:
        """Show which walls coincide and which are denied; see ``MapLayers.touch``."""
        self.ground.touch(walls, told)

    def let_go(self) -> None:
        """Nothing is in a person's hand."""
        self._stage.hand(None)
        self._clear("grip")
        if self.ground.which == "touching":
            self.ground.show("sources")

    @property
    def together(self) -> bool:
        """Whether map 2 lies over map 1, as it is."""
        return self._inputs.complete and self.ground.which != "levels" and self._mov_at != self.layout.apart

    def compare(self, mode: Mode, conflicts: Contradictions | None) -> None:
        """Show both maps in this way where they lie over each other; a rival would be one map too many."""
        self._mode = mode
        self.ground.compare(mode, conflicts)

    def extent(self) -> Rect:
        """Rectangle around both maps as they lie now."""
        return self.layout.view(self._mov_at)

    # --- a run ------------------------------------------------------------------------------------

    def show(self, story: RunState, config: Any, camera: bool, live: bool) -> None:
        """Draw the newest state of a run.

        config : of the method that runs; Σ_aug is drawn from it
        camera : whether the camera goes along
        live   : the run is told at a pace: map 2 glides from place to place
        """
        detail = story.last.detail if story.last else None
        self.ground.lift(story.get(AugmentDetail))
        glide = 1.0 if live else 0.0
        look: Rect | None = None
        if isinstance(detail, (AugmentDetail, HoughDetail)):
            look = self._lifted(detail.match.turns[0] if isinstance(detail, HoughDetail) else 0.0, glide)
            self._rings(config)
        elif isinstance(detail, (WindowDetail, ShiftDetail, CandidatesDetail)):
            look = self._candidates(story, glide)
        elif isinstance(detail, RefineDetail):
            look = self._refine(story, detail, glide)
        elif isinstance(detail, ProofDetail):
            look = self._prove(story, detail, glide)
        elif isinstance(detail, MatchesDetail):
            look = self._matches(detail)
        elif isinstance(detail, TurnsDetail):
            look = self._turned_best(detail, glide)
        elif isinstance(detail, (AnswersDetail, ProvenDetail, Fusion, MergeResult)):
            look = self._answer(story, glide)
        if camera and look is not None:
            self._stage.look_down(look)

    def preview(self, story: RunState, config: Any) -> None:
        """Draw what a moved slider does before there is a merge: levels, Σ_aug, windows, the box's size."""
        self.ground.lift(story.get(AugmentDetail))
        self._lifted(0.0, 0.0)
        if not story.reached(AugmentDetail):  # a method without levels
            self.ground.show("sources")
        self._rings(config)
        box = getattr(config, "box", None)
        if box is not None:
            self._stage.layer("box", signs.margins(box.sigma_x, box.sigma_y, self._palette))
        self._windows(story, self.layout.view())

    def _windows(self, story: RunState, view: Rect) -> None:
        window, found = story.get(WindowDetail), story.get(CandidatesDetail)
        if window is None or self._inputs.at is None:
            return
        at_hand = found.candidates[0] if found else story.shifts[-1].candidate if story.shifts else None
        turn = at_hand.T_ref_mov.theta if at_hand else 0.0
        drawn = signs.windows(window, turn, self.layout, self._palette, view)
        self._stage.layer("window", drawn)

    def _lifted(self, turn: float, glide: float) -> Rect:
        turned = Pose2(self.layout.apart.x, self.layout.apart.y, turn)
        self.ground.show("levels")
        self._place(turned, glide * TURN_MS)
        self._clear(*OF_A_RUN)
        self._robots(together=False)
        return union(self.layout.view(), self.layout.view(turned))

    def _rings(self, config: Any) -> None:
        augment = getattr(config, "augment", None)
        if augment is not None:
            self._stage.layer("aug", signs.rings(augment.covariance(), self._palette, both=True))

    def _candidates(self, story: RunState, glide: float) -> Rect:
        colours, found = self._palette, story.get(CandidatesDetail)
        self.ground.show("sources")
        self._clear("aug", "swarm", "rival", "best")
        self._windows(story, self.layout.swept())
        tried = found.candidates if found else [shift.candidate for shift in story.shifts]
        places = [self.layout.placed(candidate.T_ref_mov) for candidate in tried]
        marks = [mark("diamond", place.xy, colours.particle, r=5) for place in places]
        if found:
            marks[0] = mark("diamond", places[0].xy, colours.best, r=6)
        self._stage.layer("box", marks[::-1])  # the best on top
        if places:
            self._place(places[0] if found else places[-1], glide * SLIDE_MS)
        self._robots(together=bool(places))
        return self.layout.swept()

    def _matches(self, detail: MatchesDetail) -> Rect:
        """Both maps side by side, with lines between the features that look alike; once there is a transform,
        map 2 is turned by it, and the lines that agree run side by side.
        """
        look = self._beside(detail.T_ref_mov.theta if detail.T_ref_mov is not None else 0.0, 0.0)
        self._stage.layer("matches", signs.matches(detail, self._mov_at, self.layout, self._palette))
        return look

    def _turned_best(self, detail: TurnsDetail, glide: float) -> Rect:
        """Map 2 beside map 1, turned as agrees best so far."""
        tried = np.isfinite(detail.scores)
        turn = detail.best
        if turn is None:
            turn = float(detail.turns[np.nanargmax(np.where(tried, detail.scores, -np.inf))])
        return self._beside(turn, glide * SLIDE_MS)

    def _beside(self, turn: float, milliseconds: float) -> Rect:
        turned = Pose2(self.layout.apart.x, self.layout.apart.y, turn)
        self.ground.show("sources")
        self._place(turned, milliseconds)
        self._clear(*OF_A_RUN)
        self._robots(together=False)
        return union(self.layout.view(), self.layout.view(turned))

    def _refine(self, story: RunState, detail: RefineDetail, glide: float) -> Rect | None:
        layout, colours, state = self.layout, self._palette, detail.state
        self.ground.show("sources")
        self._clear("aug", "rival")
        window = story.get(WindowDetail)
        coupled = window is not None and isinstance(window.window, CoupledWindow)
        discs = signs.discs(window.coupled, layout, colours, below=True) if window and coupled else None
        self._stage.layer("window", discs)
        best = layout.placed(detail.box.transform(state.best))
        self._place(best, glide * FOLLOW_MS)
        self._robots(together=True, seen=False)  # the swarm's best stands there
        step = -(-len(state.poses) // MOST_PARTICLES)
        where = signs.seen_robot(detail.box.transforms(state.poses[::step]), layout)
        particles = cloud(where, colours.particle, r=2.6, alpha=0.8, glide=str(detail.index))
        self._stage.layer("swarm", [particles])
        self._stage.layer("best", [mark("diamond", best.xy, colours.best, r=6, rim="#ffffff")])
        if self._boxed is detail.box:
            return None
        self._boxed = detail.box
        self._stage.layer("box", signs.box(detail.box, layout, colours))
        return signs.footprint(detail.box, layout)

    def _prove(self, story: RunState, detail: ProofDetail, glide: float) -> Rect | None:
        self.ground.show("sources")
        self._clear("aug", "swarm", "box", "rival")
        if story.answer is None:
            return None
        at = self.layout.placed(story.answer)
        self._place(at, glide * SLIDE_MS)
        self._robots(together=True)
        self._stage.layer("window", signs.discs(detail.window, self.layout, self._palette))
        self._stage.layer("best", signs.proof(detail.state, self.layout, self._palette))
        return self.layout.view(at)

    def _answer(self, story: RunState, glide: float) -> Rect | None:
        fusion, result = story.get(Fusion), story.get(MergeResult)
        if story.answer is None:
            return None
        at = self.layout.placed(story.answer)
        self._clear("aug", "window", "swarm", "box", "rival", "matches")
        self._place(at, glide * SLIDE_MS)
        self._robots(together=True)
        star = mark("star", at.xy, self._palette.answer, r=9, rim=css(self._palette.rim))
        self._stage.layer("best", [star])
        if fusion is not None:
            self.ground.merge(fusion)
        mov = self._inputs.mov
        if result is None or result.verdict.rival is None or mov is None or self._mode != "overlay":
            return self.layout.view(at)
        rival = self.layout.placed(result.verdict.rival)
        self.ground.ghost(rival)
        heading = self._inputs.observations[0].observed_heading
        hull = known_hull(mov) - self.layout.anchor_mov
        doubt = signs.rival(rival, hull, heading, words.rival(result), self._palette)
        self._stage.layer("rival", doubt)
        return union(self.layout.view(at), self.layout.view(rival))

    # --- parts ------------------------------------------------------------------------------------

    def read_out(self, place: FloatArray, story: RunState) -> str:
        """What both maps know of a place in the scene: coordinates, occupancy, level."""
        point = place + self.layout.anchor_ref
        there = self._mov_at.inverse().apply(place) + self.layout.anchor_mov
        ref, mov = self._inputs.ref, self._inputs.mov
        frame, at = 1, point
        if mov is not None and mov.contains(there) and not (ref is not None and ref.contains(point)):
            frame, at = 2, there
        parts = [f"x {at[0]:.2f} m, y {at[1]:.2f} m in map {frame}"]
        augmented = story.get(AugmentDetail)
        for number, grid, at in ((1, self._inputs.ref, point), (2, self._inputs.mov, there)):
            if grid is None:
                continue
            value = grid.value_at(at)
            word = "unknown" if value < FREE else "wall" if value >= OCCUPIED_FROM else "free"
            if word == "wall" and augmented is not None:
                lifted = augmented.ref if number == 1 else augmented.mov
                col, row = np.floor(grid.grid_coordinates(at)).astype(int)
                level = lifted.levels[(lifted.rows == row) & (lifted.cols == col)]
                word += f", level {float(level.sum()):.3g} (eq. 4)"
            parts.append(f"map {number}: {word}")
        return words.typeset(" · ".join(parts))

    def _robots(self, together: bool, seen: bool = True) -> None:
        at, mov = self._inputs.at, self._inputs.mov is not None
        if at is None or self._inputs.ref is None:
            self._clear("robots", "sight")
            return
        o, *_ = told = self._inputs.observations
        here, colours = self.layout, self._palette
        self._stage.layer("robots", signs.robots(o, here, colours, mov, together, seen))
        further = signs.further(told, self._inputs.encounters, here, colours, mov, together)
        sight = signs.sight(o, at, here, colours, mov, together, close=not seen)
        self._stage.layer("sight", further + sight)

    def _place(self, at: Pose2, milliseconds: float) -> None:
        if at != self._mov_at or milliseconds == 0:
            self._mov_at = at
            self._stage.place_mov(at, milliseconds)

    def _clear(self, *names: str) -> None:
        for name in names:
            self._stage.layer(name, None)
        if "rival" in names:
            self.ground.ghost(None)
        if "box" in names:
            self._boxed = None
