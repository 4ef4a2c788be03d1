"""The lesson's pictures of a laser scan: a robot's points, its centre behind them, and what a camera adds."""

from __future__ import annotations

from dataclasses import replace
from math import hypot

import numpy as np

from algorithms.common.pose import FloatArray
from algorithms.detection.range_bearing import mean_of_points
from algorithms.detection.robot_sighting import Sighted
from algorithms.detection.scan_clusters import Cluster
from app.drawing.palette import Palette
from app.drawing.svg.map_plot import scale_bar
from app.drawing.svg.scan_plot import ahead_up, draw_scan
from app.drawing.svg.svg_canvas import INK, WIDE, SvgCanvas, SvgPlot, worded
from app.model.verdict_text import likelihood
from app.page.lesson.figures.camera_figure import (
    ROW,
    TOP,
    Rows,
    angle_text,
    box_of,
    draw_rows,
    half_width,
)
from app.page.lesson.sighting_look import SightingLook

NEAR = 1.0  # times the robot's greatest width, to each side of its centre in the view from near by


def how_far(look: SightingLook, palette: Palette, mean: bool = False) -> SvgCanvas:
    """The scan from above, and from near by the points, their mean, and the centre behind it."""
    one, camera, view = box_of(look), look.calibrated.camera, look.calibrated.view
    high, left, right = 216.0, 168.0, 204.0
    sheet = SvgCanvas(TOP + high + 50 + 5 * ROW)
    drawn = replace(one, position=None) if mean else one
    target = _target(look, one)
    overview = _plot_of(sheet, 0.0, left, high, np.array([np.zeros(2), target]))
    near = _plot_around(sheet, WIDE - right, right, high, target, NEAR * look.body.widest)
    for plot, dots in ((overview, 0.8), (near, 1.6)):
        sheet.rect(plot.x, plot.y, plot.wide, plot.high, palette.free)
        if plot is near and one.position is not None and not mean:
            _draw_outline(plot, look, one, palette)
        draw_scan(plot, view, drawn, camera, palette, dots)
        sheet.rect(plot.x, plot.y, plot.wide, plot.high, None, INK, 0.35)
        scale_bar(plot)
    sheet.text(WIDE - 4, TOP + 12, "from near by", 10, "end", palette.text, halo=palette.free)
    if one.cluster is None:
        sheet.text(0, TOP + high + 18, "no points: " + one.why_not, 10.5)
        return sheet
    middle = mean_of(look, one.cluster)
    for name, place, colour, wanted in (
        ("mean", middle, palette.ref, True),
        ("centre", one.position.point() if one.position else middle, palette.best, one.position and not mean),
    ):
        if wanted:
            px, py = near.one(*ahead_up(place[None])[0].tolist())
            ink = worded(colour, palette)
            sheet.text(px, py + 18, name, 11, "middle", ink, True, halo=palette.free)
    y = TOP + high + 16
    x = sheet.chip(0, y, palette.particle, "directions of the box")
    x = sheet.chip(x, y, palette.mov, "points on the robot", "dot")
    if not mean:
        sheet.chip(x, y, palette.best, "outline, 2 σ", "line")
    draw_rows(sheet, y + 20, _far_rows(look, one, mean))
    return sheet


def _target(look: SightingLook, one: Sighted) -> FloatArray:
    """(2,) what is looked at: the centre, or the mean, or a place in the box's direction; ahead up."""
    if one.position is not None:
        place = one.position.point()
    elif one.cluster is not None:
        place = mean_of(look, one.cluster)
    else:
        turn = look.calibrated.bearing(*one.detection.middle)
        place = 3.0 * np.array([np.cos(turn), np.sin(turn)])
    return np.asarray(ahead_up(place[None])[0])


def mean_of(look: SightingLook, cluster: Cluster) -> FloatArray:
    """(2,) the mean of a thing's points; metres, the robot's frame."""
    return look.scan.mounting.apply(mean_of_points(cluster))


def _plot_of(sheet: SvgCanvas, x: float, wide: float, high: float, places: FloatArray) -> SvgPlot:
    """A plot that holds these (N, 2) places, ahead up, with some room around."""
    low, top = places.min(axis=0), places.max(axis=0)
    half = max(float(top[1] - low[1]) / 2, float(top[0] - low[0]) / 2 * high / wide) * 1.2 + 0.5
    return _plot_around(sheet, x, wide, high, (low + top) / 2, half * wide / high)


def _plot_around(
    sheet: SvgCanvas, x: float, wide: float, high: float, middle: FloatArray, half: float
) -> SvgPlot:
    """A plot about a place, ``half`` metres to the left and right."""
    (a, b), tall = middle.tolist(), half * high / wide
    return SvgPlot(sheet, x, TOP, wide, high, (a - half, a + half), (b - tall, b + tall))


