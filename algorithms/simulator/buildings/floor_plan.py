"""Drawing a floor plan at the height of a lidar: walls, glass, furniture, openings."""

from __future__ import annotations

from dataclasses import dataclass, field
from math import ceil

import numpy as np
from numpy.typing import NDArray

from algorithms.common.pose import FloatArray
from algorithms.simulator.portable_random import TURN, cosine, sine

Surface = NDArray[np.uint8]
Rectangle = tuple[float, float, float, float]  # x0, y0, x1, y1; metres, world frame

AIR = 0
WALL = 1
DARK = 2  # glass or something black: it stops a beam and seldom sends it back


@dataclass(frozen=True)
class Piece:
    """One thing on a floor that a lidar sees as a few cells, and a camera as what it is.

    kind  : "desk", "chair", "door leaf", …
    x, y  : its middle; metres, world frame
    depth : along the direction in which its front looks; metres
    width : across; metres
    ticks : that direction, counter-clockwise from x
    """

    kind: str
    x: float
    y: float
    depth: float
    width: float
    ticks: int = 0


@dataclass(frozen=True, eq=False)
class Building:
    """A floor as it truly is.

    name       : for a person
    surface    : (H, W) uint8, row 0 at the bottom: AIR, WALL or DARK; cell (0, 0) has its lower-left
                 corner at the origin of the world frame
    resolution : metres per cell
    stops      : (N, 2) places a robot may want to visit; metres, world frame. Some may be out of
                 its reach
    doors      : (N, 4) the two jambs of every door, x0, y0, x1, y1; metres, world frame
    pieces     : what stood there when the plan was drawn; its cells are in ``surface``
    """

    name: str
    surface: Surface
    resolution: float
    stops: FloatArray
    doors: FloatArray = field(default_factory=lambda: np.zeros((0, 4)))
    pieces: tuple[Piece, ...] = ()

    @property
    def solid(self) -> NDArray[np.bool_]:
        return np.asarray(self.surface != AIR)


def along(upright: bool, level0: float, level1: float, low: float, high: float) -> Rectangle:
    """What lies between two levels, x of an upright wall and else y, from low to high along the wall."""
    return (level0, low, level1, high) if upright else (low, level0, high, level1)


