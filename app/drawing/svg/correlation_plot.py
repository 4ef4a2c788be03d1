"""The correlation surface of one turn as a picture: every shift in its colour, with axes and scale."""

from __future__ import annotations

import numpy as np

from algorithms.optimisation.correlation_picture import CorrelationPicture
from app.drawing.grid_pixels import Pixels, upright
from app.drawing.palette import LIGHT, VIRIDIS, viridis
from app.drawing.svg.svg_canvas import INK, SvgCanvas, SvgPlot, number, ticks, turn_label

WIDE, LEFT, TOP = 300.0, 44.0, 38.0
MOST_WIDE, MOST_HIGH = 244.0, 244.0  # of the surface


def correlation_svg(picture: CorrelationPicture, top: float) -> str:
    """SVG of a surface, its highest hill marked.

    top : metres of wall in the brightest colour; what is 0 or less is dark
    """
    rows, cols = picture.values.shape
    pixel = min(MOST_WIDE / cols, MOST_HIGH / rows)
    wide, high = pixel * cols, pixel * rows
    sheet = SvgCanvas(TOP + high + 68, WIDE)
    sheet.text(4, 13, surface_title(picture), 12, bold=True)
    sheet.text(4, 28, "where walls fall on walls, less where they fall on floor", 10.5, alpha=0.8)
    across, up = zip(picture.low.tolist(), picture.high.tolist(), strict=True)
    plot = SvgPlot(sheet, LEFT, TOP, wide, high, across, up)
    plot.image(upright(surface_pixels(picture, top)))
    for hill in picture.hills[:1].tolist():
        x, y = plot.one(*hill)
        sheet.dot(x, y, 7, None, "#fff", width=4)
        sheet.dot(x, y, 7, None, LIGHT.best, width=2)
    plot.axes("Δx (m)", "Δy (m)", ticks(*across, 5), ticks(*up, 5))
    y = TOP + high + 38
    sheet.image(VIRIDIS[None], LEFT, y, MOST_WIDE, 9, smooth=True)
    sheet.rect(LEFT, y, MOST_WIDE, 9, None, INK, 0.35)
    for x, words, anchor in zip((LEFT, LEFT + MOST_WIDE), scale_ends(top), ("start", "end"), strict=True):
        sheet.text(x, y + 21, words, 10, anchor)
    return sheet.svg(f"Correlation surface at a turn of {turn_label(picture.turn)}")


def surface_title(picture: CorrelationPicture) -> str:
    """What stands above a surface."""
    return f"Agreement at every shift, Δθ = {turn_label(picture.turn)}"


def scale_ends(top: float) -> tuple[str, str]:
    """What the darkest and the brightest colour stand for; ``top`` as in ``correlation_svg``."""
    return "0 or less", f"{number(float(f'{top:.3g}'))} m of wall"


def surface_pixels(picture: CorrelationPicture, top: float) -> Pixels:
    """(H, W, 4) colours of a surface, row 0 at the bottom; clear where no shift is looked at."""
    there = np.isfinite(picture.values)
    share = np.where(there, picture.values, 0.0) / max(top, 1e-12)
    return np.dstack([viridis(np.clip(share, 0, 1)), np.where(there, 255, 0).astype(np.uint8)])
