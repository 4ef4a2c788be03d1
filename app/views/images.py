"""Grids as flat pictures in the scene."""

from __future__ import annotations

from math import cos, sin

import numpy as np
import viser

from algorithms.gridmap import GridMap
from algorithms.pose import FloatArray
from app.render import Picture


class GridImage:
    """A picture of a grid that lies in the scene where the grid's cells are."""

    def __init__(self, scene: viser.SceneApi, name: str, height: float) -> None:
        self._scene, self._name, self._height = scene, name, height
        self._handle: viser.ImageHandle | None = None
        self._middle = np.zeros(2)  # of the picture, in the grid's frame

    def show(self, picture: Picture, grid: GridMap, anchor: FloatArray) -> None:
        """Draw a picture of ``grid``.

        anchor : (2,) point of the grid's frame that lies at the parent's origin; metres
        """
        rows, cols = picture.pixels.shape[:2]
        size = np.array([cols, rows]) * picture.pooled * grid.resolution
        self._middle = grid.origin.apply(size / 2)
        half = grid.origin.theta / 2
        if self._handle is not None:
            self._handle.remove()
        x, y, height = self._position(anchor)
        self._handle = self._scene.add_image(
            self._name,
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

    def move(self, anchor: FloatArray) -> None:
        """Put the picture where another point of the grid's frame lies at the parent's origin."""
        if self._handle is not None:
            self._handle.position = self._position(anchor)

    def _position(self, anchor: FloatArray) -> tuple[float, float, float]:
        x, y = (self._middle - anchor).tolist()
        return x, y, self._height

    def repaint(self, picture: Picture, grid: GridMap, anchor: FloatArray) -> None:
        """Draw another picture of the same grid in place of the last one, without a flicker."""
        if self._handle is None:
            self.show(picture, grid, anchor)
        else:
            self._handle.image = picture.pixels

    def hide(self) -> None:
        """Take the picture away."""
        self.visible(False)

    def visible(self, yes: bool) -> None:
        """Show or hide it as it is."""
        if self._handle is not None:
            self._handle.visible = yes

    def remove(self) -> None:
        """Forget the picture."""
        if self._handle is not None:
            self._handle.remove()
            self._handle = None
