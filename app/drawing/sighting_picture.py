"""The picture of a sighting: boxes over the camera's image, and below it what the laser sees there."""

from __future__ import annotations

import numpy as np
from PIL import Image, ImageDraw, ImageFont

from algorithms.detection.detection import Picture
from algorithms.detection.robot_sighting import LaserView, Sighted, SightedRobots
from app.drawing.palette import LIGHT, Rgb

CHOSEN, POSSIBLE, REFUSED = LIGHT.maps[1], LIGHT.maps[0], LIGHT.conflict
POINT, WALL, LINE = (0x37, 0x41, 0x51), (0xB8, 0xBE, 0xC8), (0xE5, 0xE7, 0xEB)
STRIP = 0.34  # of the image's width: height of the laser's strip
WIDTH = 960  # pixels; smaller images are drawn larger, so that words can be read


def sighting_picture(picture: Picture, seen: SightedRobots, view: LaserView | None) -> Picture:
    """(H, W, 3) the image with its boxes; below, with a laser, its points by column and distance."""
    factor = max(1, round(WIDTH / picture.shape[1], 1))
    size = round(picture.shape[1] * factor), round(picture.shape[0] * factor)
    photo = Image.fromarray(picture).resize(size, Image.Resampling.LANCZOS)
    strip = round(STRIP * size[0]) if view is not None else 0
    sheet = Image.new("RGB", (size[0], size[1] + strip), LIGHT.free)
    sheet.paste(photo)
    draw = ImageDraw.Draw(sheet)
    font = ImageFont.load_default(size=max(15, size[0] // 55))
    for number, one in reversed(list(enumerate(seen.sighted))):
        _draw_box(draw, font, one, number, factor, _colour(seen, number))
    if view is not None:
        _draw_strip(draw, font, seen, view, factor, (size[0], size[1], strip))
    return np.asarray(sheet)


def _colour(seen: SightedRobots, number: int) -> Rgb:
    if number == seen.chosen:
        return CHOSEN
    return POSSIBLE if seen.sighted[number].position is not None else REFUSED


def _draw_box(
    draw: ImageDraw.ImageDraw,
    font: ImageFont.FreeTypeFont,
    one: Sighted,
    number: int,
    factor: float,
    colour: Rgb,
) -> None:
    """A box with its number and probability on a plate above it, or inside where there is no room."""
    left, top, right, bottom = ((edge + 0.5) * factor for edge in one.detection.box())
    thick = max(2, round(2 * factor))
    draw.rectangle((left, top, right, bottom), outline=colour, width=thick)
    words = f"{number + 1}: {one.detection.probability:.0%}"
    x0, y0, x1, y1 = draw.textbbox((left, top), words, font=font)
    high = y1 - y0 + 8
    plate = top - high if top - high > 0 else top
    draw.rectangle((left, plate, left + x1 - x0 + 10, plate + high), fill=colour)
    draw.text((left + 5, plate + 3 - (y0 - top)), words, fill=(255, 255, 255), font=font)


def _draw_strip(
    draw: ImageDraw.ImageDraw,
    font: ImageFont.FreeTypeFont,
    seen: SightedRobots,
    view: LaserView,
    factor: float,
    size: tuple[int, int, int],
) -> None:
    """The laser's points under the image: the column as above, farther ones higher up."""
    wide, top, strip = size
    with np.errstate(invalid="ignore"):
        in_view = (view.columns >= 0) & (view.columns <= wide / factor) & view.scan.valid
    ranges = view.scan.ranges
    most = max(2.0, float(np.ceil(ranges[in_view].max()))) if in_view.any() else 8.0
    floor, height = top + strip - 8, strip - 30

    def level(metres: float) -> float:
        return floor - height * metres / most

    step = next(step for step in (1, 2, 5, 10, 20, 50, 100, 1000, 10000, 100000) if most / step <= 5)
    for metres in np.arange(0, most + 1e-9, step).tolist():
        y = level(metres)
        draw.line((0, y, wide, y), fill=LINE, width=1)
    labels = [(f"{metres:g} m", level(metres)) for metres in np.arange(0, most + 1e-9, step).tolist()]
    radius = max(2.0, 1.6 * factor)
    colours = dict.fromkeys(np.flatnonzero(in_view).tolist(), POINT)
    colours |= dict.fromkeys(np.flatnonzero(in_view & view.explained).tolist(), WALL)
    for number in reversed(range(len(seen.sighted))):
        cluster = seen.sighted[number].cluster
        if cluster is not None:
            shown = [beam for beam in cluster.beams.tolist() if beam in colours]
            colours |= dict.fromkeys(shown, _colour(seen, number))
    for beam, colour in colours.items():
        x, y = (view.columns[beam] + 0.5) * factor, level(float(ranges[beam]))
        bigger = radius if colour in (POINT, WALL) else 1.5 * radius
        draw.ellipse((x - bigger, y - bigger, x + bigger, y + bigger), fill=colour)
    for words, y in labels:
        place = (4, y - font.size - 1)
        x0, y0, x1, y1 = draw.textbbox(place, words, font=font)
        draw.rectangle((x0 - 3, y0 - 1, x1 + 3, y1 + 1), fill=LIGHT.free)
        draw.text(place, words, fill=POINT, font=font)
    for number in reversed(range(len(seen.sighted))):
        left, _, right, _ = ((edge + 0.5) * factor for edge in seen.sighted[number].detection.box())
        for x in (left, right):
            draw.line((x, top, x, floor), fill=_colour(seen, number), width=1)
