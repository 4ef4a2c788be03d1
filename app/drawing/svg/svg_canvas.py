"""A small drawing as SVG: crisp at any size, its words in the colour of the page, light or dark.

Coordinates are pixels of a sheet that is ``WIDE`` across, y down. Every text is escaped.
"""

from __future__ import annotations

from base64 import b64encode
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from html import escape
from math import atan2, ceil, cos, degrees, floor, log10, pi, sin

import numpy as np
from numpy.typing import NDArray

from algorithms.common.pose import FloatArray
from app.drawing.palette import Palette, Rgb, css
from app.drawing.png import png_base64
from app.model.chart_data import Chart

WIDE = 380.0
INK = "currentColor"
FAINT = 0.35  # opacity of axes

# words in these colours are too dark on a dark page; map_drawing.js has the same ones
LIGHTER: dict[Rgb, Rgb] = {
    (0x00, 0x72, 0xB2): (0x56, 0xB4, 0xE9),
    (0x00, 0x9E, 0x73): (0x34, 0xD3, 0x99),
    (0xD5, 0x5E, 0x00): (0xFB, 0x92, 0x3C),
}

Colour = Rgb | str
Range = tuple[float, float]


def _css(colour: Colour | None) -> str:
    return "none" if colour is None else colour if isinstance(colour, str) else css(colour)


def worded(colour: Rgb, palette: Palette) -> Rgb:
    """A colour of the palette as words are written in it."""
    return LIGHTER.get(colour, colour) if palette.dark else colour


def number(value: float) -> str:
    """A number as it stands beside an axis."""
    return f"{value:.6g}".replace("-", "−")


def ticks(low: float, high: float, most: int = 6, steps: Sequence[float] = (1, 2, 5, 10)) -> list[float]:
    """Round numbers in a range, at most so many."""
    if not high > low:
        return []
    rough = (high - low) / most
    power = 10.0 ** floor(log10(rough))
    step = next(step * power for step in steps if step * power >= rough * (1 - 1e-9))
    first = ceil(low / step - 1e-9)
    return [k * step for k in range(first, floor(high / step + 1e-9) + 1)]


