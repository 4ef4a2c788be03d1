"""A fleet in the scene: every robot's map in its colour, and who saw whom."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from math import cos, sin

import numpy as np
import viser

from algorithms.common.pose import FloatArray
from algorithms.maps.grid_map import GridMap
from algorithms.observations.observation import encounter
from app.drawing import grid_pixels as render
from app.drawing.browser_messages import BrowserMessages
from app.drawing.draw_items import Item, mark, path
from app.drawing.fleet_layout import FleetLayout
from app.drawing.palette import Palette, Rgb, robot_colour
from app.drawing.scene.grid_image import GridImage, Size
from app.model.fleet_state import LEFT_OUT, USED, FleetState

SIZE = Size(whole=1536, pooled=1024)  # pixels of a map on a side: fifty of them are to be drawn
FLOOR, WALLS, STEP = 0.0, 0.2, 0.002  # heights: all floors below all walls
UNSURE, DENIED = [2, 5], [6, 5]  # dashes


@dataclass(eq=False)
class _Drawn:
    """One robot's map in the scene."""

    grid: GridMap
    colour: Rgb
    palette: Palette
    frame: viser.FrameHandle
    floor: GridImage
    walls: GridImage

    def renew(self, grid: GridMap, anchor: FloatArray) -> None:
        """Another map of the same robot."""
        self.grid = grid
        self.floor.renew(partial(render.floor, grid.cells, self.palette), grid, anchor)
        self.walls.renew(partial(render.walls, grid.cells, self.colour), grid, anchor)

    def remove(self) -> None:
        self.floor.remove()
        self.walls.remove()
        self.frame.remove()


@dataclass(frozen=True, eq=False)
class Edge:
    """A sighting as it is drawn.

    number : in the fleet's list, from 0
    ends   : (2, 2) where the observer stood, and where the other was; scene
    mood   : as ``FleetState.mood`` has it
    """

    number: int
    ends: FloatArray
    mood: str


class FleetView:
    """Of one tab."""

    def __init__(self, scene: viser.SceneApi, messages: BrowserMessages) -> None:
        self._scene, self._messages = scene, messages
        self._drawn: dict[str, _Drawn] = {}
        self._made = 0  # maps so far: each has a name of its own in the scene

    def show(self, state: FleetState, layout: FleetLayout, edges: Sequence[Edge], palette: Palette) -> None:
        """Draw a fleet; what is drawn already is only moved."""
        maps = state.fleet.maps
        for name in [name for name in self._drawn if name not in maps]:
            self._drawn.pop(name).remove()
        for number, (name, grid) in enumerate(maps.items()):
            colour, before = robot_colour(number), self._drawn.get(name)
            if before is None or (before.colour, before.palette) != (colour, palette):
                if before is not None:
                    before.remove()
                self._drawn[name] = self._draw(number, grid, colour, palette, layout.anchors[name])
            elif before.grid is not grid:
                before.renew(grid, layout.anchors[name])
            each, at = self._drawn[name], layout.at(name)
            each.frame.position = at.x, at.y, 0.0
            each.frame.wxyz = cos(at.theta / 2), 0.0, 0.0, sin(at.theta / 2)
            for image in (each.floor, each.walls):
                image.visible(name not in state.hidden)
        self._messages.layer("sight", _lines(edges, palette))
        self._messages.layer("robots", _names(state, layout))

    @property
    def drawn(self) -> bool:
        """Whether a fleet is on the scene."""
        return bool(self._drawn)

    def hide(self) -> None:
        """Take everything of it off the scene."""
        for each in self._drawn.values():
            each.remove()
        if self._drawn:
            self._messages.layer("sight", None)
            self._messages.layer("robots", None)
        self._drawn.clear()

    def _draw(self, number: int, grid: GridMap, colour: Rgb, palette: Palette, anchor: FloatArray) -> _Drawn:
        self._made += 1
        name = f"/world/robot{self._made}"
        frame = self._scene.add_frame(name, show_axes=False)
        floor, walls = (
            GridImage(self._scene, f"{name}/{part}", height + STEP * number, SIZE)
            for part, height in (("free", FLOOR), ("walls", WALLS))
        )
        floor.show(partial(render.floor, grid.cells, palette), grid, anchor)
        walls.show(partial(render.walls, grid.cells, colour), grid, anchor)
        return _Drawn(grid, colour, palette, frame, floor, walls)


def edges_of(state: FleetState, layout: FleetLayout) -> list[Edge]:
    """Every sighting between robots whose maps are shown: from where one stood to where the other was by its
    own map; of one that is left out to where it claims that the other was.
    """
    edges = []
    for number, seen in enumerate(state.fleet.sightings):
        if {seen.observer, seen.observed} & state.hidden:
            continue
        at = encounter(seen.observation)
        start = layout.poses[seen.observer].apply(seen.observation.observer.xy)
        end, mood = layout.poses[seen.observed].apply(at.x_mov), state.mood(number)
        if mood == LEFT_OUT and state.together(seen.observer, seen.observed):
            end = layout.poses[seen.observer].apply(at.x_ref)
        edges.append(Edge(number, np.array([start, end]), mood))
    return edges


def nearest_edge(edges: Sequence[Edge], place: FloatArray, within: float) -> Edge | None:
    """The sighting whose line passes nearest to a place of the scene; None where none is near."""

    def distance(edge: Edge) -> float:
        start, end = edge.ends
        way = end - start
        share = float(np.clip((place - start) @ way / max(1e-12, float(way @ way)), 0.0, 1.0))
        return float(np.linalg.norm(start + share * way - place))

    best = min(edges, key=distance, default=None)
    return best if best is not None and distance(best) <= within else None


def _lines(edges: Sequence[Edge], palette: Palette) -> list[Item]:
    items: list[Item] = []
    for edge in edges:
        colour, dashes = {
            USED: (palette.mov, []),
            LEFT_OUT: (palette.conflict, DENIED),
        }.get(edge.mood, (palette.margin, UNSURE))
        items.append(path(edge.ends, colour, w=2.2, d=dashes, halo=True))
        items.append(mark("dot", edge.ends[0], colour, r=4))
        items.append(mark("ring", edge.ends[1], colour, r=5))
    return items


def _names(state: FleetState, layout: FleetLayout) -> list[Item]:
    items = []
    for number, name in enumerate(state.robots):
        if name in state.hidden:
            continue
        colour, does = robot_colour(number), state.live.get(name)
        if does is not None and does.pose is not None:  # it is where it drives
            at = layout.poses[name] @ does.pose
            items.append(mark("robot", at.xy, colour, a=at.theta, r=9, t=name, size=14))
        else:
            how = {"size": 14, "align": "center", "dx": 0}
            items.append(mark("none", layout.at(name).xy, colour, t=name, **how))
    return items
