"""Maps as SVG: parts of them as pixels, laid anywhere and seen at any size so that no thin wall is lost;
robots, and a bar that says how long a metre is.

Row 0 of pixels is the top: these are for a screen.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import cos, sin
from typing import Any

import numpy as np
from numpy.typing import NDArray

from algorithms.common.pose import FloatArray, Pose2
from algorithms.maps.grid_map import OCCUPIED_FROM, UNKNOWN, BoolArray, GridMap, where
from algorithms.spectra.augmented_map import AugmentedMap
from app.drawing.grid_pixels import Pixels
from app.drawing.palette import Palette, Rgb, level_colours
from app.drawing.scene_layout import Rect
from app.drawing.svg.svg_canvas import INK, SvgCanvas, SvgPlot, number

ROBOT = np.array([[1.35, 0.0], [-0.85, 0.8], [-0.45, 0.0], [-0.85, -0.8]])


@dataclass(frozen=True)
class RasterView:
    """A rectangle of the plane on a raster of pixels.

    rect          : x low, y low, x high, y high; metres
    wide, high    : pixels
    """

    rect: Rect
    wide: int
    high: int

    def blank(self, palette: Palette) -> Pixels:
        """Nothing known."""
        return np.full((self.high, self.wide, 3), palette.unknown, dtype=np.uint8)

    def cells(
        self, grid: GridMap, T: Pose2 | None = None
    ) -> tuple[NDArray[np.intp], NDArray[np.intp], BoolArray]:
        """(H, W) row and column of a grid, which lies at T, under every pixel, and whether it is inside.

        The way from pixels to cells is affine: three corners of the view give it for all.
        """
        x0, y0, x1, y1 = self.rect
        corners = np.array([[x0, y1], [x1, y1], [x0, y0]])
        if T is not None:
            corners = T.inverse().apply(corners)
        start, right, below = grid.grid_coordinates(corners)
        u = ((np.arange(self.wide) + 0.5) / self.wide)[None, :]
        v = ((np.arange(self.high) + 0.5) / self.high)[:, None]
        col, row = (
            np.floor(start[k] + u * (right[k] - start[k]) + v * (below[k] - start[k])).astype(np.intp)
            for k in (0, 1)
        )
        return row, col, (row >= 0) & (row < grid.height) & (col >= 0) & (col < grid.width)

    def pixels_of(
        self, points: FloatArray, T: Pose2 | None = None
    ) -> tuple[NDArray[np.intp], NDArray[np.intp], BoolArray]:
        """Row and column of (N, 2) points of a frame that lies at T, and which of them are in view."""
        points = points if T is None else T.apply(points)
        x0, y0, x1, y1 = self.rect
        col = np.floor((points[:, 0] - x0) / (x1 - x0) * self.wide).astype(np.intp)
        row = np.floor((y1 - points[:, 1]) / (y1 - y0) * self.high).astype(np.intp)
        return row, col, (row >= 0) & (row < self.high) & (col >= 0) & (col < self.wide)


def around(centre: FloatArray, half: float, aspect: float = 1.0) -> Rect:
    """A rectangle about a place, ``half`` metres to the left and right, 1/aspect of it up and down."""
    x, y = centre.tolist()
    return x - half, y - half / aspect, x + half, y + half / aspect


def under(
    values: NDArray[Any], grid: GridMap, view: RasterView, T: Pose2 | None, outside: float
) -> NDArray[Any]:
    """(H, W) what an array over a grid, which lies at T, holds under every pixel."""
    row, col, inside = view.cells(grid, T)
    found = np.full(inside.shape, outside, dtype=values.dtype)
    found[inside] = values[row[inside], col[inside]]
    return found


def walls(
    grid: GridMap, view: RasterView, T: Pose2 | None = None, cells: NDArray[np.int8] | None = None
) -> BoolArray:
    """(H, W) where a map that lies at T has a wall; ``cells`` those under the pixels, where known."""
    values = under(grid.cells, grid, view, T, UNKNOWN) if cells is None else cells
    mask = np.asarray(values >= OCCUPIED_FROM)
    row, col, seen = view.pixels_of(grid.points, T)  # from afar a pixel holds many cells
    mask[row[seen], col[seen]] = True
    return mask


def cells_seen(mask: BoolArray, grid: GridMap, view: RasterView) -> BoolArray:
    """(H, W) where a mask of a grid's cells is under a pixel, or one of them has its centre in it."""
    found = under(mask, grid, view, None, False)
    row, col, seen = view.pixels_of(grid.centres(*where(mask)))
    found[row[seen], col[seen]] = True
    return found


