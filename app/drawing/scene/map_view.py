"""The view a person reads like a map: both maps where they lie, and the robots."""

from __future__ import annotations

import numpy as np
import viser

from algorithms.common.pose import FloatArray, Pose2
from algorithms.maps.grid_map import FREE, OCCUPIED_FROM
from algorithms.methods.steps import AugmentDetail
from algorithms.verdict.contradictions import Contradictions
from app.drawing.browser_messages import BrowserMessages
from app.drawing.palette import LIGHT, Palette
from app.drawing.scene import robot_symbols as signs
from app.drawing.scene.grid_image import Size
from app.drawing.scene.map_layers import LAID_OVER, MapLayers, Mode
from app.drawing.scene_layout import Rect, SceneLayout, known_hull
from app.model import status_text as words
from app.model.merge_inputs import MergeInputs
from app.model.run_state import RunState

SLIDE_MS = 330.0  # that map 2 takes from place to place
OF_A_RUN = ("aug", "window", "box", "swarm", "rival", "best", "matches")


class MapView:
    """Both maps and the robots, beside each other, over each other, or in a person's hand."""

    def __init__(self, client: viser.ClientHandle, messages: BrowserMessages, size: Size = LAID_OVER) -> None:
        self._messages = messages
        self.ground = MapLayers(client.scene, size, messages)
        self.inputs = MergeInputs()
        self.palette = LIGHT
        self.mov_at = Pose2()  # where map 2's anchor lies, and its turn; scene
        self.mode: Mode = "overlay"
        self.boxed: object = None  # the box that is drawn and looked at
        self.layout = SceneLayout((np.zeros(2), np.zeros(2)))

    # --- what was loaded --------------------------------------------------------------------------

    def load(self, inputs: MergeInputs, layout: SceneLayout, palette: Palette) -> None:
        """Show maps side by side, before any merge."""
        self.inputs, self.layout, self.palette = inputs, layout, palette
        self.ground.load(inputs.ref, inputs.mov, layout, palette)
        self.apart()

    def apart(self) -> None:
        """Put map 2 beside map 1, with nothing of a search over them, and look at both."""
        self.ground.show("sources")
        self.place(self.layout.apart, 0)
        self.clear(*OF_A_RUN)
        self.draw_robots(together=False)
        self._messages.look_down(self.layout.view(), follow=True)

    def turned(self, turn: float) -> None:
        """Turn map 2 where it lies beside map 1."""
        self.place(Pose2(self.layout.apart.x, self.layout.apart.y, turn), SLIDE_MS)

    def recolour(self, palette: Palette, run: RunState) -> None:
        """Draw everything again in other colours."""
        which, self.palette = self.ground.which, palette
        self.ground.load(self.inputs.ref, self.inputs.mov, self.layout, palette)
        self.ground.lift(run.get(AugmentDetail))
        self.ground.show(which)

    def visible(self, yes: bool) -> None:
        """Show or hide everything of this view; ink comes back with the next ``RunView.show``."""
        if yes:
            self.ground.show(self.ground.which)
            self.draw_robots(together=self.mov_at != self.layout.apart)
        else:
            self.ground.hide()
            self.clear(*OF_A_RUN, "robots", "sight", "grip")

    # --- map 2 in a person's hand -----------------------------------------------------------------

    def hold(self, at: Pose2, turns_only: bool = False) -> None:
        """Put map 2 in a person's hand, at a place of the scene; ``turns_only``: it can't be shifted."""
        mov = self.inputs.mov
        if mov is None:
            return
        self.ground.show("sources")
        self.clear(*OF_A_RUN)
        self.place(at, 0)
        self.draw_robots(together=True)
        hull = known_hull(mov) - self.layout.anchor_mov
        self._messages.layer("grip", signs.grip(hull, self.palette))
        how = {"arm": signs.TURN_ARM, "cell": mov.resolution, "still": turns_only}
        self._messages.hand({"mov": {"hull": hull, **how}})

    def let_go(self) -> None:
        """Nothing is in a person's hand."""
        self._messages.hand(None)
        self.clear("grip")
        if self.ground.which == "touching":
            self.ground.show("sources")

    @property
    def together(self) -> bool:
        """Whether map 2 lies over map 1, as it is."""
        return self.inputs.complete and self.ground.which != "levels" and self.mov_at != self.layout.apart

    def compare(self, mode: Mode, conflicts: Contradictions | None) -> None:
        """Show both maps in this way where they lie over each other; a rival would be one map too many."""
        self.mode = mode
        self.ground.compare(mode, conflicts)

    def extent(self) -> Rect:
        """Rectangle around both maps as they lie now."""
        return self.layout.view(self.mov_at)

    # --- parts ------------------------------------------------------------------------------------

    def read_out(self, place: FloatArray, run: RunState) -> str:
        """What both maps know of a place in the scene: coordinates, occupancy, level."""
        point = place + self.layout.anchor_ref
        there = self.mov_at.inverse().apply(place) + self.layout.anchor_mov
        ref, mov = self.inputs.ref, self.inputs.mov
        frame, at = 1, point
        if mov is not None and mov.contains(there) and not (ref is not None and ref.contains(point)):
            frame, at = 2, there
        parts = [f"x {at[0]:.2f} m, y {at[1]:.2f} m in map {frame}"]
        augmented = run.get(AugmentDetail)
        for number, grid, at in ((1, ref, point), (2, mov, there)):
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

    def draw_robots(self, together: bool, seen: bool = True) -> None:
        """Draw the robots and what they saw.

        together : map 2 lies on map 1
        seen     : whether the seen robot is drawn
        """
        at, mov = self.inputs.at, self.inputs.mov is not None
        if at is None or self.inputs.ref is None:
            self.clear("robots", "sight")
            return
        o, *_ = observations = self.inputs.observations
        here, colours = self.layout, self.palette
        self._messages.layer("robots", signs.robots(o, here, colours, mov, together, seen))
        further = signs.further(observations, self.inputs.encounters, here, colours, mov, together)
        sight = signs.sight(o, at, here, colours, apart=mov and not together, close=not seen)
        self._messages.layer("sight", further + sight)

    def place(self, at: Pose2, milliseconds: float) -> None:
        """Put map 2 at a place of the scene, gliding for so long."""
        if at != self.mov_at or milliseconds == 0:
            self.mov_at = at
            self._messages.place_map(2, at, milliseconds)

    def clear(self, *names: str) -> None:
        for name in names:
            self._messages.layer(name, None)
        if "rival" in names:
            self.ground.ghost(None)
        if "box" in names:
            self.boxed = None
