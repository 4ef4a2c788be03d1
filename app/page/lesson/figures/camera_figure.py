"""The lesson's pictures of a camera's image: which way a pixel looks, and what the detector sees of it."""

from __future__ import annotations

from collections.abc import Sequence
from math import degrees

import numpy as np

from algorithms.detection.robot_sighting import Sighted
from app.drawing.hog_picture import MARGIN_CELLS
from app.drawing.palette import Palette
from app.drawing.svg.svg_canvas import INK, WIDE, SvgCanvas, SvgPlot
from app.model.sighting.sighting_text import class_name
from app.model.verdict_text import likelihood
from app.page.lesson.sighting_look import CameraReading, SightingLook

TOP, ROW = 18.0, 17.0  # where pictures begin, and the height of a line of numbers
LEAST_SHOWN = 0.52  # of the image's height
STRIP = 92.0  # height of the laser's strip
Rows = Sequence[tuple[str, str, bool]]


def draw_rows(sheet: SvgCanvas, y: float, rows: Rows) -> None:
    """What is measured, line by line: words at the left, numbers at the right, and whether both are bold."""
    for k, (label, words, bold) in enumerate(rows):
        sheet.text(0, y + ROW * k, label, 10.5, bold=bold, alpha=1.0 if bold else 0.8)
        sheet.text(WIDE, y + ROW * k, words, 10.5, "end", bold=bold)


def angle_text(turn: float, digits: int = 2) -> str:
    """Degrees."""
    return f"{round(degrees(turn), digits) + 0.0:.{digits}f}°".replace("-", "−")


def box_of(look: SightingLook) -> Sighted:
    """The box that is looked at; who asks knows that there is one."""
    one = look.calibrated.one
    assert one is not None
    return one


def which_way(look: SightingLook, palette: Palette, by_counting: bool = False) -> SvgCanvas:
    """The image with the box, the laser's points below it by column and distance, and both bearings."""
    reading = look.counted if by_counting else look.calibrated
    box, middle = box_of(look).detection, reading.camera.centre[0]
    sheet = SvgCanvas(0)
    image = draw_image(sheet, TOP, WIDE, look, palette)
    column, row = box.middle
    for across, colour in ((middle, "#fff"), (column, palette.mov)):
        image.upright(across, colour, 1.2, "5 4")
    px, start = image.one(column, row)[0], image.one(middle, row)[0]
    below = min(image.one(column, box.bottom)[1] + 16, TOP + image.high - 8)
    if abs(px - start) > 3:
        sheet.arrow((start, below), (px, below), "#fff", 2)
    offset = f"{column - middle:+.1f} px".replace("-", "−")
    at, anchor = (max(px, start) + 6, "start") if max(px, start) < WIDE - 70 else (min(px, start) - 6, "end")
    sheet.text(at, below + 4, offset, 11, anchor, "#fff", True, halo="#111827")
    strip = TOP + image.high + 6
    draw_strip(sheet, strip, WIDE, look, reading, palette)
    sheet.chip(0, strip + STRIP + 14, palette.mov, "laser points on the robot", "dot")
    sheet.chip(168, strip + STRIP + 14, palette.particle, "columns of the box")
    draw_rows(sheet, strip + STRIP + 30, _way_rows(look, by_counting))
    sheet.height = strip + STRIP + 24 + 4 * ROW
    return sheet


def draw_image(
    sheet: SvgCanvas,
    top: float,
    wide: float,
    look: SightingLook,
    palette: Palette,
    least: float = LEAST_SHOWN,
) -> SvgPlot:
    """The image with the box, cut off above and below but for a share of its height; a plot of its columns
    and rows.
    """
    one, camera = box_of(look), look.calibrated.camera
    box, middle = one.detection, (camera.height - 1) / 2
    # so many rows about the middle of the image that the box is among them
    away = abs(np.array([box.top, box.bottom]) - middle).max() + 0.06 * camera.height
    half = float(np.clip(away, least * camera.height / 2, camera.height / 2))
    high = wide * 2 * half / camera.width
    sheet.photo(look.photo, 0, top, wide, high)
    image = SvgPlot(sheet, 0, top, wide, high, (-0.5, camera.width - 0.5), (middle + half, middle - half))
    corners = [(box.left, box.top), (box.right, box.top), (box.right, box.bottom), (box.left, box.bottom)]
    colour = palette.conflict if one.position is None else palette.mov
    for ink, width in (("#fff", 4.0), (colour, 2.0)):
        sheet.path(image.at(corners), ink, width, close=True)
    (x, y), (right, _) = image.one(box.left, box.top), image.one(box.right, box.top)
    at, anchor = (x, "start") if x < wide - 150 else (right, "end")
    words = f"{class_name(box.label)}, {likelihood(box.probability)}"
    sheet.text(at, y - 6, words, 12, anchor, "#fff", True, halo=colour)
    return image


