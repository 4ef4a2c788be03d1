"""Grids as flat pictures in the scene."""

from __future__ import annotations

from dataclasses import dataclass
from math import cos, sin
from typing import Protocol

import numpy as np
import viser

from algorithms.common.pose import FloatArray, Pose2
from algorithms.maps.grid_map import GridMap
from app.drawing.browser_messages import BrowserMessages
from app.drawing.grid_pixels import WHOLE, CellRegion, GridPixels
from app.drawing.png import png_base64
from app.drawing.scene.zoom_crop import CameraView, ZoomCrop, looked_at


class Draw(Protocol):
    """Draws a grid, or a part of it, in at the most so many pixels on a side: see grid_pixels."""

    def __call__(self, *, most: int, part: CellRegion = ...) -> GridPixels: ...


@dataclass(frozen=True)
class Size:
    """Pixels on a side of a picture.

    whole  : a grid of no more cells is shown in cells of its own
    pooled : a larger one is pooled down to this
    """

    whole: int
    pooled: int

    def of(self, grid: GridMap) -> int:
        return self.whole if max(grid.cells.shape) <= self.whole else self.pooled


@dataclass(frozen=True, eq=False)
class Closer:
    """An excerpt that ``image`` lacks; ``excerpt`` None: the one it has is of no use any more."""

    image: GridImage
    draw: Draw
    excerpt: ZoomCrop | None

    def picture(self) -> GridPixels | None:
        """Draw it; nothing on the page is touched."""
        if self.excerpt is None:
            return None
        return self.draw(most=self.excerpt.most, part=self.excerpt.part)


class GridImage:
    """A picture of a grid that lies in the scene where the grid's cells are."""

    def __init__(
        self,
        scene: viser.SceneApi,
        name: str,
        height: float,
        size: Size,
        messages: BrowserMessages | None = None,
    ) -> None:
        """stage : where an excerpt of it would be seen"""
        self._scene, self.name, self._height, self._size, self._messages = scene, name, height, size, messages
        self._handle: viser.ImageHandle | None = None
        self._middle = np.zeros(2)  # of the picture, in the grid's frame
        self._draw: Draw | None = None
        self._grid: GridMap | None = None
        self._anchor = np.zeros(2)
        self._pooled = 1  # cells per pixel of the picture
        self._shape = (1, 1)  # cells that its pixels stand for
        self._seen = True
        self._laid: Closer | None = None  # what lies over it on the page

    def show(self, draw: Draw, grid: GridMap, anchor: FloatArray) -> None:
        """Draw a grid; ``anchor``: (2,) point of its frame that lies at the parent's origin; metres."""
        picture = self._drawn(draw, grid)
        rows, cols = self._shape
        size = np.array([cols, rows]) * grid.resolution
        self._middle = grid.origin.apply(size / 2)
        half = grid.origin.theta / 2
        if self._handle is not None:
            self._handle.remove()
        x, y, height = self._position(anchor)
        self._handle = self._scene.add_image(
            self.name,
            picture.pixels,
            float(size[0]),
            float(size[1]),
            format="png",
            position=(x + 1.0, y, height),
            wxyz=(0.0, 0.0, 0.0, 1.0),
            cast_shadow=False,
            receive_shadow=False,
        )
        # viser does not tell a new node's pose where it is the default one, and the browser then keeps
        # that of the last node of this name: moved from elsewhere, it is always told
        self._handle.position = x, y, height
        self._handle.wxyz = (cos(half), 0.0, 0.0, sin(half))
        self._seen = True
        self._bare()

    def _drawn(self, draw: Draw, grid: GridMap) -> GridPixels:
        picture = draw(most=self._size.of(grid), part=WHOLE)
        rows, cols = picture.pixels.shape[:2]
        self._draw, self._grid, self._pooled = draw, grid, picture.pooled
        self._shape = rows * picture.pooled, cols * picture.pooled
        return picture

    def move(self, anchor: FloatArray) -> None:
        """Put the picture where another point of the grid's frame lies at the parent's origin."""
        if self._handle is not None:
            self._handle.position = self._position(anchor)

    def _position(self, anchor: FloatArray) -> tuple[float, float, float]:
        self._anchor = anchor
        x, y = (self._middle - anchor).tolist()
        return x, y, self._height

    def repaint(self, draw: Draw, grid: GridMap, anchor: FloatArray) -> None:
        """Draw another picture of the same grid in place of the last one, without a flicker."""
        if self._handle is None:
            self.show(draw, grid, anchor)
        else:
            # an excerpt of the last one lies there until another takes its place
            self._handle.image = self._drawn(draw, grid).pixels

    def renew(self, draw: Draw, grid: GridMap, anchor: FloatArray) -> None:
        """Draw another grid in place of the last one, without a flicker."""
        if self._handle is None:
            self.show(draw, grid, anchor)
            return
        picture = self._drawn(draw, grid)
        rows, cols = self._shape
        self._middle = grid.origin.apply(np.array([cols, rows]) * grid.resolution / 2)
        half = grid.origin.theta / 2
        self._handle.image = picture.pixels
        self._handle.render_width, self._handle.render_height = cols * grid.resolution, rows * grid.resolution
        self._handle.position = self._position(anchor)
        self._handle.wxyz = (cos(half), 0.0, 0.0, sin(half))
        self._bare()

    def visible(self, yes: bool) -> None:
        if self._handle is not None:
            self._handle.visible = self._seen = yes

    def remove(self) -> None:
        if self._handle is not None:
            self._handle.remove()
            self._handle = None
            self._draw = None
            self._bare()

    # --- what is looked at closely ------------------------------------------------------------------

    def closer(self, view: CameraView, parent: Pose2) -> Closer | None:
        """What is to lie over it now, if that changes; ``parent``: where its frame lies; scene."""
        draw, grid = self._draw, self._grid
        if draw is None or grid is None or not self._seen or self._pooled == 1:
            return None
        seen = grid.grid_coordinates(parent.inverse().apply(view.corners()) + self._anchor)
        found = looked_at(seen, grid.cells.shape, 1 / (grid.resolution * view.density))
        if found is None:
            return None
        bare, excerpt = found
        if excerpt.pooled >= self._pooled:
            return Closer(self, draw, None) if self._laid else None
        laid = self._laid
        if laid is not None and laid.draw is draw and laid.excerpt and laid.excerpt.serves(bare):
            return None
        return Closer(self, draw, excerpt)

    def lay(self, closer: Closer, picture: GridPixels | None) -> None:
        """Put an excerpt over it, drawn without the lock: only if it is still one of what is shown."""
        excerpt = closer.excerpt
        if closer.draw is not self._draw or self._messages is None:
            return
        if excerpt is None or picture is None:
            self._bare()
            return
        self._laid = closer
        rows, cols = self._shape
        high, wide = (n * picture.pooled for n in picture.pixels.shape[:2])
        low = excerpt.left / cols, excerpt.top / rows
        hole = [*low, low[0] + wide / cols, low[1] + high / rows]
        self._messages.closer(self.name, {"hole": hole, "png": png_base64(picture.pixels)})

    def _bare(self) -> None:
        if self._laid is not None and self._messages is not None:
            self._messages.closer(self.name, None)
        self._laid = None
