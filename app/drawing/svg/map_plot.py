"""A map on a sheet: a plot in metres, robots, a bar that says how long a metre is."""

from __future__ import annotations

from math import cos, sin

import numpy as np

from algorithms.common.pose import FloatArray
from app.drawing.grid_pixels import Pixels
from app.drawing.palette import Rgb
from app.drawing.svg.map_raster import RasterView, around
from app.drawing.svg.svg_canvas import INK, SvgCanvas, SvgPlot, number

ROBOT = np.array([[1.35, 0.0], [-0.85, 0.8], [-0.45, 0.0], [-0.85, -0.8]])


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


def scale_bar(plot: SvgPlot, colour: str = INK) -> None:
    """How long a metre is, at the lower left of a plot."""
    px = plot.wide / (plot.across[1] - plot.across[0])
    metres = next((m for m in (50, 20, 10, 5, 2, 1, 0.5, 0.2, 0.1) if m * px <= 0.4 * plot.wide), 0.05)
    x, y = plot.x + 6, plot.y + plot.high - 7
    sheet = plot.sheet
    sheet.rect(x - 4, y - 14, metres * px + 8, 19, "#fff", None, 0.75)
    sheet.path([(x, y - 3), (x, y), (x + metres * px, y), (x + metres * px, y - 3)], "#111827", 1.5)
    sheet.text(x + metres * px / 2, y - 5, f"{number(metres)} m", 9, "middle", "#111827")
