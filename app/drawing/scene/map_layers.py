"""The flat pictures that the map view stands on: both maps, their levels, the merged map."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from math import cos, sin
from typing import Any, Literal

import viser

from algorithms.common.pose import Pose2
from algorithms.maps.grid_map import GridMap
from algorithms.maps.map_fusion import Fusion
from algorithms.methods.steps import AugmentDetail
from algorithms.verdict.cell_agreement import CellAgreement, WallLookup
from algorithms.verdict.contradictions import Contradictions, near_walls
from app.drawing import grid_pixels as render
from app.drawing.browser_messages import BrowserMessages
from app.drawing.draw_items import path
from app.drawing.palette import Palette
from app.drawing.scene.grid_image import Closer, GridImage, Size
from app.drawing.scene.zoom_crop import CameraView
from app.drawing.scene_layout import SceneLayout

Which = Literal["sources", "levels", "merged", "touching"]
# how two maps are compared where they lie; "result" is what came of them
Mode = Literal["overlay", "blink", "curtain", "difference", "result"]

# Heights in the order they lie on each other; all floors are below all walls, so that a map that
# slides over the other hides none of its walls.
FREE_1, FREE_2, WALLS_1, WALLS_2, MERGED_FREE, MERGED_WALLS, GHOST = 0.0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6
# of a large map only what is looked at closely is sent in cells of its own: see app/page/zoom_controller.py
LAID_OVER = Size(whole=render.MOST_PIXELS, pooled=1024)
GHOSTLY = 60  # of 255; twice as much on the page, which makes thin walls darker


class MapLayers:
    """Map 1 lies still; map 2 hangs on the frame /world/map2, which the page turns and slides."""

    def __init__(
        self, scene: viser.SceneApi, size: Size = LAID_OVER, messages: BrowserMessages | None = None
    ) -> None:
        """stage : where excerpts of the pictures are seen."""
        self.changed: Callable[[], Any] = lambda: None  # is called after every change of what is shown
        self.corrected: Callable[[], GridMap | None] = lambda: None  # the merged map as it is given away

        def image(name: str, height: float) -> GridImage:
            return GridImage(scene, f"/world/{name}", height, size, messages)

        def images(name: str, *heights: float) -> tuple[GridImage, ...]:
            """One of every map."""
            return tuple(image(f"map{number}/{name}", height) for number, height in enumerate(heights, 1))

        # viser turns a y-up scene half round its y axis; undone here, scene and page agree
        scene.add_frame("/world", show_axes=False, wxyz=(0.0, 0.0, 1.0, 0.0))
        scene.add_frame("/world/map1", show_axes=False)
        scene.add_frame("/world/map2", show_axes=False)
        self._free = images("free", FREE_1, FREE_2)
        self._walls = images("walls", WALLS_1, WALLS_2)
        self._levels = images("levels", WALLS_1, WALLS_2)
        self._merged = image("map1/merged_free", MERGED_FREE), image("map1/merged_walls", MERGED_WALLS)
        self._denied = image("map1/denied", MERGED_WALLS)
        self._result = image("map1/result_free", MERGED_FREE), image("map1/result_walls", MERGED_WALLS)
        self._touches = images("touches", MERGED_FREE, MERGED_WALLS)
        self._ghost_frame = scene.add_frame("/world/ghost", show_axes=False)
        self._ghost = image("ghost/walls", GHOST)
        self._haunted: GridMap | None = None  # whose walls the ghost is made of
        self._ghost_at: Pose2 | None = None
        several = (*self._free, *self._walls, *self._levels, *self._merged, *self._touches)
        self._all = (*several, *self._result, self._denied, self._ghost)
        self._shown: tuple[GridMap | None, ...] = (None, None)
        self._layout: SceneLayout | None = None
        self._palette: Palette | None = None
        self._lifted: AugmentDetail | None = None
        self._fused: Fusion | None = None
        self._conflicts: Contradictions | None = None
        self._contrasted: Contradictions | None = None  # those that are drawn
        self._given: GridMap | None = None  # the corrected map that is drawn
        self._messages = messages
        self._edged: tuple[GridMap, Palette] | None = None  # around which a line is drawn
        self._mode: Mode = "overlay"
        self.which: Which = "sources"
        self._hidden = False

    def load(self, ref: GridMap | None, mov: GridMap | None, layout: SceneLayout, palette: Palette) -> None:
        """Draw two maps; what was there before is gone. A map that was there already is only moved."""
        grids = (ref, mov)
        old = self._shown if palette is self._palette else (None, None)
        same = [grid is not None and grid is before for grid, before in zip(grids, old, strict=True)]
        stay = [image for k in range(len(grids)) if same[k] for image in (self._free[k], self._walls[k])]
        for image in self._all:
            if image not in stay:
                image.remove()
        self._shown = grids
        self._layout, self._palette, self._lifted, self._fused = layout, palette, None, None
        self._haunted = self._contrasted = self._given = None
        for k, (grid, anchor) in enumerate(zip(grids, layout.anchors, strict=True)):
            if same[k]:
                self._free[k].move(anchor)
                self._walls[k].move(anchor)
            elif grid is not None:
                self._free[k].show(partial(render.floor, grid.cells, palette), grid, anchor)
                self._walls[k].show(partial(render.walls, grid.cells, palette.maps[k]), grid, anchor)
        self.show("sources")

    def lift(self, detail: AugmentDetail | None) -> None:
        """Have the pictures of these levels at hand."""
        if detail is None or detail is self._lifted or self._layout is None or self._palette is None:
            return
        self._lifted = detail
        lifted, anchors = (detail.ref, detail.mov), self._layout.anchors
        for image, augmented, anchor in zip(self._levels, lifted, anchors, strict=True):
            image.show(partial(render.levels, augmented, self._palette), augmented.grid, anchor)
        self.show(self.which)

    def merge(self, fusion: Fusion) -> None:
        if fusion is not self._fused and self._layout is not None and self._palette is not None:
            if self._fused is not None:
                self._conflicts = None  # they were of the other one
            self._fused = fusion
            floor, walls = self._merged
            for image, draw in (
                (floor, partial(render.merged_floor, fusion, self._palette)),
                (walls, partial(render.merged_walls, fusion, near_walls(fusion), self._palette)),
            ):
                image.show(draw, fusion.merged, self._layout.anchor_ref)
        self.show("merged")

    def compare(self, mode: Mode, conflicts: Contradictions | None) -> None:
        """Show both maps in this way where they lie; without conflicts there is no difference to show."""
        self._mode, self._conflicts = mode, conflicts
        if not self._hidden:
            self.show(self.which)

    def _contrast(self) -> bool:
        """Have the picture of what contradicts at hand; whether there is one."""
        found, fusion = self._conflicts, self._fused
        if found is None or fusion is None or self._palette is None or self._layout is None:
            return False
        if found is not self._contrasted:
            self._contrasted = found
            draw = partial(render.denied_walls, fusion, found, self._palette)
            self._denied.show(draw, fusion.merged, self._layout.anchor_ref)
        return True

    def _draw_result(self) -> bool:
        """Have the picture of the corrected map at hand; whether there is one."""
        grid, before = self.corrected(), self._given
        if grid is None or self._palette is None or self._layout is None:
            return False
        if grid is not before:
            same = before and before.origin == grid.origin and before.cells.shape == grid.cells.shape
            draws = (
                partial(render.floor, grid.cells, self._palette),
                partial(render.walls, grid.cells, self._palette.agreed),
            )
            for image, draw in zip(self._result, draws, strict=True):
                (image.repaint if same else image.show)(draw, grid, self._layout.anchor_ref)
            self._given = grid
        return True

    def touch(
        self, walls: tuple[WallLookup, WallLookup], agreement: tuple[CellAgreement, CellAgreement]
    ) -> None:
        """Show which walls of both maps coincide, and which the other one denies."""
        if self._layout is None or self._palette is None:
            return
        for image, one, touch, anchor in zip(
            self._touches, walls, agreement, self._layout.anchors, strict=True
        ):
            image.repaint(partial(render.touches, one, touch, self._palette), one.grid, anchor)
        if self.which != "touching":
            self.show("touching")
        self.changed()

    def ghost(self, at: Pose2 | None) -> None:
        """Show map 2's walls faintly with its anchor at another place of the scene; None: nowhere."""
        mov = self._shown[1]
        if at is not None and mov is not None and self._layout is not None and self._palette:
            if self._haunted is not mov:
                self._haunted = mov
                faint = partial(render.walls, mov.cells, self._palette.rival, GHOSTLY)
                self._ghost.show(faint, mov, self._layout.anchor_mov)
            self._ghost_frame.position = (at.x, at.y, 0.0)
            self._ghost_frame.wxyz = (cos(at.theta / 2), 0.0, 0.0, sin(at.theta / 2))
        self._ghost_at = at
        self._show_ghost()

    def show(self, which: Which) -> None:
        """Show one set of pictures and hide the others."""
        self.which, self._hidden = which, False
        floor, walls = self._merged
        seen: str = which
        if which != "levels" and self._mode in ("blink", "curtain"):
            seen = "sources"
        elif which == "merged" and self._mode == "difference" and self._contrast():
            seen = "difference"
        elif which == "merged" and self._mode == "result" and self._draw_result():
            seen = "result"
        for images, among in (
            (self._free, ("sources", "levels", "touching")),
            (self._walls, ("sources", "touching")),
            (self._touches, ("touching",)),
            (self._levels, ("levels",)),
            ((floor,), ("merged", "difference")),
            ((walls,), ("merged",)),
            ((self._denied,), ("difference",)),
            (self._result, ("result",)),
        ):
            for image in images:
                image.visible(seen in among)
        self._draw_edge(seen == "result")
        self._show_ghost()

    def _draw_edge(self, yes: bool) -> None:
        """A line around the corrected map, whose unknown cells look like what lies beside it; or none."""
        edged = (self._given, self._palette) if yes and self._given and self._palette else None
        if self._messages is None or self._layout is None or edged == self._edged:
            return
        line = None
        if edged is not None:
            grid, palette = edged
            corners = grid.corners() - self._layout.anchor_ref
            line = [path(corners, palette.margin, close=True, d=[5, 5], w=1)]
        self._messages.layer("edge", line)
        self._edged = edged

    def _show_ghost(self) -> None:
        self._ghost.visible(self._ghost_at is not None and self._mode == "overlay")
        self.changed()

    def closer(self, view: CameraView) -> list[Closer]:
        """The excerpts that this view lacks, or has no use for any more."""
        at = {"map1": Pose2(), "map2": view.mov, "ghost": self._ghost_at or Pose2()}
        found = (image.closer(view, at[image.name.split("/")[2]]) for image in self._all)
        return [closer for closer in found if closer is not None]

    def hide(self) -> None:
        """Hide everything; ``show(self.which)`` brings it back."""
        self._hidden = True
        for image in self._all:
            image.visible(False)
        self._draw_edge(False)