def draw_map(
    view: RasterView,
    palette: Palette,
    grid: GridMap,
    colour: Rgb,
    T: Pose2 | None = None,
    onto: Pixels | None = None,
) -> Pixels:
    """A map's floor and walls; ``onto`` pixels that are there already, whose walls are kept."""
    pixels = view.blank(palette) if onto is None else onto
    cells = under(grid.cells, grid, view, T, UNKNOWN)
    blank = np.all(pixels == palette.unknown, axis=-1)
    pixels[(cells != UNKNOWN) & blank] = palette.free
    pixels[walls(grid, view, T, cells)] = colour
    return pixels


def draw_levels(view: RasterView, palette: Palette, lifted: AugmentedMap, T: Pose2 | None = None) -> Pixels:
    """A map's walls in the colours of their levels, eq. (4); walls too far to count keep a faint grey."""
    faint = tuple((2 * a + b) // 3 for a, b in zip(palette.free, palette.margin, strict=True))
    pixels = draw_map(view, palette, lifted.grid, faint, T)  # type: ignore[arg-type]
    levels = np.zeros(lifted.grid.cells.shape)
    levels[lifted.rows, lifted.cols] = lifted.levels / lifted.peak
    share = under(levels, lifted.grid, view, T, 0.0)
    row, col, seen = view.pixels_of(lifted.points, T)
    np.maximum.at(share, (row[seen], col[seen]), lifted.levels[seen] / lifted.peak)
    up = share > 0.004
    pixels[up] = level_colours(share[up], palette.dark)
    return pixels


def scene(sheet: SvgCanvas, x: float, y: float, wide: float, high: float, view: RasterView) -> SvgPlot:
    """A plot over a view of the plane; pixels of the view are drawn finer than those of the sheet."""
    x0, y0, x1, y1 = view.rect
    return SvgPlot(sheet, x, y, wide, high, (x0, x1), (y0, y1))


def map_panel(
    sheet: SvgCanvas, x: float, wide: float, high: float, view: RasterView, pixels: Pixels, title: str
) -> SvgPlot:
    """A framed picture of a view, its title above and a scale bar in it."""
    sheet.text(x, 11, title, 11, bold=True)
    plot = scene(sheet, x, 18, wide, high, view)
    plot.image(pixels)
    sheet.rect(x, 18, wide, high, None, INK, 0.35)
    scale_bar(plot)
    return plot


def view_of(centre: FloatArray, half: float, wide: float, high: float) -> RasterView:
    """A square-pixelled view about a place, two pixels to one of the sheet."""
    return RasterView(around(centre, half, wide / high), int(2 * wide), int(2 * high))


def robot(plot: SvgPlot, at: FloatArray, heading: float | None, colour: Rgb, r: float = 7) -> None:
    """A robot, its nose to where it is heading; a disc where that is not known."""
    x, y = plot.one(*at.tolist())
    if heading is None:
        plot.sheet.dot(x, y, 0.75 * r, colour, "#fff")
        return
    c, s = cos(heading), sin(heading)
    points = r * ROBOT @ np.array([[c, s], [-s, c]]) * (1, -1) + (x, y)
    plot.sheet.path(points, "#fff", 3, colour, close=True)
    plot.sheet.path(points, None, 0, colour, close=True)


def scale_bar(plot: SvgPlot) -> None:
    """How long a metre is, at the lower left of a plot."""
    px = plot.wide / (plot.across[1] - plot.across[0])
    metres = next((m for m in (50, 20, 10, 5, 2, 1, 0.5, 0.2, 0.1) if m * px <= 0.4 * plot.wide), 0.05)
    x, y = plot.x + 6, plot.y + plot.high - 7
    sheet = plot.sheet
    sheet.rect(x - 4, y - 14, metres * px + 8, 19, "#fff", None, 0.75)
    sheet.path([(x, y - 3), (x, y), (x + metres * px, y), (x + metres * px, y - 3)], "#111827", 1.5)
    sheet.text(x + metres * px / 2, y - 5, f"{number(metres)} m", 9, "middle", "#111827")