class FloorPlan:
    """A floor being drawn. All lengths in metres, world frame."""

    def __init__(self, width: float, height: float, resolution: float) -> None:
        self.resolution = resolution
        self.cells: Surface = np.zeros((ceil(height / resolution), ceil(width / resolution)), np.uint8)
        self.stops: list[tuple[float, float]] = []
        self.doors: list[Rectangle] = []
        self.pieces: list[Piece] = []
        self._kept: list[Rectangle] = []

    @staticmethod
    def of(building: Building) -> FloorPlan:
        """A plan to draw on a copy of a building."""
        height, width = building.surface.shape
        plan = FloorPlan(width * building.resolution, height * building.resolution, building.resolution)
        plan.cells = building.surface.copy()
        return plan

    def _window(self, x0: float, y0: float, x1: float, y1: float) -> tuple[slice, slice]:
        """The cells whose centres lie in a box."""
        r = self.resolution
        first_col, first_row = max(0, ceil(x0 / r - 0.5)), max(0, ceil(y0 / r - 0.5))
        return (
            slice(first_row, max(first_row, ceil(y1 / r - 0.5))),
            slice(first_col, max(first_col, ceil(x1 / r - 0.5))),
        )

    def _centres(self, window: tuple[slice, slice]) -> tuple[FloatArray, FloatArray]:
        rows, cols = window
        height, width = self.cells[window].shape
        y = (np.arange(rows.start, rows.start + height) + 0.5) * self.resolution
        x = (np.arange(cols.start, cols.start + width) + 0.5) * self.resolution
        return x[None, :], y[:, None]

    def box(self, x0: float, y0: float, x1: float, y1: float, what: int = WALL) -> None:
        self.cells[self._window(x0, y0, x1, y1)] = what

    def outline(self, x0: float, y0: float, x1: float, y1: float, thick: float) -> None:
        """Four walls whose middle lines are the edges of a box."""
        t = thick / 2
        self.box(x0 - t, y0 - t, x1 + t, y0 + t)
        self.box(x0 - t, y1 - t, x1 + t, y1 + t)
        self.box(x0 - t, y0 - t, x0 + t, y1 + t)
        self.box(x1 - t, y0 - t, x1 + t, y1 + t)

    def line(self, x0: float, y0: float, x1: float, y1: float, thick: float, what: int = WALL) -> None:
        """A straight wall in any direction, with round ends."""
        t = max(thick, 2 * self.resolution) / 2
        window = self._window(min(x0, x1) - t, min(y0, y1) - t, max(x0, x1) + t, max(y0, y1) + t)
        x, y = self._centres(window)
        dx, dy = x1 - x0, y1 - y0
        share = ((x - x0) * dx + (y - y0) * dy) / max(dx * dx + dy * dy, 1e-12)
        share = np.minimum(np.maximum(share, 0.0), 1.0)
        off_x, off_y = x - x0 - share * dx, y - y0 - share * dy
        self.cells[window][off_x * off_x + off_y * off_y <= t * t] = what

    def ring(self, x: float, y: float, inner: float, outer: float, what: int = WALL) -> None:
        """A round wall; with ``inner`` 0 a disc."""
        window = self._window(x - outer, y - outer, x + outer, y + outer)
        cx, cy = self._centres(window)
        squared = (cx - x) * (cx - x) + (cy - y) * (cy - y)
        self.cells[window][(squared >= inner * inner) & (squared <= outer * outer)] = what

    def pillar(self, x: float, y: float, radius: float, kind: str = "pillar") -> None:
        """A disc that is remembered as a piece."""
        self.note(kind, (x - radius, y - radius, x + radius, y + radius))
        self.ring(x, y, 0.0, radius)

    def turned_box(
        self, x: float, y: float, length: float, depth: float, ticks: int, what: int = WALL
    ) -> None:
        """A filled box around its centre, turned counter-clockwise."""
        reach = (length + depth) / 2
        window = self._window(x - reach, y - reach, x + reach, y + reach)
        cx, cy = self._centres(window)
        c, s = float(cosine(ticks)), float(sine(ticks))
        along, across = (cx - x) * c + (cy - y) * s, (cy - y) * c - (cx - x) * s
        self.cells[window][(np.abs(along) <= length / 2) & (np.abs(across) <= depth / 2)] = what

    def note(self, kind: str, place: Rectangle, quarter: int = 0) -> None:
        """Remember what stands in a box, and the quarter turn from x to which its front looks."""
        x0, y0, x1, y1 = place
        depth, width = (x1 - x0, y1 - y0) if quarter % 2 == 0 else (y1 - y0, x1 - x0)
        middle = (x0 + x1) / 2, (y0 + y1) / 2
        self.pieces.append(Piece(kind, *middle, depth, width, TURN // 4 * (quarter % 4)))

    def keep_clear(self, x0: float, y0: float, x1: float, y1: float) -> None:
        """No furniture here: someone has to get through."""
        self._kept.append((x0, y0, x1, y1))

    def is_clear(self, x0: float, y0: float, x1: float, y1: float) -> bool:
        """Whether a box is empty and may be built on."""
        if any(x0 < k[2] and k[0] < x1 and y0 < k[3] and k[1] < y1 for k in self._kept):
            return False
        return self.is_empty(x0, y0, x1, y1)

    def is_empty(self, x0: float, y0: float, x1: float, y1: float) -> bool:
        """Whether nothing stands in a box."""
        return not self.cells[self._window(x0, y0, x1, y1)].any()

    def finish(self, name: str) -> Building:
        stops, doors = np.array(self.stops).reshape(-1, 2), np.array(self.doors).reshape(-1, 4)
        return Building(name, self.cells, self.resolution, stops, doors, tuple(self.pieces))