@dataclass
class SvgCanvas:
    """What is drawn so far, from the back to the front."""

    height: float
    width: float = WIDE
    parts: list[str] = field(default_factory=list)

    def text(
        self, x: float, y: float, words: str, size: float = 11, anchor: str = "start", colour: Colour = INK,
        bold: bool = False, alpha: float = 1.0, turn: float = 0.0, halo: Colour | None = None,
    ) -> None:  # fmt: skip
        """Words; ``turn`` degrees clockwise about their place, ``halo`` a rim that sets them off."""
        how = f' transform="rotate({turn:g} {x:.1f} {y:.1f})"' if turn else ""
        rim = f' stroke="{_css(halo)}" stroke-width="3" paint-order="stroke"' if halo else ""
        weight = ' font-weight="600"' if bold else ""
        self.parts.append(
            f'<text x="{x:.1f}" y="{y:.1f}" font-size="{size:g}" text-anchor="{anchor}" fill="{_css(colour)}"'
            f' opacity="{alpha:g}"{weight}{how}{rim}>{escape(words)}</text>'
        )

    def path(
        self, points: FloatArray | Iterable[Sequence[float]], colour: Colour | None = INK, width: float = 1.5,
        fill: Colour | None = None, alpha: float = 1.0, dash: str = "", close: bool = False,
        fill_alpha: float = 1.0,
    ) -> None:  # fmt: skip
        """A line through (N, 2) points; points that are not finite are left out."""
        at = np.asarray(points, dtype=float).reshape(-1, 2)
        at = at[np.isfinite(at).all(axis=1)]
        if len(at) < 2:
            return
        way = "M" + "L".join(f"{x:.1f} {y:.1f}" for x, y in at.tolist()) + ("Z" if close else "")
        dashes = f' stroke-dasharray="{dash}"' if dash else ""
        self.parts.append(
            f'<path d="{way}" fill="{_css(fill)}" fill-opacity="{fill_alpha:g}" stroke="{_css(colour)}" '
            f'stroke-width="{width:g}" opacity="{alpha:g}" stroke-linejoin="round"{dashes}/>'
        )

    def rect(
        self, x: float, y: float, wide: float, high: float, fill: Colour | None = None,
        colour: Colour | None = None, alpha: float = 1.0, width: float = 1.0,
    ) -> None:  # fmt: skip
        self.parts.append(
            f'<rect x="{x:.1f}" y="{y:.1f}" width="{max(0, wide):.1f}" height="{max(0, high):.1f}" '
            f'fill="{_css(fill)}" stroke="{_css(colour)}" stroke-width="{width:g}" '
            f'opacity="{alpha:g}"/>'
        )

    def dot(
        self, x: float, y: float, r: float, fill: Colour | None, colour: Colour | None = None,
        alpha: float = 1.0, width: float = 1.5,
    ) -> None:  # fmt: skip
        self.parts.append(
            f'<circle cx="{x:.1f}" cy="{y:.1f}" r="{r:g}" fill="{_css(fill)}" stroke="{_css(colour)}" '
            f'stroke-width="{width:g}" opacity="{alpha:g}"/>'
        )

    def cross(self, x: float, y: float, r: float, colour: Colour, width: float = 2.0) -> None:
        """A place, marked; with a light rim, so that it is seen on anything."""
        for c, w in (("#fff", width + 2), (colour, width)):
            self.path([(x - r, y - r), (x + r, y + r)], c, w)
            self.path([(x - r, y + r), (x + r, y - r)], c, w)

    def star(self, x: float, y: float, r: float, fill: Colour, rim: Colour) -> None:
        spikes = [(r if k % 2 == 0 else 0.45 * r, pi * (k / 5 - 0.5)) for k in range(10)]
        points = [(x + q * cos(a), y + q * sin(a)) for q, a in spikes]
        self.path(points, rim, 1.5, fill, close=True)

    def arrow(
        self, start: Sequence[float], end: Sequence[float], colour: Colour, width: float = 2, dash: str = ""
    ) -> None:
        """An arrow, its tip at ``end``; nothing where it would be shorter than a pixel."""
        (x0, y0), (x1, y1) = start, end
        length = float(np.hypot(x1 - x0, y1 - y0))
        if length < 1:
            return
        head = min(3.2 * width + 2, 0.7 * length)
        a = atan2(y1 - y0, x1 - x0)
        self.path([(x0, y0), (x1 - 0.8 * head * cos(a), y1 - 0.8 * head * sin(a))], colour, width, dash=dash)
        tip = [(x1 - head * cos(a + b), y1 - head * sin(a + b)) for b in (0.42, -0.42)]
        self.path([(x1, y1), *tip], colour, 0.5, colour, close=True)

    def image(
        self, pixels: NDArray[np.uint8], x: float, y: float, wide: float, high: float, smooth: bool = False
    ) -> None:
        """(H, W, 3 or 4) pixels, row 0 at the top, stretched over a rectangle."""
        style = "" if smooth else ' style="image-rendering:pixelated"'
        self.parts.append(
            f'<image x="{x:.1f}" y="{y:.1f}" width="{wide:.1f}" height="{high:.1f}" '
            f'preserveAspectRatio="none"{style} href="data:image/png;base64,{png_base64(pixels)}"/>'
        )

    def photo(self, jpeg: bytes, x: float, y: float, wide: float, high: float) -> None:
        """A JPEG as wide as a rectangle; what is too high is cut off above and below alike."""
        self.parts.append(
            f'<image x="{x:.1f}" y="{y:.1f}" width="{wide:.1f}" height="{high:.1f}" '
            f'preserveAspectRatio="xMidYMid slice" href="data:image/jpeg;base64,{b64encode(jpeg).decode()}"/>'
        )

    def chip(self, x: float, y: float, colour: Colour, words: str, shape: str = "square") -> float:
        """An entry of a legend; returns where the next one may begin."""
        if shape == "line":
            self.path([(x, y - 4), (x + 12, y - 4)], colour, 2)
            x += 4
        elif shape == "dot":
            self.dot(x + 4, y - 4, 4, colour)
        else:
            self.rect(x, y - 8, 8, 8, colour)
        self.text(x + 12, y, words, 10.5)
        return x + 12 + 5.7 * len(words) + 10

    def svg(self, title: str) -> str:
        """The whole picture; ``title`` says what it is to those who do not see it."""
        return (
            f'<svg xmlns="http://www.w3.org/2000/svg" role="img" class="mm-picture" '
            f'aria-label="{escape(title)}" viewBox="0 0 {self.width:g} {self.height:g}" '
            f'font-family="system-ui, sans-serif">{"".join(self.parts)}</svg>'
        )


