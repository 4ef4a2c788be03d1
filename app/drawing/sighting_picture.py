"""The picture of a sighting: boxes over the camera's image, and below it what the laser sees there."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from PIL import Image, ImageDraw, ImageFont

from algorithms.detection.detection import Picture
from algorithms.detection.robot_sighting import LaserView, Sighted, SightedRobots
from app.drawing.palette import DARK, LIGHT, Palette, Rgb
from app.model.verdict_text import likelihood

CHOSEN, POSSIBLE, REFUSED = LIGHT.maps[1], LIGHT.maps[0], LIGHT.conflict
STRIP = 0.34  # of the image's width: height of the laser's strip
WIDTH = 960  # pixels; smaller images are drawn larger, so that words can be read


@dataclass(frozen=True)
class _Ink:
    """Colours of the laser's strip."""

    ground: Rgb
    point: Rgb
    wall: Rgb
    line: Rgb


LIGHT_INK = _Ink(LIGHT.free, (0x37, 0x41, 0x51), (0xB8, 0xBE, 0xC8), LIGHT.unknown)
DARK_INK = _Ink(DARK.free, (0xE5, 0xE7, 0xEB), (0x6B, 0x72, 0x80), (0x37, 0x41, 0x51))


def sighting_picture(
    picture: Picture,
    seen: SightedRobots,
    view: LaserView | None,
    palette: Palette = LIGHT,
    columns: int | None = None,
    letters: int | None = None,
) -> Picture:
    """(H, W, 3) the image with its boxes; below, with a laser, its points by column and distance.

    palette : of the laser's strip
    columns : width of the image in which the boxes are, where ``picture`` is a smaller one of it
    letters : their height; pixels
    """
    larger = max(1, round(WIDTH / picture.shape[1], 1))
    wide, high = (round(side * larger) for side in (picture.shape[1], picture.shape[0]))
    ink = DARK_INK if palette.dark else LIGHT_INK
    strip = round(STRIP * wide) if view is not None else 0
    sheet = Image.new("RGB", (wide, high + strip), ink.ground)
    sheet.paste(Image.fromarray(picture).resize((wide, high), Image.Resampling.LANCZOS))
    factor = wide / (columns or picture.shape[1])
    size = letters or max(15, wide // 55)
    drawing = _Drawing(ImageDraw.Draw(sheet), ImageFont.load_default(size=size), size, factor, wide)
    for number, one in reversed(list(enumerate(seen.sighted))):
        drawing.box(one, number, _colour(seen, number))
    if view is not None:
        drawing.strip(seen, view, high, strip, ink)
    return np.asarray(sheet)


def _colour(seen: SightedRobots, number: int) -> Rgb:
    if number == seen.chosen:
        return CHOSEN
    return POSSIBLE if seen.sighted[number].position is not None else REFUSED


@dataclass(frozen=True)
class _Drawing:
    """A sheet that is drawn on.

    factor : its pixels per pixel of the image in which the boxes are
    wide   : its width; pixels
    """

    draw: ImageDraw.ImageDraw
    font: ImageFont.FreeTypeFont | ImageFont.ImageFont
    letters: int
    factor: float
    wide: int

    def box(self, one: Sighted, number: int, colour: Rgb) -> None:
        """A box with its number and probability on a plate above it, or inside where there is no room."""
        left, top, right, bottom = ((edge + 0.5) * self.factor for edge in one.detection.box())
        self.draw.rectangle((left, top, right, bottom), outline=colour, width=max(3, self.wide // 320))
        words = f"{number + 1}: {likelihood(one.detection.probability)}"
        x0, y0, x1, y1 = self.draw.textbbox((left, top), words, font=self.font)
        high, across = y1 - y0 + 8, x1 - x0 + 10
        at_left = max(0.0, min(left, self.wide - across))
        at_top = top - high if top - high > 0 else max(0.0, top)
        self.draw.rectangle((at_left, at_top, at_left + across, at_top + high), fill=colour)
        place = (at_left + 5 - (x0 - left), at_top + 4 - (y0 - top))
        self.draw.text(place, words, fill=(255, 255, 255), font=self.font)

    def strip(self, seen: SightedRobots, view: LaserView, top: int, high: int, ink: _Ink) -> None:
        """The laser's points under the image: the column as above, farther ones higher up."""
        with np.errstate(invalid="ignore"):
            in_view = (view.columns >= 0) & (view.columns <= self.wide / self.factor) & view.scan.valid
        ranges = view.scan.ranges
        most = max(2.0, float(np.ceil(ranges[in_view].max()))) if in_view.any() else 8.0
        floor, rise = top + high - 8, high - self.letters - 18

        def level(metres: float) -> float:
            return floor - rise * metres / most

        step = next(step for step in (1, 2, 5, 10, 20, 50, 100, 1000, 10000, 100000) if most / step <= 5)
        marks = np.arange(0, most + 1e-9, step).tolist()
        for metres in marks:
            self.draw.line((0, level(metres), self.wide, level(metres)), fill=ink.line, width=1)
        radius = max(2.0, self.wide / 400)
        colours = dict.fromkeys(np.flatnonzero(in_view).tolist(), ink.point)
        colours |= dict.fromkeys(np.flatnonzero(in_view & view.explained).tolist(), ink.wall)
        for number in reversed(range(len(seen.sighted))):
            cluster = seen.sighted[number].cluster
            if cluster is not None:
                shown = [beam for beam in cluster.beams.tolist() if beam in colours]
                colours |= dict.fromkeys(shown, _colour(seen, number))
        for beam, colour in colours.items():
            x, y = (view.columns[beam] + 0.5) * self.factor, level(float(ranges[beam]))
            bigger = radius if colour in (ink.point, ink.wall) else 1.5 * radius
            self.draw.ellipse((x - bigger, y - bigger, x + bigger, y + bigger), fill=colour)
        self._labels(marks, level, ink)
        for number in reversed(range(len(seen.sighted))):
            box = seen.sighted[number].detection
            for edge in (box.left, box.right):
                x = (edge + 0.5) * self.factor
                self.draw.line((x, top, x, floor), fill=_colour(seen, number), width=max(1, self.wide // 640))

    def _labels(self, marks: list[float], level: Callable[[float], float], ink: _Ink) -> None:
        """The distances at the left, each above its line."""
        for metres in marks:
            words = f"{metres:g} m"
            x0, y0, x1, y1 = self.draw.textbbox((5, level(metres) - 3), words, font=self.font, anchor="ls")
            self.draw.rectangle((x0 - 4, y0 - 2, x1 + 4, y1 + 2), fill=ink.ground)
            self.draw.text((5, level(metres) - 3), words, fill=ink.point, font=self.font, anchor="ls")
