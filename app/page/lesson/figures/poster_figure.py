"""The museum's picture of a box that a camera believes and a laser does not."""

from __future__ import annotations

from app.drawing.palette import Palette
from app.drawing.svg.svg_canvas import SvgCanvas
from app.model.sighting.sighting_text import class_name
from app.model.verdict_text import likelihood
from app.page.lesson.figures.camera_figure import STRIP, box_of, draw_image, draw_strip
from app.page.lesson.sighting_look import SightingLook

NARROW = 264.0  # pixels; the folder of the museum is narrower than the lesson's dock
SHOWN = 0.86  # of the image's height: the poster, and the wall that it hangs on


def poster(look: SightingLook, palette: Palette) -> str:
    """The image with its box, and below it the laser's points by column and distance."""
    sheet = SvgCanvas(0, NARROW)
    image = draw_image(sheet, 0, NARROW, look, palette, SHOWN)
    draw_strip(sheet, image.high + 5, NARROW, look, look.calibrated, palette)
    below = image.high + 5 + STRIP + 14
    x = sheet.chip(0, below, palette.margin, "laser points", "dot")
    sheet.chip(x, below, palette.particle, "columns of the box")
    sheet.height = below + 6
    return sheet.svg("The picture that robot 1 took, with the box, and its laser's points below")


def opinions(look: SightingLook) -> list[tuple[str, str]]:
    """What each of those who can be asked says of the box: the detector, the laser, and robot 1's map."""
    box, laser, both = box_of(look).detection, look.laser_alone, look.calibrated.seen
    return [
        (
            "the detector",
            f"a robot, {class_name(box.label)}: {likelihood(box.probability)}".replace("> ", ">\u00a0"),
        ),
        ("the laser", laser.sighted[0].why_not.removeprefix("the laser ") or "a robot"),
        ("robot 1's map", both.sighted[0].why_not.removeprefix("the map ") or "a robot"),
    ]
