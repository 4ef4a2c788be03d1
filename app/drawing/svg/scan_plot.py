"""A laser scan around a robot, seen from above: what belongs to the other robot, and where its centre is."""

from __future__ import annotations

from collections.abc import Sequence
from math import degrees

import numpy as np

from algorithms.common.pose import FloatArray
from algorithms.detection.range_bearing import mean_of_points
from algorithms.detection.robot_sighting import LaserView, Sighted
from algorithms.sensors.camera import Camera
from app.drawing.palette import Palette
from app.drawing.svg.svg_canvas import INK, WIDE, SvgCanvas, SvgPlot

HIGH, TOP, LEFT = 300.0, 8.0, 46.0  # of the plot; pixels
LEGEND = 16.0  # where it begins; all of it just fits beside one another
REACH = 1.35  # times the range of the robot: how far to the front the plot reaches
LEAST, MOST = 2.0, 12.0  # metres of it
BEHIND = 0.12  # of that reach, which is shown behind the observer


def scan_svg(view: LaserView, one: Sighted | None, camera: Camera, palette: Palette) -> str:
    """SVG of a scan in the observer's frame, straight ahead up; of one box its direction and its points.

    one : the box whose points are marked; None shows the scan alone
    """
    points = view.scan.points()
    reach = _reach(points, one)
    sheet = SvgCanvas(TOP + HIGH + 62)
    wide = WIDE - LEFT - 8
    side = wide / HIGH * reach * (1 + BEHIND) / 2
    plot = SvgPlot(sheet, LEFT, TOP, wide, HIGH, (-side, side), (-BEHIND * reach, reach))
    draw_scan(plot, view, one, camera, palette)
    plot.axes("to the right (m)", "ahead (m)")
    _draw_legend(sheet, one, palette)
    return sheet.svg("The laser scan around the observer, seen from above")


def draw_scan(
    plot: SvgPlot, view: LaserView, one: Sighted | None, camera: Camera, palette: Palette, dots: float = 1.0
) -> None:
    """What of a scan lies in a plot of the observer's frame, straight ahead up; what belongs to one box.

    dots : times the usual size of a point
    """
    points = ahead_up(view.scan.points())
    (x0, x1), (y0, y1) = plot.across, plot.up
    shown = (points > (x0, y0)).all(axis=1) & (points < (x1, y1)).all(axis=1)  # false where nothing was hit
    if one is not None:
        _draw_sector(plot, one, camera, palette)
    mine = np.zeros(len(points), dtype=bool)
    if one is not None and one.cluster is not None:
        mine[one.cluster.beams] = True
    for chosen, colour, size in (
        (shown & ~mine & view.explained, palette.margin, 1.3),
        (shown & ~mine & ~view.explained, palette.text, 1.6),
        (shown & mine, palette.maps[1], 2.6),
    ):
        for x, y in plot.at(points[chosen]).tolist():
            plot.sheet.dot(x, y, dots * size, colour)
    if plot.holds(np.zeros(2)):
        _draw_observer(plot, palette)
    if one is not None and one.cluster is not None:
        mean = ahead_up(view.scan.mounting.apply(mean_of_points(one.cluster))[None])[0]
        plot.sheet.dot(*plot.one(*mean.tolist()), 4.5, None, palette.maps[0], width=2)
        _draw_centre(plot, one, palette)


def _reach(points: FloatArray, one: Sighted | None) -> float:
    if one is not None and one.position is not None:
        return min(max(LEAST, REACH * one.position.range), MOST)
    if one is not None and one.cluster is not None:
        return min(max(LEAST, 1.5 * float(np.hypot(*one.cluster.points.T).mean())), MOST)
    ahead = points[np.isfinite(points[:, 0]), 0]
    return min(max(LEAST, float(np.max(ahead, initial=LEAST))), MOST)


def ahead_up(points: FloatArray) -> FloatArray:
    """(N, 2) points of the robot's frame, turned so that straight ahead is up."""
    return np.column_stack([-points[:, 1], points[:, 0]])


def sector(one: Sighted, camera: Camera, reach: float) -> FloatArray:
    """(3, 2) corners of the directions of a box, from the camera on: what the pixels say of the bearing;
    metres, the observer's frame.
    """
    edges = np.clip([one.detection.left, one.detection.right], 0, camera.width - 1)
    angles = camera.bearings(edges, one.detection.middle[1]) + camera.mounting.theta
    ends = camera.mounting.xy + reach * np.stack([np.cos(angles), np.sin(angles)], axis=1)
    return np.array([camera.mounting.xy, *ends])