def _draw_outline(plot: SvgPlot, look: SightingLook, one: Sighted, palette: Palette) -> None:
    """The outline that explains the beams best."""
    assert one.position is not None
    body, seen = look.body, one.position
    if body.round:
        turns = np.linspace(0, 2 * np.pi, 49)
        rim = body.length / 2 * np.column_stack([np.cos(turns), np.sin(turns)])
    else:
        half = np.array([body.length, body.width]) / 2
        rim = half * [(1, 1), (-1, 1), (-1, -1), (1, -1)]
    c, s = np.cos(seen.turn), np.sin(seen.turn)
    corners = plot.at(ahead_up(seen.point() + rim @ np.array([[c, s], [-s, c]])))
    plot.sheet.path(corners, palette.best, 1.4, palette.best, close=True, dash="5 3", fill_alpha=0.1)


def _far_rows(look: SightingLook, one: Sighted, mean: bool) -> Rows:
    assert one.cluster is not None
    middle = mean_of(look, one.cluster)
    away = hypot(*middle)
    spacing = away * abs(look.scan.angle_increment)
    noise = look.scan.noise()
    rows = [
        ("beams that ended on it", f"{len(one.cluster.beams)}, {100 * spacing:.1f} cm apart there", False),
        ("noise of one range, 1 σ", f"{1000 * noise:.0f} mm", False),
        (
            "the mean of these points",
            f"{away:.3f} m, {angle_text(float(np.arctan2(middle[1], middle[0])))}",
            mean,
        ),
    ]
    if one.position is None:
        return [*rows, ("no centre", one.why_not, False)]
    seen = one.position
    behind = f"{100 * (seen.range - away):.0f} cm"
    if mean:
        return [*rows, ("taken for the centre it is too near by", behind, True)]
    told = (
        f"{seen.range:.3f} ± {seen.sigma_range:.3f} m, "
        f"{angle_text(seen.bearing)} ± {angle_text(seen.sigma_bearing)}"
    )
    return [*rows, ("the centre", told, True), ("it lies behind the mean by", behind, False)]


def both(look: SightingLook, palette: Palette) -> SvgCanvas:
    """All that is as wide as a robot in the scan, the directions of the box, and what each sensor knows."""
    one, reading = box_of(look), look.calibrated
    high = 196.0
    rings = [mean_of(look, thing) for thing in look.robot_sized]
    places = ahead_up(np.array([np.zeros(2), *rings]))
    target = _target(look, one)
    sheet = SvgCanvas(TOP + high + 34 + 5 * ROW)
    plot = _plot_of(sheet, 0.0, WIDE, high, np.array([*places, target]))
    sheet.rect(plot.x, plot.y, plot.wide, plot.high, palette.free)
    draw_scan(plot, reading.view, one, reading.camera, palette, 0.9)
    for thing, place in zip(look.robot_sized, places[1:], strict=True):
        chosen = one.cluster is not None and bool(np.isin(thing.beams, one.cluster.beams).any())
        colour = palette.mov if chosen else palette.conflict
        sheet.dot(*plot.one(*place.tolist()), 11, None, colour, width=2)
    sheet.rect(plot.x, plot.y, plot.wide, plot.high, None, INK, 0.35)
    scale_bar(plot)
    y = TOP + high + 16
    x = sheet.chip(0, y, palette.particle, "the camera's directions")
    x = sheet.chip(x, y, palette.conflict, "as wide as a robot", "dot")
    sheet.chip(x, y, palette.mov, "both", "dot")
    _table(sheet, y + 22, look, one)
    return sheet


def _table(sheet: SvgCanvas, y: float, look: SightingLook, one: Sighted) -> None:
    """What camera and laser know, alone and together."""
    box, seen, count = one.detection, one.position, len(look.robot_sized)
    turn, half = look.calibrated.bearing(*box.middle), half_width(look)
    robot = f"robot, {likelihood(box.probability)}"
    way = f"{angle_text(seen.bearing)} ± {angle_text(seen.sigma_bearing)}" if seen else "refused"
    far = f"{seen.range:.2f} ± {seen.sigma_range:.2f} m" if seen else "refused"
    rows = (
        ("", "camera alone", "laser alone", "both"),
        ("what is it?", robot, f"{count} may be one" if count else "nothing so wide", robot),
        ("which way?", f"{angle_text(turn, 1)} ± {angle_text(half, 1)}", "known of each", way),
        ("how far?", "not known", "known of each", far),
        ("deceived by", "a picture", "a thing so wide", "both at once"),
    )
    for k, words in enumerate(rows):
        for x, text in zip((0.0, 76.0, 172.0, 272.0), words, strict=True):
            if text:
                sheet.text(x, y + ROW * k, text, 10.5, bold=k == 0 or x > 260, alpha=0.8 if x == 0 else 1.0)