@dataclass(frozen=True)
class SvgPlot:
    """A rectangle of a sheet with a scale on both sides.

    x, y, wide, high : pixels of the sheet
    across, up       : what its left and right, and its lower and upper edge stand for
    """

    sheet: SvgCanvas
    x: float
    y: float
    wide: float
    high: float
    across: Range
    up: Range

    def at(self, points: FloatArray | Sequence[Sequence[float]]) -> FloatArray:
        """(N, 2) pixels of (N, 2) points."""
        x, y = np.asarray(points, dtype=float).reshape(-1, 2).T
        (x0, x1), (y0, y1) = self.across, self.up
        across = self.x + (x - x0) / (x1 - x0) * self.wide
        return np.column_stack([across, self.y + self.high - (y - y0) / (y1 - y0) * self.high])

    def one(self, x: float, y: float) -> tuple[float, float]:
        px, py = self.at([(x, y)])[0].tolist()
        return px, py

    def holds(self, point: FloatArray) -> bool:
        """Whether a (2,) point lies in the plot."""
        (x0, x1), (y0, y1) = self.across, self.up
        return bool(x0 <= point[0] <= x1 and y0 <= point[1] <= y1)

    def axes(
        self, across: str = "", up: str = "", xticks: Sequence[float] | None = None,
        yticks: Sequence[float] | None = None, grid: bool = False,
    ) -> None:  # fmt: skip
        """Frame, ticks with their numbers, and what they measure."""
        s, bottom = self.sheet, self.y + self.high
        s.rect(self.x, self.y, self.wide, self.high, None, INK, FAINT)
        for value in ticks(*self.across) if xticks is None else xticks:
            px, _ = self.one(value, self.up[0])
            s.path([(px, bottom), (px, bottom + 4)], INK, 1, alpha=FAINT)
            if grid:
                s.path([(px, self.y), (px, bottom)], INK, 0.5, alpha=0.15)
            s.text(px, bottom + 14, number(value), 10, "middle", alpha=0.8)
        for value in ticks(*self.up, 4) if yticks is None else yticks:
            _, py = self.one(self.across[0], value)
            s.path([(self.x - 4, py), (self.x, py)], INK, 1, alpha=FAINT)
            if grid:
                s.path([(self.x, py), (self.x + self.wide, py)], INK, 0.5, alpha=0.15)
            s.text(self.x - 6, py + 3.5, number(value), 10, "end", alpha=0.8)
        if across:
            s.text(self.x + self.wide / 2, bottom + 27, across, 10.5, "middle")
        if up:
            s.text(self.x - 32, self.y + self.high / 2, up, 10.5, "middle", turn=-90)

    def curve(
        self, x: FloatArray, y: FloatArray, colour: Colour, width: float = 1.5, fill: bool = False,
        dash: str = "", alpha: float = 1.0,
    ) -> None:  # fmt: skip
        """A curve, what lies outside of the plot on its border."""
        inside = (x >= self.across[0]) & (x <= self.across[1]) & np.isfinite(y)
        points = self.at(np.column_stack([x[inside], np.clip(y[inside], *self.up)]))
        if not len(points):
            return
        if fill:
            floor_ = self.y + self.high
            area = [(points[0, 0], floor_), *points.tolist(), (points[-1, 0], floor_)]
            self.sheet.path(area, None, 0, colour, alpha=alpha, fill_alpha=0.22, close=True)
        self.sheet.path(points, colour, width, dash=dash, alpha=alpha)

    def band(self, low: float, high: float, colour: Colour, alpha: float = 0.16) -> None:
        """A range of the x axis, shaded."""
        low, high = max(low, self.across[0]), min(high, self.across[1])
        if high > low:
            x0, x1 = self.one(low, 0)[0], self.one(high, 0)[0]
            self.sheet.rect(x0, self.y, max(1.5, x1 - x0), self.high, colour, None, alpha)

    def upright(self, value: float, colour: Colour, width: float = 1.5, dash: str = "") -> None:
        """A line straight up at a value of the x axis."""
        px = self.one(value, self.up[0])[0]
        self.sheet.path([(px, self.y), (px, self.y + self.high)], colour, width, dash=dash)

    def image(self, pixels: NDArray[np.uint8], smooth: bool = False) -> None:
        """Pixels over the whole plot, row 0 at the top."""
        self.sheet.image(pixels, self.x, self.y, self.wide, self.high, smooth)


def turn_label(turn: float) -> str:
    """A turn in degrees, as words."""
    return f"{degrees(turn):.1f}°".replace("-", "−")


def draw_chart(plot: SvgPlot, chart: Chart, palette: Palette) -> None:
    """The curves of a chart in a plot of its axes; dots over lines, the first curve on top."""
    x, *columns = chart.columns
    for curve, y in zip(chart.curves, columns, strict=True):
        if curve.kind != "dots":
            dash = "3 4" if curve.kind == "dash" else ""
            colour = getattr(palette, curve.colour)
            plot.curve(x, y, colour, curve.size, fill=curve.kind == "area", dash=dash)
    for curve, y in reversed(list(zip(chart.curves, columns, strict=True))):
        for n in np.flatnonzero(np.isfinite(y)) if curve.kind == "dots" else ():
            at = plot.one(float(x[n]), float(y[n]))
            if curve.colour == "answer":
                plot.sheet.star(*at, 8, palette.answer, palette.rim)
            else:
                plot.sheet.dot(*at, curve.size / 2, getattr(palette, curve.colour), "#fff", width=1)