def _draw_sector(plot: SvgPlot, one: Sighted, camera: Camera, palette: Palette) -> None:
    reach = 4 * float(np.abs([plot.across, plot.up]).max())  # beyond the plot
    inside = _clipped(plot.at(ahead_up(sector(one, camera, reach))), plot)
    plot.sheet.path(inside, palette.particle, 1, palette.particle, close=True, fill_alpha=0.22)


def _clipped(corners: FloatArray, plot: SvgPlot) -> FloatArray:
    """A polygon cut off at the plot's edges (Sutherland, Hodgman)."""
    polygon = corners.tolist()
    for axis, limit, sign in (
        (0, plot.x, 1),
        (0, plot.x + plot.wide, -1),
        (1, plot.y, 1),
        (1, plot.y + plot.high, -1),
    ):
        cut = []
        for k, here in enumerate(polygon):
            before = polygon[k - 1]
            is_in, was_in = sign * (here[axis] - limit) >= 0, sign * (before[axis] - limit) >= 0
            if is_in != was_in:
                share = (limit - before[axis]) / (here[axis] - before[axis])
                cut.append([b + share * (h - b) for b, h in zip(before, here, strict=True)])
            if is_in:
                cut.append(here)
        polygon = cut
    return np.array(polygon).reshape(-1, 2)


def _line_inside(start: Sequence[float], end: Sequence[float], plot: SvgPlot) -> FloatArray:
    """A line from a place in a plot to another one, cut off at the plot's edge."""
    first, way = np.asarray(start), np.subtract(end, start)
    low, high = np.array([plot.x, plot.y]), np.array([plot.x + plot.wide, plot.y + plot.high])
    with np.errstate(divide="ignore", invalid="ignore"):
        shares = np.where(way > 0, (high - first) / way, np.where(way < 0, (low - first) / way, np.inf))
    return np.array([first, first + min(1.0, float(shares.min())) * way])


def _draw_observer(plot: SvgPlot, palette: Palette) -> None:
    x, y = plot.one(0, 0)
    plot.sheet.dot(x, y, 6, palette.maps[0], "#fff")
    plot.sheet.arrow((x, y), (x, y - 20), palette.maps[0])


def _draw_centre(plot: SvgPlot, one: Sighted, palette: Palette) -> None:
    """The centre that is measured, with its ellipse of two standard deviations where that can be seen."""
    seen = one.position
    if seen is None:
        return
    along = np.array([np.cos(seen.bearing), np.sin(seen.bearing)])
    aside = np.array([-along[1], along[0]])
    turn = np.linspace(0, 2 * np.pi, 41)[:, None]
    ring = 2 * seen.sigma_range * np.cos(turn) * along
    ring = ring + 2 * seen.sigma_bearing * seen.range * np.sin(turn) * aside
    plot.sheet.path(plot.at(ahead_up(seen.point() + ring)), palette.best, 1.5, close=True)
    x, y = plot.one(-float(seen.point()[1]), float(seen.point()[0]))
    plot.sheet.cross(x, y, 5, palette.best)
    plot.sheet.path(_line_inside((x, y), plot.one(0, 0), plot), palette.best, 1.2, dash="4 4")


def _draw_legend(sheet: SvgCanvas, one: Sighted | None, palette: Palette) -> None:
    y = TOP + HIGH + 44
    x = sheet.chip(LEGEND, y, palette.text, "laser", "dot")
    if one is None:
        return
    x = sheet.chip(x, y, palette.particle, "the box's direction")
    x = sheet.chip(x, y, palette.maps[1], "on the robot", "dot")
    sheet.chip(x, y, palette.maps[0], "their mean", "dot")
    if one.position is None:
        sheet.text(LEGEND, y + 15, "no centre: the box is refused", 10.5, colour=INK)
        return
    seen = one.position
    words = (
        f"centre: {seen.range:.3f} ± {seen.sigma_range:.3f} m, "
        f"{degrees(seen.bearing):.2f} ± {degrees(seen.sigma_bearing):.2f}°"
    )
    sheet.chip(LEGEND, y + 15, palette.best, words.replace("-", "−"))
