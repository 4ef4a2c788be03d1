"""The view a person reads like a map: both maps, robots, what the search tries, what came out."""

from __future__ import annotations

from math import cos, pi, sin
from typing import Any

import numpy as np
import viser

from algorithms.fuse import Fusion
from algorithms.gridmap import FREE, OCCUPIED_FROM, GridMap
from algorithms.observation import Encounter, Observation
from algorithms.pose import FloatArray, Pose2
from algorithms.steps import (
    AnswersDetail,
    AugmentDetail,
    CandidatesDetail,
    HoughDetail,
    MergeResult,
    RefineDetail,
    ShiftDetail,
    WindowDetail,
)
from algorithms.window import Box
from app import render
from app.layout import Layout, Rect, union
from app.palette import Palette
from app.stage import Item, Stage, cloud, ellipse, mark, path, rectangle
from app.story import Story
from app.views.images import GridImage

# Heights of the flat pictures; far apart for the depth buffer, nothing for a camera far above.
FREE_1, FREE_2, WALLS_1, WALLS_2, MERGED_FREE, MERGED_WALLS = 0.0, 0.1, 0.2, 0.3, 0.4, 0.5
TURN_MS, SLIDE_MS = 900.0, 330.0
MOST_PARTICLES = 600  # drawn; more would be a blot