def _way_rows(look: SightingLook, by_counting: bool) -> Rows:
    """Both bearings: from the camera's axis, plus its own turn, from robot 1's heading."""
    box = box_of(look).detection
    column, row = box.middle
    turn = look.calibrated.camera.mounting.theta

    def told(reading: CameraReading) -> str:
        whole = reading.bearing(column, row)
        sign = "−" if turn < 0 else "+"
        return f"{angle_text(whole - turn)} {sign} {angle_text(abs(turn))} = {angle_text(whole)}"

    return (
        ("the middle of the box, u", f"column {column:.1f}", False),
        ("bearing by calibration", told(look.calibrated), not by_counting),
        ("bearing, counted in pixels", told(look.counted), by_counting),
        ("half the width of the box", f"± {angle_text(half_width(look, by_counting))}", False),
    )


def half_width(look: SightingLook, by_counting: bool = False) -> float:
    """Half the angle that the box takes; radians."""
    reading, box = look.counted if by_counting else look.calibrated, box_of(look).detection
    row = box.middle[1]
    return abs(reading.bearing(box.left, row) - reading.bearing(box.right, row)) / 2


def draw_strip(
    sheet: SvgCanvas, top: float, wide: float, look: SightingLook, reading: CameraReading, palette: Palette
) -> None:
    """The laser's points under the image: the column as above, farther ones higher up."""
    width, ranges, columns = reading.camera.width, look.scan.ranges, reading.view.columns
    with np.errstate(invalid="ignore"):
        shown = (columns >= 0) & (columns < width) & look.scan.valid
    most = 1.08 * max(2.0, float(ranges[shown].max(initial=0.0)))
    plot = SvgPlot(sheet, 0, top, wide, STRIP, (-0.5, width - 0.5), (0, most))
    one = box_of(look)
    sheet.rect(0, top, wide, STRIP, palette.free)
    plot.band(one.detection.left, one.detection.right, palette.particle, 0.25)
    mine = np.zeros(len(ranges), dtype=bool)
    if one.cluster is not None:
        mine[one.cluster.beams] = True
    for chosen, colour, size in (
        (shown & ~mine, palette.margin, 1.3),
        (shown & mine, palette.mov, 2.4),
    ):
        for x, y in plot.at(np.column_stack([columns[chosen], ranges[chosen]])).tolist():
            sheet.dot(x, y, size, colour)
    sheet.rect(0, top, wide, STRIP, None, INK, 0.35)
    for metres in range(0, int(most) + 1, 1 if most < 5 else 2):
        y = plot.one(0, metres)[1]
        sheet.path([(0, y), (4, y)], palette.text, 1)
        if metres:
            sheet.text(7, y + 3.5, f"{metres} m", 9, colour=palette.text, halo=palette.free)


def what(look: SightingLook, palette: Palette) -> SvgCanvas:
    """The window in the detector's own size, and the directions of its edges, cell by cell."""
    box, shape = box_of(look).detection, look.shape
    side = 186.0
    window = look.window
    assert window is not None  # there is a box
    part, edges = window
    high = side * part.shape[0] / part.shape[1]
    sheet = SvgCanvas(TOP + high + 22 + 4 * ROW)
    cell = side / (shape.cols + 2 * MARGIN_CELLS)
    inner = MARGIN_CELLS + shape.border
    for x, pixels in ((0.0, part), (WIDE - side, edges)):
        sheet.image(pixels, x, TOP, side, high)
        wide, tall = cell * (shape.cols - 2 * shape.border), cell * (shape.rows - 2 * shape.border)
        for colour, width in (("#fff", 3.0), (palette.mov, 1.6)):
            corner = x + inner * cell, TOP + inner * cell
            sheet.rect(*corner, wide, tall, None, colour, width=width)
    sheet.text(4, TOP + high - 6, "as the detector gets it", 10, colour="#fff", halo="#111827")
    sheet.text(WIDE - side + 4, TOP + high - 6, "its edges, cell by cell", 10, colour="#fff", halo="#111827")
    count = len(look.calibrated.seen.sighted)
    rows = [
        ("window", f"{shape.rows} × {shape.cols} cells of {shape.cell} × {shape.cell} pixels", False),
        ("numbers that describe it", f"{shape.length:,}", False),
        ("boxes in this image that may be a robot", f"{count}", False),
        (f"how likely a robot, {class_name(box.label)}", likelihood(box.probability), True),
    ]
    draw_rows(sheet, TOP + high + 22, rows)
    return sheet