class MapView:
    """Map 1 lies still; map 2 hangs on the frame /world/mov, which the page turns and slides."""

    def __init__(self, client: viser.ClientHandle, stage: Stage) -> None:
        scene = client.scene
        self._stage = stage
        # viser turns a y-up scene half round its y axis; undone here, scene and page agree
        scene.add_frame("/world", show_axes=False, wxyz=(0.0, 0.0, 1.0, 0.0))
        scene.add_frame("/world/ref", show_axes=False)
        scene.add_frame("/world/mov", show_axes=False)
        self._free_1 = GridImage(scene, "/world/ref/free", FREE_1)
        self._free_2 = GridImage(scene, "/world/mov/free", FREE_2)
        self._walls_1 = GridImage(scene, "/world/ref/walls", WALLS_1)
        self._walls_2 = GridImage(scene, "/world/mov/walls", WALLS_2)
        self._levels_1 = GridImage(scene, "/world/ref/levels", WALLS_1)
        self._levels_2 = GridImage(scene, "/world/mov/levels", WALLS_2)
        self._merged = (
            GridImage(scene, "/world/ref/merged_free", MERGED_FREE),
            GridImage(scene, "/world/ref/merged_walls", MERGED_WALLS),
        )
        self._sources = (self._free_1, self._free_2, self._walls_1, self._walls_2)
        self._levels = (self._levels_1, self._levels_2)
        self.layout = Layout(np.zeros(2), np.zeros(2), None, None, Pose2())
        self._ref: GridMap | None = None
        self._mov: GridMap | None = None
        self._observation: Observation | None = None
        self._at: Encounter | None = None
        self._palette: Palette | None = None
        self._drawn: dict[str, object] = {}
        self._mov_at = Pose2()

    # --- what was loaded --------------------------------------------------------------------------

    def load(
        self,
        ref: GridMap | None,
        mov: GridMap | None,
        observation: Observation | None,
        at: Encounter | None,
        layout: Layout,
        palette: Palette,
    ) -> None:
        """Show maps side by side, before any merge."""
        self._ref, self._mov, self._observation, self._at = ref, mov, observation, at
        self.layout, self._palette = layout, palette
        self._drawn.clear()
        for image in (*self._sources, *self._levels, *self._merged):
            image.remove()
        if ref:
            self._free_1.show(render.floor(ref.cells, palette), ref, layout.anchor_ref)
            self._walls_1.show(render.walls(ref.cells, palette.ref), ref, layout.anchor_ref)
        if mov:
            self._free_2.show(render.floor(mov.cells, palette), mov, layout.anchor_mov)
            self._walls_2.show(render.walls(mov.cells, palette.mov), mov, layout.anchor_mov)
        self.apart(follow=True)

    def apart(self, follow: bool = False, milliseconds: float = 0) -> None:
        """Put map 2 beside map 1, and nothing of a search over them."""
        self._show_images("sources")
        self._place(self.layout.apart, milliseconds)
        for name in ("aug", "window", "box", "swarm", "trail", "best"):
            self._stage.layer(name, None)
        self._robots(together=False)
        self._stage.look_down(self.layout.view(), follow)

    def visible(self, yes: bool) -> None:
        """Show or hide everything of this view."""
        which = str(self._drawn.get("images", "sources"))
        if yes:
            self._show_images(which, force=True)
            return
        for image in (*self._sources, *self._levels, *self._merged):
            image.visible(False)
        for name in ("aug", "window", "box", "swarm", "trail", "best", "robots", "sight"):
            self._stage.layer(name, None)

    def redraw(self, story: Story) -> None:
        """Ink again, after another view had the page."""
        self._drawn.pop("box", None)
        if story.last is None or story.get(CandidatesDetail) is None:
            self._robots(together=False)

    def recolour(self, palette: Palette) -> None:
        """Draw everything again in other colours."""
        which, drawn, mov_at = self._drawn.get("images", "sources"), dict(self._drawn), self._mov_at
        self.load(self._ref, self._mov, self._observation, self._at, self.layout, palette)
        self._augmentation(drawn.get("augmented"))  # type: ignore[arg-type]
        self._show_images(str(which), force=True)
        self._place(mov_at, 0)

    def extent(self) -> Rect:
        """Rectangle around both maps as they lie now."""
        return self.layout.view(self._mov_at)

    # --- a run ------------------------------------------------------------------------------------

    def show(self, story: Story, camera: bool, live: bool) -> None:
        """Draw the newest state of a run.

        camera : whether the camera goes along
        live   : the run is told at a pace: map 2 glides from place to place
        """
        detail = story.last.detail if story.last else None
        glide = 1.0 if live else 0.0
        augmented = story.get(AugmentDetail)
        self._augmentation(augmented)
        if isinstance(detail, (AugmentDetail, HoughDetail)):
            turn = detail.match.turns[0] if isinstance(detail, HoughDetail) else 0.0
            self._lifted(turn, glide)
            if camera:
                turned = Pose2(self.layout.apart.x, self.layout.apart.y, turn)
                self._stage.look_down(union(self.layout.view(), self.layout.view(turned)))
        elif isinstance(detail, (WindowDetail, ShiftDetail, CandidatesDetail)):
            self._candidates(story, glide, camera)
        elif isinstance(detail, RefineDetail):
            self._refine(detail, glide, camera)
        elif isinstance(detail, (AnswersDetail, Fusion, MergeResult)):
            self._answer(story, glide, camera)

    def preview(self, story: Story, config: Any) -> None:
        """Draw what a moved slider does before there is a merge: levels, Σ_aug, the box's size."""
        self._augmentation(story.get(AugmentDetail))
        self._lifted(0.0, 0.0)
        box = getattr(config, "box", None)
        if self._palette is not None and box is not None:
            half = np.array([box.sigma_x, box.sigma_y])
            label = {"t": "± σ_x, ± σ_y", "tp": np.array([-half[0], half[1]]), "dy": -9, "align": "right"}
            corners = rectangle(-half, half)
            self._stage.layer(
                "box", [path(corners, self._palette.margin, close=True, d=[6, 4], halo=True, **label)]
            )

    def _lifted(self, turn: float, glide: float) -> None:
        self._show_images("levels")
        self._place(Pose2(self.layout.apart.x, self.layout.apart.y, turn), glide * TURN_MS)
        self._robots(together=False)
        self._clear("window", "box", "swarm", "trail", "best")

    def _augmentation(self, detail: AugmentDetail | None) -> None:
        if detail is None or self._palette is None or self._drawn.get("augmented") is detail:
            return
        self._drawn["augmented"] = detail
        layout = self.layout
        self._levels_1.show(render.levels(detail.ref, self._palette), detail.ref.grid, layout.anchor_ref)
        self._levels_2.show(render.levels(detail.mov, self._palette), detail.mov.grid, layout.anchor_mov)
        self._show_images(str(self._drawn.get("images", "sources")), force=True)

    def rings(self, config: Any, story: Story) -> None:
        """Σ_aug around the meeting place in both maps: one and two standard deviations."""
        detail = story.last.detail if story.last else None
        group = getattr(config, "augment", None)
        wanted = isinstance(detail, (AugmentDetail, HoughDetail, CandidatesDetail))
        if self._palette is None or self._at is None or group is None or not wanted:
            self._clear("aug")
            return
        together = isinstance(detail, CandidatesDetail) and self._drawn.get("images") != "levels"
        items = []
        for frame in ("scene",) if together else ("scene", "mov"):
            for k in (1, 2):
                points = ellipse(np.zeros(2), group.covariance(), k)
                name = {"t": "σ_aug" if k == 1 else "2 σ_aug", "tp": points[16], "dy": -8, "align": "center"}
                label = name if frame == "scene" else {}
                line = path(
                    points, self._palette.margin, frame, close=True, w=1.2, d=[3, 4], halo=True, **label
                )
                items.append(line)
        self._stage.layer("aug", items)

    def _candidates(self, story: Story, glide: float, camera: bool) -> None:
        assert self._palette is not None
        assert self._at is not None
        layout, colours = self.layout, self._palette
        self._show_images("sources")
        self._clear("swarm", "trail", "best")
        window = story.get(WindowDetail)
        if window is not None:
            w = window.window
            corners = rectangle(w.low - layout.anchor_ref, w.high - layout.anchor_ref)
            whose = "robot 2" if np.allclose(w.pivot, self._at.x_mov) else "map 2's origin"
            label = {
                "t": f"window for {whose}, eqs. (9), (10)",
                "tp": corners[2],
                "dy": -12,
                "align": "center",
            }
            self._stage.layer(
                "window", [path(corners, colours.margin, close=True, d=[7, 5], halo=True, **label)]
            )
        tried = story.shifts
        found = story.get(CandidatesDetail)
        poses = [c.T_ref_mov for c in found.candidates] if found else [s.candidate.T_ref_mov for s in tried]
        marks = [
            mark(
                "diamond", layout.placed(T).xy, colours.best if rank == 0 and found else colours.particle, r=5
            )
            for rank, T in enumerate(poses)
        ]
        self._stage.layer("box", list(reversed(marks)))
        if poses:
            self._place(layout.placed(poses[0] if found else poses[-1]), glide * SLIDE_MS)
        self._robots(together=bool(poses))
        if camera:
            self._stage.look_down(self._swept())

    def _refine(self, detail: RefineDetail, glide: float, camera: bool) -> None:
        assert self._palette is not None
        layout, colours, state = self.layout, self._palette, detail.state
        self._show_images("sources")
        self._clear("window")
        best = layout.placed(detail.box.transform(state.best))
        self._place(best, glide * 70)
        self._robots(together=True, seen=False)  # the swarm's best stands there
        key = (detail.index, detail.total, id(detail.box))
        if self._drawn.get("box") != key:
            self._drawn["box"] = key
            middle = layout.placed(detail.box.transform(detail.box.centre)).xy
            half = (detail.box.high - detail.box.low)[:2] / 2
            corners = rectangle(middle - half, middle + half)
            footprint = self._footprint(detail.box)
            self._stage.layer(
                "box",
                [
                    path(
                        corners,
                        colours.margin,
                        close=True,
                        d=[6, 4],
                        halo=True,
                        w=1.5,
                        t="box ± σ_x, ± σ_y",
                        tp=corners[3],
                        dy=-8,
                    )
                ],
            )
            if camera:
                self._stage.look_down(footprint)
        step = -(-len(state.poses) // MOST_PARTICLES)
        where = self.seen_robot(detail.box.transforms(state.poses[::step]))
        self._stage.layer(
            "swarm", [cloud(where, colours.particle, r=2.6, alpha=0.8, glide=f"{detail.index}")]
        )
        self._stage.layer("best", [mark("diamond", best.xy, colours.best, r=6, rim="#ffffff")])

    def _answer(self, story: Story, glide: float, camera: bool) -> None:
        assert self._palette is not None
        layout, colours = self.layout, self._palette
        answers, fusion = story.get(AnswersDetail), story.get(Fusion)
        if answers is None:
            return
        T = answers.answers[0].T_ref_mov
        self._clear("window", "swarm", "trail", "box")
        self._drawn.pop("box", None)
        self._place(layout.placed(T), glide * SLIDE_MS)
        self._robots(together=True)
        self._stage.layer("best", [mark("star", layout.placed(T).xy, colours.answer, r=9, rim="#374151")])
        if fusion is not None:
            if self._drawn.get("fusion") is not fusion:
                self._drawn["fusion"] = fusion
                below, above = self._merged
                below.show(render.merged_floor(fusion, colours), fusion.merged, layout.anchor_ref)
                above.show(render.merged_walls(fusion, colours), fusion.merged, layout.anchor_ref)
            self._show_images("merged", force=True)
        if camera:
            self._stage.look_down(layout.view(layout.placed(T)))

    def read_out(self, place: FloatArray, story: Story) -> str:
        """What both maps know of a place in the scene: coordinates, occupancy, level."""
        point = place + self.layout.anchor_ref
        parts = [f"x {point[0]:.2f} m, y {point[1]:.2f} m"]
        augmented = story.get(AugmentDetail)
        levels = (augmented.ref, augmented.mov) if augmented else (None, None)
        there = self._mov_at.inverse().apply(place) + self.layout.anchor_mov
        for number, grid, at, lifted in ((1, self._ref, point, levels[0]), (2, self._mov, there, levels[1])):
            if grid is None:
                continue
            value = grid.value_at(at)
            word = "unknown" if value < FREE else "wall" if value >= OCCUPIED_FROM else "free"
            if value >= OCCUPIED_FROM and lifted is not None:
                nearest = np.hypot(*(lifted.points - at).T) if len(lifted.levels) else np.array([np.inf])
                level = lifted.levels[nearest.argmin()] if nearest.min() < grid.resolution else 0.0
                word += f", level {level:.3g}"
            parts.append(f"map {number}: {word}")
        return " · ".join(parts)

    # --- parts ------------------------------------------------------------------------------------

    def seen_robot(self, poses: FloatArray) -> FloatArray:
        """(P, 3) where each transform puts x̂2 in the scene, and its turn; metres, metres, radians."""
        c, s = np.cos(poses[:, 2]), np.sin(poses[:, 2])
        x, y = self.layout.anchor_mov
        return np.column_stack(
            [
                poses[:, 0] + c * x - s * y - self.layout.anchor_ref[0],
                poses[:, 1] + s * x + c * y - self.layout.anchor_ref[1],
                poses[:, 2],
            ]
        )

    def _footprint(self, box: Box) -> Rect:
        """Rectangle that shows a box of transforms at the seen robot, with walls around it."""
        low, high = box.low, box.high
        corners = np.array(
            [[x, y, a] for x in (low[0], high[0]) for y in (low[1], high[1]) for a in (low[2], high[2])]
        )
        at = self.seen_robot(box.transforms(corners))[:, :2]
        middle = (at.min(axis=0) + at.max(axis=0)) / 2
        half = max(0.8, 0.85 * float((at.max(axis=0) - at.min(axis=0)).max()))
        return (*(middle - half).tolist(), *(middle + half).tolist())  # type: ignore[return-value]

    def _swept(self) -> Rect:
        """Rectangle that holds map 1 and map 2 at any turn about the meeting place."""
        layout = self.layout
        ref = layout.view(Pose2()) if layout.mov_corners is None else None
        reach = 0.0
        if layout.mov_corners is not None:
            reach = float(np.hypot(*layout.mov_corners.T).max())
        if layout.ref_corners is not None:
            x0, y0 = layout.ref_corners.min(axis=0).tolist()
            x1, y1 = layout.ref_corners.max(axis=0).tolist()
            ref = (x0, y0, x1, y1)
        assert ref is not None
        return union(ref, (-reach, -reach, reach, reach))

    def _robots(self, together: bool, seen: bool = True) -> None:
        o, at, colours = self._observation, self._at, self._palette
        if o is None or at is None or colours is None or self._ref is None:
            self._clear("robots", "sight")
            return
        zero = np.zeros(2)
        first = o.observer.xy - self.layout.anchor_ref
        back = o.observer.theta + o.bearing + pi
        away = np.array([cos(back), sin(back)])  # from x̂1 to robot 1: its label goes to the far side
        side: Item = {"dx": 14, "align": "left"} if away[0] >= 0 else {"dx": -14, "align": "right"}
        robots = [
            mark("robot", first, colours.ref, a=o.observer.theta, r=9, t="robot 1", size=12, **side),
        ]
        other: Item = {"dx": -14, "align": "right"} if away[0] >= 0 else {"dx": 14, "align": "left"}
        sight = [path(np.array([first, zero]), colours.text, w=1.6, d=[5, 4], halo=True)]
        if self._mov is not None and seen:
            heading = {} if o.observed_heading is None else {"a": o.observed_heading}
            shape = "dot" if o.observed_heading is None else "robot"
            robots.append(
                mark(
                    shape,
                    zero,
                    colours.mov,
                    "mov",
                    r=9 if heading else 6,
                    t="robot 2",
                    size=12,
                    **heading,
                    **other,
                )
            )
        if not together:
            robots.append(mark("ring", zero, colours.conflict, r=7, t="x̂₁ seen here", size=11, **other))
            if self._mov is not None:
                robots.append(mark("ring", zero, colours.conflict, "mov", r=13))
                link = np.array([zero, self.layout.apart.xy])
                sight.append(path(link, colours.margin, w=1, d=[1, 5]))
        self._stage.layer("robots", robots)
        self._stage.layer("sight", sight)

    def _place(self, at: Pose2, milliseconds: float) -> None:
        if at != self._mov_at or milliseconds == 0:
            self._mov_at = at
            self._stage.place_mov(at, milliseconds)

    def _clear(self, *names: str) -> None:
        for name in names:
            self._stage.layer(name, None)
        if "box" in names:
            self._drawn.pop("box", None)

    def _show_images(self, which: str, force: bool = False) -> None:
        if self._drawn.get("images") == which and not force:
            return
        self._drawn["images"] = which
        for image in (self._free_1, self._free_2):
            image.visible(which != "merged")
        for image in (self._walls_1, self._walls_2):
            image.visible(which == "sources")
        for image in self._levels:
            image.visible(which == "levels")
        for image in self._merged:
            image.visible(which == "merged")
